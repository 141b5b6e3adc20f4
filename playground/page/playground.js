// The book's playground: driver and simulator in this page, an arm to aim and to push.

import "uplot/dist/uPlot.min.css";
import "./style.css";
import { Guards } from "../../franka-dash/page/src/guards.js";
import { Scene } from "../../franka-dash/page/src/scene.js";
import { Chart } from "./chart.js";
import { poses, tool } from "./kinematics.js";
import { Push } from "./push.js";
import { Simulation, FOLLOWING, STOPPED } from "./simulation.js";

/** Of simulated time at once: a slow screen sees a slow arm. */
const LONGEST_MS = 50;
const TEXTS_MS = 100;
/** Corners of the targets, from the first place of the hand, `[m]`: 20 cm from one to the next. */
const CORNERS = [[0, 0, 0], [0, 0.2, 0], [0.2, 0.2, 0], [0.2, 0, 0]];
/** Where a pointer finds the hand, on the flange: larger than the hand, for fingers. */
const HAND = [{ link: 8, start: [0.04, 0.04, 0.03], end: [-0.04, -0.04, 0.03], radius: 0.05 }];
const OPEN = 0.08;
/** The camera, than that of the dashboard. */
const NEARER = 0.75;
/** What counts as at the target, `[m]`. */
const NEAR = 0.002;
const STATES = [["follows", "move"], ["starts", "stopped"], ["stopped itself", "reflex"]];

const byId = (id) => document.getElementById(id);
const write = (id, text) => { if (byId(id).textContent !== text) byId(id).textContent = text; };
const press = (it, on) => it.setAttribute("aria-pressed", String(on));

function fail(text, error) {
  console.warn(text, error);
  byId("failure").textContent = text;
  byId("failure").hidden = false;
  byId("hint").hidden = true;
  write("state", "not there");
  for (const it of document.querySelectorAll("button, select")) it.disabled = true;
}

class Playground {
  #scene;
  #simulation;
  #push;
  #chart = new Chart();
  #guards = new Guards();
  #kind = "fr3";
  #real = true;
  #seed = 0;
  #corner = 0;
  #home = null;
  #tool = null;
  #blocked = false;
  #last = null;
  #rest = 0;
  #told = 0;
  view = null;

