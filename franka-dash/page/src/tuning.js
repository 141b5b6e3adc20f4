// How stiff the arm is while a button is held: presets of the server, and each number.

import { button, number, row } from "./form.js";

const FACTORS = {
  end_effector: ["End effector", { min: 0.1, max: 4, step: 0.05, unit: "×" }],
  joints: ["Joints", { min: 0.1, max: 2, step: 0.05, unit: "×" }],
  damping: ["Damping", { min: 0.5, max: 1.3, step: 0.05, unit: "×" }],
  force_cap: ["Presses with", { min: 5, max: 60, step: 1, unit: " N" }],
};

export function tuning(connection) {
  const place = document.getElementById("tuning");
  const presets = row();
  const send = (wanted) => connection.send({ type: "tune", tuning: wanted });
  const inputs = {};
  const compensation = document.createElement("input");
  const current = () => {
    const wanted = { compensation: compensation.checked };
    for (const [name, it] of Object.entries(inputs)) wanted[name] = it.get();
    return wanted;
  };
  place.append(presets);
  for (const [name, [text, range]] of Object.entries(FACTORS)) {
    inputs[name] = number(text, "motion", { ...range, type: "range", value: range.min });
    inputs[name].label.className = "slider";
    inputs[name].input.addEventListener("change", () => send(current()));
    place.append(inputs[name].label);
  }
  const label = document.createElement("label");
  label.title = "Press Enter to switch it. Space stops the arm.";
  Object.assign(compensation, { type: "checkbox", disabled: true });
  compensation.dataset.needs = "motion";
  compensation.addEventListener("change", () => send(current()));
  label.append(compensation, " friction compensated");
  place.append(row(label));
  connection.addEventListener("hello", ({ detail }) => {
    document.getElementById("tuning-panel").hidden = !detail.motion_allowed;
    presets.replaceChildren(...detail.tunings.map(({ name, tuning: wanted }) => {
      const it = button(name, "motion", () => send(wanted));
      it.dataset.tuning = name;
      it.dataset.numbers = JSON.stringify(wanted);
      return it;
    }));
  });
  connection.addEventListener("status", ({ detail }) => {
    for (const [name, it] of Object.entries(inputs)) it.set(detail.tuning[name]);
    compensation.checked = detail.tuning.compensation;
    const numbers = JSON.stringify(detail.tuning);
    for (const it of presets.children) it.classList.toggle("held", it.dataset.numbers === numbers);
  });
}
