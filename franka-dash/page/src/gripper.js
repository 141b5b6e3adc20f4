// The Franka Hand: each action begins with a click, and ends by itself, by a stop or with the lease.

import { button, number, row } from "./form.js";

const SPEED = 0.1;
const TOLERANCE = 0.005;

export function gripper(connection) {
  const panel = document.getElementById("gripper-panel");
  const place = document.getElementById("gripper");
  const shown = document.createElement("p");
  let widest = 0;
  const act = (action) => connection.send({ type: "gripper", action });
  const width = number("Width", "motion", { type: "range", min: 0, max: 80, step: 1, value: 40, unit: " mm" });
  const force = number("Force", "motion", { type: "range", min: 10, max: 70, step: 5, value: 30, unit: " N" });
  const metres = () => width.get() / 1000;
  for (const it of [width, force]) it.label.className = "slider";
  const buttons = {
    Home: () => act({ kind: "home" }),
    Open: () => act({ kind: "move", width: widest, speed: SPEED }),
    Close: () => act({ kind: "move", width: 0, speed: SPEED }),
    "Go to width": () => act({ kind: "move", width: metres(), speed: SPEED }),
    "Grasp width": () => act({
      kind: "grasp", width: metres(), tolerance: TOLERANCE, speed: SPEED, force: force.get(),
    }),
    "Let go": () => act({ kind: "stop" }),
  };
  const actions = row();
  for (const [text, begin] of Object.entries(buttons)) {
    const it = button(text, "motion", begin);
    it.dataset.gripper = text;
    actions.append(it);
  }
  place.append(shown, width.label, force.label, actions);
  connection.addEventListener("hello", ({ detail }) => { panel.hidden = !detail.gripper; });
  connection.addEventListener("gripper", ({ detail }) => {
    widest = detail.max_width;
    const millimetres = (metre) => (metre * 1000).toFixed(1);
    const opens = widest > 0 ? ` of ${millimetres(widest)}` : ", not homed";
    const does = detail.acting ? ", moves" : detail.is_grasped ? ", holds an object" : "";
    shown.textContent = `${millimetres(detail.width)} mm${opens}${does}, ${detail.temperature} °C`;
  });
}
