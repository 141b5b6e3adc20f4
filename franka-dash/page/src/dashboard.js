// The page of one robot: puts its parts together. Nothing moves by loading it or by connecting again.

import { Connection } from "./connection.js";
import { events } from "./events.js";
import { endEffector, reference } from "./frame.js";
import { Goal } from "./goal.js";
import { gripper } from "./gripper.js";
import { Guards } from "./guards.js";
import { History } from "./history.js";
import { Hold } from "./hold.js";
import { jog } from "./jog.js";
import { Joints } from "./joints.js";
import { plots } from "./plots.js";
import { Preview } from "./preview.js";
import { record } from "./record.js";
import { Scene } from "./scene.js";
import { simulator } from "./simulator.js";
import { statistics } from "./statistics.js";
import { Strip } from "./strip.js";
import { here, tabs } from "./tabs.js";
import { timeline } from "./timeline.js";
import { tuning } from "./tuning.js";
import { Wrench } from "./wrench.js";

export function dashboard() {
  const byId = (id) => document.getElementById(id);
  const connection = new Connection();
  const history = new History();
  const hold = new Hold(connection);
  const strip = new Strip(connection);
  const scene = new Scene(byId("scene"));
  const preview = new Preview(connection, scene, hold);
  const guards = new Guards();
  const slider = byId("speed");
  const speed = () => Number(slider.value) / 1000;
  slider.addEventListener("input", () => {
    byId("speed-value").textContent = `${slider.value} mm/s`;
    if (hold.active) connection.send({ type: "speed", speed: speed() });
    preview.again();
  });
  jog(hold, speed, () => reference(history.newest));
  const joints = new Joints(hold, preview, speed);
  const goal = new Goal({ scene, hold, preview, speed });
  byId("looks").addEventListener("change", ({ target }) => scene.show3d(target.value));
  tuning(connection);
  const wrench = new Wrench(connection);
  gripper(connection);
  record(connection);
  events(connection);
  statistics(connection);
  simulator(connection, scene, strip);
  timeline(history);
  plots(history);

  connection.addEventListener("hello", ({ detail }) => {
    history.serve(detail.server);
    scene.describe(detail);
    guards.describe(detail);
    joints.describe(detail);
    strip.describe(detail);
    tabs(detail.siblings, "../", here());
    byId("simulator-panel").hidden = !detail.simulated;
    byId("legend").classList.toggle("regions", detail.keep_out.length > 0);
  });
  connection.addEventListener("status", ({ detail }) => strip.setStatus(detail));
  connection.addEventListener("statistics", ({ detail }) => {
    strip.statistics(detail);
    history.told(detail);
  });
  connection.addEventListener("heading", ({ detail }) => scene.heading(detail.way));
  connection.addEventListener("contact", ({ detail }) => { if (history.live) scene.showContact(detail.contact); });
  connection.addEventListener("frame", ({ detail }) => history.add(detail));
  // How long it took until a state was drawn.
  scene.addEventListener("drawn", () => performance.mark("ready"), { once: true });
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
      const lit = guards.lit(shown);
      scene.show(shown, history.behind(shown), lit);
      guards.show(lit);
      joints.show(shown);
      wrench.show(shown);
      strip.show(shown);
      goal.at(endEffector(history.newest));
      preview.at(history.newest.q);
    });
  });
  strip.setStatus(strip.status);

  /** What the page shows, for tests. */
  window.__state = () => ({
    ready: performance.getEntriesByName("ready").length > 0,
    errors,
    mode: shown?.mode ?? null,
    q: shown ? Array.from(shown.q) : null,
    force: shown ? Array.from(shown.force) : null,
    ...(shown ? scene.state() : {}),
    guards: byId("guards").textContent,
    said: byId("goal-said").textContent,
    jointsSaid: byId("joints-said").textContent,
    ...wrench.state(),
    holding: hold.active,
    commands: strip.commands,
    status: strip.status,
    frames: history.frames.length,
    live: history.live,
  });
}
