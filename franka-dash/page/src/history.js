// The last 60 seconds: what is shown is the newest frame, or one of these.

import { endEffector } from "./frame.js";

const KEPT_MS = 60_000;
const BEHIND_MS = 10_000;
/** Distance of two places of a trail at least, `[m]`. */
const BEHIND_STEP = 0.004;

export class History extends EventTarget {
  frames = [];
  /** How punctual control was: one line for each time it was told. */
  control = [];
  #chosen = null;
  #server = null;

  /** What comes next is of this server: frames of another one have times of another clock. */
  serve(server) {
    if (server === this.#server) return;
    this.#server = server;
    this.frames = [];
    this.control = [];
    this.#chosen = null;
    this.dispatchEvent(new Event("cleared"));
  }

  add(frame) {
    this.frames.push(frame);
    let old = 0;
    while (frame.serverMs - this.frames[old].serverMs > KEPT_MS) old += 1;
    // Rarely, since it moves all that is kept.
    if (old > 120) this.frames.splice(0, old);
    if (this.#chosen === null) this.#show(frame);
  }

  /** Takes what was told of the control thread, as of the newest frame. */
  told({ recent }) {
    if (!recent || !this.newest) return;
    this.control.push({ serverMs: this.newest.serverMs, ...recent });
    while (this.newest.serverMs - this.control[0].serverMs > KEPT_MS) this.control.shift();
  }

  get live() { return this.#chosen === null; }

  get newest() { return this.frames[this.frames.length - 1]; }

  /** Shows what was `seconds` before the newest frame; the newest as it comes for 0. */
  choose(seconds) {
    if (!this.newest) return;
    if (seconds <= 0) {
      this.#chosen = null;
      this.#show(this.newest);
      return;
    }
    const wanted = this.newest.serverMs - seconds * 1000;
    this.#chosen = this.frames.find((frame) => frame.serverMs >= wanted) ?? this.newest;
    this.#show(this.#chosen);
  }

  /** Where the end effector was in the 10 s before a frame, and in it: `[x, y, z]` each. */
  behind(frame) {
    const places = [];
    for (let i = this.frames.length - 1; i >= 0; i -= 1) {
      const at = this.frames[i];
      if (at.serverMs > frame.serverMs) continue;
      if (frame.serverMs - at.serverMs > BEHIND_MS) break;
      const [x, y, z] = endEffector(at);
      const last = places[places.length - 1];
      if (!last || Math.hypot(x - last[0], y - last[1], z - last[2]) > BEHIND_STEP) places.push([x, y, z]);
    }
    return places;
  }

  #show(frame) {
    this.dispatchEvent(new CustomEvent("show", { detail: frame }));
  }

  /** All that is kept as comma-separated values. */
  csv() {
    const names = ["robot_ms", "mode", "law", "success_rate", "guards", "width"];
    const columns = { q: 7, dq: 7, tau: 7, tauExt: 7, force: 6, reference: 7 };
    for (const [name, count] of Object.entries(columns)) {
      for (let i = 0; i < count; i += 1) names.push(`${name}_${i}`);
    }
    const row = (frame) => [frame.robotMs, frame.mode, frame.law, frame.success, frame.guards, frame.width,
      ...Object.keys(columns).flatMap((name) => Array.from(frame[name]))].join(",");
    return [names.join(","), ...this.frames.map(row), ""].join("\n");
  }
}
