// What can be done to a simulated robot: buttons, and pushes by dragging a link.

import { button } from "./form.js";
import { world } from "./world.js";

const NEWTONS_PER_METRE = 150;
const NEWTONS_MAX = 60;
const EVERY_MS = 50;
const BUTTONS = [
  ["Press user stop", { kind: "user_stop", pressed: true }],
  ["Release user stop", { kind: "user_stop", pressed: false }],
  ["Guide", { kind: "guide", pressed: true }],
  ["Let go", { kind: "guide", pressed: false }],
  ["Close brakes", { kind: "brakes", closed: true }],
  ["Open brakes", { kind: "brakes", closed: false }],
  ["Reflex", { kind: "reflex" }],
];

export function simulator(connection, scene, strip) {
  world(connection);
  const place = document.getElementById("faults");
  const disturb = (disturbance) => connection.send({ type: "disturb", disturbance });
  for (const [text, disturbance] of BUTTONS) {
    const it = button(text, "command", () => disturb(disturbance));
    it.dataset.fault = text;
    place.append(it);
  }
  let timer = null;
  let pointer = null;
  const end = () => {
    if (timer === null) return;
    clearInterval(timer);
    timer = null;
    scene.controls.enabled = true;
  };
  // Before the camera's controls see it.
  scene.canvas.addEventListener("pointerdown", (event) => {
    const hit = strip.commands && event.button === 0 ? scene.pick(event) : null;
    if (!hit || document.getElementById("simulator-panel").hidden) return;
    event.stopImmediatePropagation();
    // The focus stays: a button held by Enter is still held.
    event.preventDefault();
    scene.controls.enabled = false;
    pointer = event;
    timer = setInterval(() => {
      const force = scene.pull(hit.point, pointer).multiplyScalar(NEWTONS_PER_METRE).clampLength(0, NEWTONS_MAX);
      disturb({ kind: "push", link: hit.link, offset: hit.offset, force: force.toArray() });
    }, EVERY_MS);
  }, { capture: true });
  addEventListener("pointermove", (event) => { if (timer !== null) pointer = event; });
  for (const name of ["pointerup", "pointercancel", "blur"]) addEventListener(name, end);
}
