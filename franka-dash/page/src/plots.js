// One quantity over time; another by the list. Drag to zoom, double-click to return.

import uPlot from "uplot";

const COLOURS = ["#2f7de1", "#d8662a", "#2e9e5b", "#b0479c", "#8a7a1f", "#1aa3a8", "#d8433f"];
// Colour is not the only difference: lines have patterns, too.
const DASHES = [[], [8, 4], [2, 3], [8, 3, 2, 3], [14, 4], [4, 4], [2, 6]];
const SPREAD = ["shortest", "median", "longest"];
const QUANTITIES = {
  "q, rad": { field: "q", names: ["1", "2", "3", "4", "5", "6", "7"] },
  "dq, rad/s": { field: "dq", names: ["1", "2", "3", "4", "5", "6", "7"] },
  "tau_J, N m": { field: "tau", names: ["1", "2", "3", "4", "5", "6", "7"] },
  "tau_ext, N m": { field: "tauExt", names: ["1", "2", "3", "4", "5", "6", "7"] },
  "F_ext, N": { field: "force", names: ["x", "y", "z"] },
  "success rate": { field: "success", names: ["rate"] },
  "turnaround, µs": { field: "turnaround", names: SPREAD, from: "control" },
  "slack, µs": { field: "slack", names: SPREAD, from: "control" },
};
const EVERY_MS = 200;
const SHOWN_S = 20;

export function plots(history) {
  const place = document.getElementById("plot");
  const choice = document.getElementById("plotted");
  for (const name of Object.keys(QUANTITIES)) choice.add(new Option(name));
  let plot = null;
  const ink = () => getComputedStyle(document.documentElement).getPropertyValue("--quiet").trim();
  const line = () => getComputedStyle(document.documentElement).getPropertyValue("--line").trim();

  const data = () => {
    const { field, names, from = "frames" } = QUANTITIES[choice.value];
    const newest = history.newest?.serverMs ?? 0;
    const shown = history[from].filter((frame) => newest - frame.serverMs <= SHOWN_S * 1000);
    const time = shown.map((frame) => (frame.serverMs - newest) / 1000);
    return [time, ...names.map((_, i) => shown.map((frame) => (names.length === 1 ? frame[field] : frame[field][i])))];
  };
  const build = () => {
    plot?.destroy();
    const axis = { stroke: ink, grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1 } };
    plot = new uPlot({
      width: place.clientWidth || 400,
      height: 190,
      scales: { x: { time: false } },
      axes: [{ ...axis, values: (_, ticks) => ticks.map((t) => `${t} s`) }, { ...axis, size: 46 }],
      series: [{ label: "s" }, ...QUANTITIES[choice.value].names.map((label, i) => ({
        label, stroke: COLOURS[i], dash: DASHES[i], width: 1.5, points: { show: false },
      }))],
      legend: { live: false },
    }, data(), place);
  };
  choice.addEventListener("change", build);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", build);
  addEventListener("resize", () => plot?.setSize({ width: place.clientWidth, height: 190 }));
  build();
  let zoomed = false;
  // Of whichever plot is there now.
  place.addEventListener("mousedown", ({ target }) => { zoomed ||= target.closest(".u-over") !== null; });
  place.addEventListener("dblclick", () => { zoomed = false; });
  choice.addEventListener("change", () => { zoomed = false; });
  setInterval(() => {
    if (history.live && !document.hidden) plot.setData(data(), !zoomed);
  }, EVERY_MS);
}
