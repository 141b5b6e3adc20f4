// Recordings in a folder of the server: it names the file.

import { button, row } from "./form.js";

export function record(connection) {
  const panel = document.getElementById("record-panel");
  const shown = document.createElement("span");
  let recording = null;
  const toggle = button("Record", "command", () => connection.send({ type: "record", on: recording === null }));
  toggle.id = "record";
  panel.append(row(toggle, shown));
  connection.addEventListener("hello", ({ detail }) => { panel.hidden = !detail.records; });
  connection.addEventListener("recording", ({ detail }) => {
    recording = detail.recording;
    toggle.textContent = recording ? "End recording" : "Record";
    toggle.classList.toggle("held", recording !== null);
    if (!recording) {
      shown.textContent = "";
      return;
    }
    const { file, cycles, dropped, bytes } = recording;
    shown.textContent = `${file}: ${cycles} cycles, ${dropped} dropped, ${(bytes / 1e6).toFixed(1)} MB`;
  });
}