  constructor(scene, simulation) {
    this.#scene = scene;
    this.#simulation = simulation;
    this.#push = new Push(scene);
    // The page around it scrolls.
    scene.controls.enableZoom = window.parent === window;
    scene.controls.target.set(0.28, 0, 0.4);
    scene.controls.object.position.sub(scene.controls.target).multiplyScalar(NEARER).add(scene.controls.target);
    scene.controls.update();
    scene.gizmo.addEventListener("moved", () => simulation.target(scene.gizmo.pose));
    this.#guards.describe({ guards: simulation.guardNames });
    byId("next").addEventListener("click", () => this.#next());
    byId("recover").addEventListener("click", () => this.#recover());
    byId("reset").addEventListener("click", () => this.#start());
    byId("block").addEventListener("click", () => this.#block(!this.#blocked));
    for (const it of document.querySelectorAll("[data-kind]")) {
      it.addEventListener("click", () => { this.#kind = it.dataset.kind; this.#start(); });
    }
    for (const it of document.querySelectorAll("[data-arm]")) {
      it.addEventListener("click", () => { this.#real = it.dataset.arm === "real"; this.#start(); });
    }
    this.#start();
  }

  get scene() { return this.#scene; }

  /** A new arm; its looks come by themselves. */
  #start() {
    this.#seed += 1;
    this.#simulation.start(this.#kind, this.#real, this.#seed);
    this.#block(false);
    const { q, endEffector } = this.#simulation.view();
    this.#tool = tool(q, endEffector);
    this.#home = endEffector;
    this.#corner = 0;
    this.#aim();
    this.#chart.clear();
    this.#scene.describe({ capsules: HAND, meshes: this.#kind, keep_out: [] });
    for (const it of document.querySelectorAll("[data-kind]")) press(it, it.dataset.kind === this.#kind);
    for (const it of document.querySelectorAll("[data-arm]")) press(it, (it.dataset.arm === "real") === this.#real);
  }

  #block(on) {
    this.#blocked = on;
    this.#simulation.block(on);
    press(byId("block"), on);
  }

  #next() {
    this.#corner = (this.#corner + 1) % CORNERS.length;
    this.#aim();
  }

  #aim() {
    const position = CORNERS[this.#corner].map((x, i) => x + this.#home[i]);
    this.#scene.gizmo.place({ position, orientation: this.#home.slice(3) });
    this.#simulation.target(this.#scene.gizmo.pose);
  }

  /** The arm stays where it is: so does its target. */
  #recover() {
    this.#block(false);
    this.#simulation.recover();
    const { target } = this.#simulation.view();
    this.#scene.gizmo.place({ position: target.slice(0, 3), orientation: target.slice(3) });
  }

  /** The time that has passed on the screen passes for the arm, too. */
  step(now) {
    const elapsed = this.#last === null ? 0 : Math.min(now - this.#last + this.#rest, LONGEST_MS);
    this.#last = now;
    const whole = Math.floor(elapsed);
    this.#rest = elapsed - whole;
    this.#simulation.push(this.#push.force((this.view ?? this.#simulation.view()).endEffector));
    this.#simulation.advance(whole);
    this.view = this.#simulation.view();
    this.#show(this.view);
    if (now - this.#told > TEXTS_MS) {
      this.#told = now;
      this.#tell(this.view);
    }
  }

  pause() { this.#last = null; }

  #show({ seconds, q, reference, target, endEffector, force, guards }) {
    const frame = {
      q, reference,
      // The scene takes the estimate as the robot gives it: what the arm exerts.
      force: force.map((f) => -f),
      poses: poses(q, this.#tool),
      referencePoses: poses(reference, this.#tool),
      width: OPEN,
    };
    const lit = this.#guards.lit({ guards, serverMs: seconds * 1000 });
    this.#guards.show(lit);
    this.#scene.show(frame, [], lit);
    this.#chart.add({ seconds, target: target.slice(0, 3), command: frame.referencePoses.slice(-7, -4), arm: endEffector.slice(0, 3) });
  }

  /** What the driver has to say, or else what the arm does. */
  #words(state, distance) {
    // What the robot itself says has more lines, for those who know it.
    const [message] = this.#simulation.message.split("\n");
    if (message) return message;
    if (state !== FOLLOWING) return "The arm is about to follow its target.";
    if (this.#push.active) return "The arm gives way to the push.";
    if (this.#blocked) return "An obstacle holds the hand.";
    return distance < NEAR ? "The arm is at its target." : "The arm goes to its target.";
  }

  #tell({ state, speed, distance, force }) {
    const [word, kind] = STATES[state] ?? ["unknown", ""];
    write("state", word);
    byId("state").className = `badge ${kind}`;
    write("message", this.#words(state, distance));
    write("speed", `${(speed * 1000).toFixed(0)} mm/s`);
    write("distance", `${(distance * 1000).toFixed(1)} mm`);
    write("force", `${Math.hypot(...force).toFixed(1)} N`);
    byId("recover").disabled = state === FOLLOWING;
    byId("recover").classList.toggle("wanted", state === STOPPED);
  }
}

async function main() {
  let errors = 0;
  addEventListener("error", () => { errors += 1; });
  addEventListener("unhandledrejection", () => { errors += 1; });
  if (typeof WebAssembly === "undefined") return fail("The playground needs WebAssembly, which this browser has not.");
  let scene;
  try {
    scene = new Scene(byId("scene"));
  } catch (error) {
    return fail("The playground needs WebGL, which this browser has not, or has switched off.", error);
  }
  let simulation;
  try {
    simulation = await Simulation.load();
  } catch (error) {
    return fail("The simulation could not be loaded. A file that is opened without a server cannot load another.", error);
  }
  const playground = new Playground(scene, simulation);
  // Out of sight, in a hidden window or further down the page, it takes no time.
  let seen = true;
  new IntersectionObserver(([{ isIntersecting }]) => { seen = isIntersecting; }).observe(scene.canvas);
  const step = (now) => {
    try {
      if (seen) playground.step(now);
      else playground.pause();
    } catch (error) {
      return fail("The simulation has failed. Load the page again.", error);
    }
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);

  /** What the page shows, for tests. */
  window.__state = () => ({ errors, ...scene.state(), view: playground.view });
}

main();
