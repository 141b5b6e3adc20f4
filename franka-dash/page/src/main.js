// Puts the parts of the page together. Nothing moves by loading it or by connecting again.

import "uplot/dist/uPlot.min.css";
import "./style.css";
import { Connection } from "./connection.js";
import { events } from "./events.js";
import { gripper } from "./gripper.js";
import { History } from "./history.js";
import { Hold } from "./hold.js";
import { jog } from "./jog.js";
import { Joints } from "./joints.js";
import { plots } from "./plots.js";
import { record } from "./record.js";
import { Scene } from "./scene.js";
import { simulator } from "./simulator.js";
import { statistics } from "./statistics.js";
import { Strip } from "./strip.js";
import { timeline } from "./timeline.js";
import { tuning } from "./tuning.js";

const connection = new Connection();
const history = new History();
const hold = new Hold(connection);
const strip = new Strip(connection);
const scene = new Scene(document.getElementById("scene"));
const slider = document.getElementById("speed");
const speed = () => Number(slider.value) / 1000;
slider.addEventListener("input", () => {
  document.getElementById("speed-value").textContent = `${slider.value} mm/s`;
  if (hold.active) connection.send({ type: "speed", speed: speed() });
});
jog(hold, speed);
const joints = new Joints(hold, speed);
tuning(connection);
gripper(connection);
record(connection);
events(connection);
statistics(connection);
simulator(connection, scene, strip);
timeline(history);
plots(history);

connection.addEventListener("hello", ({ detail }) => {
  scene.describe(detail.capsules);
  joints.describe(detail);
  strip.describe(detail);
  document.getElementById("simulator-panel").hidden = !detail.simulated;
});
connection.addEventListener("status", ({ detail }) => strip.setStatus(detail));
connection.addEventListener("statistics", ({ detail }) => strip.statistics(detail));
connection.addEventListener("frame", ({ detail }) => history.add(detail));
let errors = 0;
addEventListener("error", () => { errors += 1; });
addEventListener("unhandledrejection", () => { errors += 1; });

// What is to be shown is drawn with the browser's next picture, however many came before it.
let shown = null;
let due = false;
history.addEventListener("show", ({ detail }) => {
  shown = detail;
  if (due) return;
  due = true;
  requestAnimationFrame(() => {
    due = false;
    scene.show(shown);
    joints.show(shown);
    strip.show(shown);
  });
});
strip.setStatus(strip.status);

/** What the page shows, for tests. */
window.__state = () => ({
  ready: shown !== null,
  errors,
  mode: shown?.mode ?? null,
  q: shown ? Array.from(shown.q) : null,
  force: shown ? Array.from(shown.force) : null,
  endEffector: scene.endEffector(),
  forceShown: scene.forceShown,
  holding: hold.active,
  commands: strip.commands,
  status: strip.status,
  frames: history.frames.length,
  live: history.live,
  links: [1, 2, 3, 4, 5, 6, 7].map((link) => (shown ? scene.onPage(link) : null)),
});
