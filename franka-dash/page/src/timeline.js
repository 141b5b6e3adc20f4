// Scrubber, pause and export.

export function timeline(history) {
  const scrub = document.getElementById("scrub");
  const label = document.getElementById("scrub-time");
  scrub.min = -60;
  scrub.max = 0;
  scrub.step = 0.05;
  scrub.value = 0;
  const choose = () => {
    const seconds = -Number(scrub.value);
    history.choose(seconds);
    label.textContent = seconds > 0 ? `-${seconds.toFixed(1)} s` : "live";
  };
  scrub.addEventListener("input", choose);
  document.getElementById("live").addEventListener("click", () => { scrub.value = 0; choose(); });
  document.getElementById("export").addEventListener("click", () => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([history.csv()], { type: "text/csv" }));
    link.download = "franka.csv";
    link.click();
    URL.revokeObjectURL(link.href);
  });
}
