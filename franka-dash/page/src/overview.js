// All robots of the server side by side: what they do, and one button that stops them all.

import { Connection } from "./connection.js";
import { endEffector, MODES, MODE_CLASSES } from "./frame.js";
import { listed } from "./robots.js";
import { Scene } from "./scene.js";
import { Stop, stopControls } from "./stop.js";
import { tabs } from "./tabs.js";

const BEHIND = 120;

/** Shows a line above the robots. */
export function tell(text) {
  const notice = document.getElementById("notice");
  notice.textContent = text;
  notice.hidden = false;
}

class Card {
  #frames = 0;
  #behind = [];
  #scene;
  #due = false;

  constructor(name) {
    this.name = name;
    this.element = document.createElement("section");
    this.element.className = "panel card";
    this.element.innerHTML = `<h2><a></a><span class="badge" role="status">connecting</span></h2><canvas></canvas>
      <div class="row"><span class="fact">Commander <b></b></span><button class="stop" type="button">Stop</button></div>`;
    const link = this.element.querySelector("a");
    link.textContent = name;
    link.href = `${name}/${location.hash}`;
    document.getElementById("cards").append(this.element);
    const canvas = this.element.querySelector("canvas");
    canvas.setAttribute("aria-label", `${name} in 3D`);
    this.badge = this.element.querySelector(".badge");
    this.commander = this.element.querySelector(".fact b");
    this.#scene = new Scene(canvas);
    this.connection = new Connection(`${name}/`);
    this.stop = new Stop(this.connection, name);
    const stop = this.element.querySelector(".stop");
    stop.setAttribute("aria-label", `stop ${name}`);
    stop.addEventListener("click", () => this.stop.press());
    this.connection.addEventListener("hello", ({ detail }) => {
      this.#behind = [];
      link.textContent = `${name}: ${detail.robot}${detail.simulated ? ", simulated" : ""}`;
      this.#scene.describe(detail);
    });
    this.connection.addEventListener("status", ({ detail }) => {
      this.commander.textContent = detail.name ?? "none";
    });
    this.connection.addEventListener("heading", ({ detail }) => this.#scene.heading(detail.way));
    this.connection.addEventListener("contact", ({ detail }) => this.#scene.showContact(detail.contact));
    // The log is on the page of the robot; that a stop failed is said here, too.
    this.connection.addEventListener("event", ({ detail }) => {
      if (detail.level === "error") tell(`${name}: ${detail.text}`);
    });
    this.connection.addEventListener("closed", () => this.#show("no connection", ""));
    this.connection.addEventListener("denied", ({ detail }) => {
      this.#show("no access", "");
      this.badge.title = detail.why;
    });
    this.connection.addEventListener("frame", ({ detail }) => this.#take(detail));
  }

  #take(frame) {
    this.#frames += 1;
    this.frame = frame;
    if (this.#due) return;
    this.#due = true;
    requestAnimationFrame(() => {
      this.#due = false;
      this.#behind = [...this.#behind, Array.from(endEffector(this.frame).subarray(0, 3))].slice(-BEHIND);
      this.#scene.show(this.frame, this.#behind, new Set());
      this.#show(MODES[this.frame.mode] ?? "unknown", MODE_CLASSES[this.frame.mode] ?? "");
    });
  }

  #show(mode, kind) {
    this.badge.textContent = mode;
    this.badge.className = `badge ${kind}`;
  }

  state() {
    return { name: this.name, frames: this.#frames, mode: this.frame?.mode ?? null, ...this.#scene.state() };
  }
}

export async function overview() {
  const add = stopControls([]);
  const answer = await listed(() => tell("No connection to the server. The page asks again each second."));
  document.getElementById("notice").hidden = true;
  if (!answer.ok) {
    const denied = document.createElement("p");
    denied.setAttribute("role", "alert");
    denied.textContent = `No access: ${await answer.text()}`;
    document.getElementById("cards").append(denied);
    return;
  }
  const names = await answer.json();
  tabs(names, "", "");
  const cards = names.map((name) => new Card(name));
  add(cards.map((card) => card.stop));
  window.__state = () => ({ ready: cards.every((card) => card.frame), cards: cards.map((card) => card.state()) });
}
