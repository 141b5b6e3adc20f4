// The last seconds of the hand: what the driver commands, and what the arm does.

import uPlot from "uplot";

const SHOWN_S = 10;
const EVERY_MS = 50;
/** A speed is that over so many samples: between two, noise is most of it. */
const SPAN = 4;

const apart = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) * 1000;

/** Of the samples: `who` is `arm` or `command`; the number at one of them, and the least range. */
const QUANTITIES = {
  "From target, mm": {
    least: 10,
    at: (samples, i, who) => apart(samples[i][who], samples[i].target),
  },
  "Speed, mm/s": {
    least: 50,
    at: (samples, i, who) => {
      const before = samples[i - SPAN];
      return before ? apart(samples[i][who], before[who]) / (samples[i].seconds - before.seconds) : null;
    },
  },
};

export class Chart {
  #samples = [];
  #plot = null;
  #drawn = 0;

  constructor() {
    this.place = document.getElementById("plot");
    this.choice = document.getElementById("plotted");
    for (const name of Object.keys(QUANTITIES)) this.choice.add(new Option(name));
    this.choice.addEventListener("change", () => this.#draw());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#build());
    new ResizeObserver(() => this.#build()).observe(this.place);
  }

  clear() { this.#samples = []; }

  /** Takes places: `seconds`, `target`, `command`, `arm`. */
  add(sample) {
    // A frame of no time tells nothing.
    if (sample.seconds === this.#samples.at(-1)?.seconds) return;
    this.#samples.push(sample);
    while (sample.seconds - this.#samples[0].seconds > SHOWN_S) this.#samples.shift();
    if (performance.now() - this.#drawn > EVERY_MS) this.#draw();
  }

  #draw() {
    this.#drawn = performance.now();
    this.#plot?.setData(this.#data());
  }

  #data() {
    const { at } = QUANTITIES[this.choice.value];
    const newest = this.#samples.at(-1)?.seconds ?? 0;
    const of = (who) => this.#samples.map((_, i) => at(this.#samples, i, who));
    return [this.#samples.map(({ seconds }) => seconds - newest), of("command"), of("arm")];
  }

  #build() {
    this.#plot?.destroy();
    this.#plot = null;
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width || !height) return;
    const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const axis = { stroke: colour("--quiet"), grid: { stroke: colour("--line"), width: 1 }, ticks: { show: false }, font: "11px system-ui" };
    const range = (_, __, most) => [0, Math.max(QUANTITIES[this.choice.value].least, (most ?? 0) * 1.05)];
    this.#plot = new uPlot({
      width, height,
      cursor: { show: false },
      legend: { show: false },
      padding: [6, 8, 0, 0],
      scales: { x: { time: false, range: [-SHOWN_S, 0] }, y: { range } },
      axes: [
        { ...axis, size: 22, gap: 2, values: (_, ticks) => ticks.map((t) => `${t} s`) },
        { ...axis, size: 34, gap: 2, space: 24 },
      ],
      series: [{}, { stroke: "#e09a2c", width: 2, points: { show: false } }, { stroke: "#2f7de1", width: 1.5, points: { show: false } }],
    }, this.#data(), this.place);
  }
}
