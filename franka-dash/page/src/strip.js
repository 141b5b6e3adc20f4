// The lines at the top: mode, session, law, who commands, deadman, real-time priority, how far away
// the server is; and the stop.

import { LAWS, MODES, MODE_CLASSES } from "./frame.js";
import { Stop, stopControls } from "./stop.js";
import { here } from "./tabs.js";

const ALIVE_MS = 1000;

/** Writes what has changed: 60 times per second, all else would be laid out again. */
const write = (id, text) => {
  const place = document.getElementById(id);
  if (place.textContent !== text) place.textContent = text;
};

export class Strip {
  status = { commander: null, name: null, holding: false };
  #hello = null;

  constructor(connection) {
    const byId = (id) => document.getElementById(id);
    this.mode = byId("mode");
    stopControls([new Stop(connection)]);
    byId("lease").addEventListener("click", () => {
      const request = this.commands ? { type: "release" } : { type: "take", name: `viewer ${this.#hello?.viewer}` };
      connection.send(request);
    });
    byId("recover").addEventListener("click", () => connection.send({ type: "recover" }));
    setInterval(() => { if (this.commands) connection.send({ type: "alive" }); }, ALIVE_MS);
    connection.addEventListener("closed", () => this.#without("no connection"));
    connection.addEventListener("denied", () => this.#without("no access"));
  }

  get commands() { return this.#hello !== null && this.status.commander === this.#hello.viewer; }

  #without(what) {
    this.mode.textContent = what;
    this.mode.className = "badge";
    this.setStatus({ commander: null, name: null, holding: false });
  }

  describe(hello) {
    this.#hello = hello;
    const robot = hello.robot + (hello.simulated ? ", simulated" : "");
    document.getElementById("robot").textContent = robot;
    const name = hello.siblings.length ? `${here()}: ` : "";
    document.title = `${name}${robot} – Franka dashboard`;
    this.setStatus(this.status);
  }

  setStatus(status) {
    this.status = status;
    const hello = this.#hello;
    const may = hello?.may_command;
    write("commander", status.name ?? "none");
    write("deadman", status.holding ? "fed" : status.expired ? "expired" : "off");
    const lease = document.getElementById("lease");
    lease.textContent = this.commands ? "Release" : hello && !may ? "View only" : "Take command";
    lease.title = hello && !may ? "this server was started without permission to move the arm" : "";
    lease.disabled = !may || (status.name !== null && !this.commands);
    const moves = this.commands && hello?.motion_allowed;
    for (const it of document.querySelectorAll("#recover, #jog button, .joint button")) it.disabled = !moves;
    for (const it of document.querySelectorAll("[data-needs]")) {
      it.disabled = !(it.dataset.needs === "motion" ? moves : this.commands);
    }
  }

  show(frame) {
    write("mode", MODES[frame.mode] ?? "unknown");
    this.mode.className = `badge ${MODE_CLASSES[frame.mode] ?? ""}`;
    const session = frame.holding ? "held" : frame.running ? "running" : "none";
    write("session", session);
    write("law", LAWS[frame.law] ?? "unknown");
    write("success", frame.running ? `${(frame.success * 100).toFixed(0)} %` : "–");
  }

  statistics({ round_trip_ms: roundTrip, thread }) {
    const priority = thread?.priority ?? null;
    write("real-time", priority !== null ? `FIFO ${priority}` : thread ? "not granted" : "–");
    write("round-trip", roundTrip === null ? "–" : `${roundTrip.toFixed(0)} ms`);
  }
}
