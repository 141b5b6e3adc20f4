// Scrubber, pause and export.

export function timeline(history) {
  const scrub = document.getElementById("scrub");
  const label = document.getElementById("scrub-time");
  scrub.min = -60;
  scrub.max = 0;
  scrub.step = 0.05;
  scrub.value = 0;
  const pause = document.getElementById("pause");
  const choose = (seconds) => {
    history.choose(seconds);
    label.textContent = seconds > 0 ? `-${seconds.toFixed(1)} s` : "live";
    pause.textContent = history.live ? "Pause" : "Live";
  };
  history.addEventListener("cleared", () => {
    scrub.value = 0;
    choose(0);
  });
  scrub.addEventListener("input", () => choose(-Number(scrub.value)));
  pause.addEventListener("click", () => {
    const step = Number(scrub.step);
    scrub.value = history.live ? -step : 0;
    choose(history.live ? step : 0);
  });
  document.getElementById("export").addEventListener("click", () => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([history.csv()], { type: "text/csv" }));
    link.download = "franka.csv";
    link.click();
    URL.revokeObjectURL(link.href);
  });
}
