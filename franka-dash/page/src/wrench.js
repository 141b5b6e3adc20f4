// The external wrench as the robot shows it, and beside it without a tare: what an untouched arm shows.

import { button, row } from "./form.js";

const NAMES = ["Fx", "Fy", "Fz", "Mx", "My", "Mz"];

/** A row of a table: its name, and cells to be filled. */
function line(name, kind = "td") {
  const it = document.createElement("tr");
  const head = Object.assign(document.createElement(kind), { textContent: name });
  const cells = NAMES.map(() => document.createElement(kind));
  it.append(head, ...cells);
  return { it, cells };
}

const fill = ({ cells }, texts) => cells.forEach((cell, i) => {
  if (cell.textContent !== texts[i]) cell.textContent = texts[i];
});
const numbers = (values) => values.map((value) => value.toFixed(1));

/** The wrench without the tare; null without one, and where the robot has no estimate. */
export const compensated = (wrench, tare) =>
  tare && wrench.some((value) => value !== 0) ? Array.from(wrench, (value, i) => value - tare.wrench[i]) : null;

/** How far the arm has turned since the tare: the farthest joint, rad. */
export const turned = (q, tare) => Math.max(...tare.q.map((from, joint) => Math.abs(q[joint] - from)));

/** What a tare is worth where the arm is. */
export function validity(q, tare) {
  const degrees = (radians) => `${(radians * 180 / Math.PI).toFixed(1)}°`;
  const way = turned(q, tare);
  const posture = tare.q.map(degrees).join(" ");
  return way <= tare.near
    ? `The tare is valid here. Taken at ${posture}.`
    : `A joint has turned by ${degrees(way)} since the tare, expected ${degrees(tare.near)} at most: take a new tare. Taken at ${posture}.`;
}

export class Wrench {
  #tare = null;
  #said = document.getElementById("wrench-said");
  #raw = line("shown");
  #without = line("tared");

  constructor(connection) {
    const send = (on) => connection.send({ type: "tare", on });
    const take = button("Tare", "motion", () => send(true));
    const clear = button("Clear tare", "motion", () => send(false));
    take.id = "tare";
    clear.id = "tare-clear";
    take.title = "The arm must rest, untouched, for half a second. Nothing moves.";
    const actions = row(take, clear);
    const names = line("", "th");
    fill(names, NAMES);
    document.querySelector("#wrench tbody").append(names.it, this.#raw.it, this.#without.it);
    document.getElementById("wrench-panel").append(actions);
    connection.addEventListener("hello", ({ detail }) => { actions.hidden = !detail.motion_allowed; });
    connection.addEventListener("tare", ({ detail }) => { this.#tare = detail.tare; });
  }

  show({ force, q }) {
    const raw = Array.from(force);
    const without = compensated(raw, this.#tare);
    fill(this.#raw, numbers(raw));
    fill(this.#without, without ? numbers(without) : NAMES.map(() => "–"));
    const text = this.#tare ? validity(q, this.#tare) : "";
    if (this.#said.textContent !== text) this.#said.textContent = text;
    this.#said.classList.toggle("refused", this.#tare !== null && turned(q, this.#tare) > this.#tare.near);
  }

  /** What is shown, for tests. */
  state() {
    return { tared: this.#tare !== null, wrenchSaid: this.#said.textContent };
  }
}
