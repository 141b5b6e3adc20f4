// A target for the end effector: placed by a handle in the scene or by numbers, previewed, and gone
// to while a button is held.

import * as THREE from "three";

const FIELDS = [
  ["x", "mm", 5], ["y", "mm", 5], ["z", "mm", 5],
  ["roll", "°", 1], ["pitch", "°", 1], ["yaw", "°", 1],
];
const WORDS = { x: "x", y: "y", z: "z", roll: "turn about x", pitch: "turn about y", yaw: "turn about z" };
const DEGREES = 180 / Math.PI;
/** Turns about x, y, z of the base, in this order. */
const ORDER = "ZYX";

export class Goal {
  #scene;
  #preview;
  #question;
  #pose = null;
  #inputs;

  constructor({ scene, hold, preview, speed }) {
    this.#scene = scene;
    this.#preview = preview;
    const byId = (id) => document.getElementById(id);
    const [place, remove, go, said] = ["goal-place", "goal-remove", "goal-go", "goal-said"].map(byId);
    this.parts = { place, remove };
    this.#inputs = FIELDS.map(([name, unit, step]) => {
      const label = document.createElement("label");
      label.textContent = name;
      const input = document.createElement("input");
      input.type = "number";
      input.step = step;
      input.setAttribute("aria-label", `target ${WORDS[name]}, ${unit === "mm" ? "millimetres" : "degrees"}`);
      input.dataset.goal = name;
      input.dataset.needs = "motion";
      input.addEventListener("input", () => this.#typed());
      const small = document.createElement("small");
      small.textContent = unit;
      label.append(input, small);
      byId("goal-numbers").append(label);
      return input;
    });
    const motion = () => ({ kind: "pose", ...scene.gizmo.pose });
    this.#question = {
      motion,
      speed,
      said: (text, possible) => {
        said.textContent = text;
        said.classList.toggle("refused", !possible);
      },
    };
    place.addEventListener("click", () => this.place());
    remove.addEventListener("click", () => this.remove());
    byId("gizmo-mode").addEventListener("change", ({ target }) => { scene.gizmo.mode = target.value; });
    byId("axes").addEventListener("change", ({ target }) => { scene.gizmo.axes = target.value; });
    scene.gizmo.addEventListener("moved", () => this.#moved());
    hold.bind(go, () => ({ motion: motion(), speed: speed() }));
    this.remove();
  }

  /** The end effector is here: seven numbers. */
  at(pose) { this.#pose = Array.from(pose); }

  /** Places the target where the end effector is. */
  place() {
    if (!this.#pose) return;
    this.#scene.gizmo.place({ position: this.#pose.slice(0, 3), orientation: this.#pose.slice(3) });
    this.#moved();
  }

  remove() {
    this.#scene.gizmo.remove();
    this.#preview.forget(this.#question);
    this.#question.said("", true);
    for (const input of this.#inputs) input.value = "";
    this.#arrange();
  }

  #arrange() {
    const { placed } = this.#scene.gizmo;
    const { place, remove } = this.parts;
    place.textContent = placed ? "Back to the hand" : "Place a target";
    remove.hidden = !placed;
    document.getElementById("goal-body").hidden = !placed;
  }

  /** The handle has moved: numbers and preview follow. */
  #moved() {
    const { position, orientation } = this.#scene.gizmo.pose;
    const angles = new THREE.Euler().setFromQuaternion(new THREE.Quaternion(...orientation), ORDER);
    const numbers = [...position.map((x) => x * 1000), angles.x * DEGREES, angles.y * DEGREES, angles.z * DEGREES];
    this.#inputs.forEach((input, i) => {
      // What is being typed is left alone.
      if (input !== document.activeElement) input.value = numbers[i].toFixed(i < 3 ? 0 : 1);
    });
    this.#arrange();
    this.#preview.want(this.#question);
  }

  #typed() {
    const numbers = this.#inputs.map((input) => input.valueAsNumber);
    if (!numbers.every(Number.isFinite)) return;
    const [roll, pitch, yaw] = numbers.slice(3).map((angle) => angle / DEGREES);
    const turn = new THREE.Quaternion().setFromEuler(new THREE.Euler(roll, pitch, yaw, ORDER));
    this.#scene.gizmo.place({ position: numbers.slice(0, 3).map((x) => x / 1000), orientation: turn.toArray() });
    this.#moved();
  }
}
