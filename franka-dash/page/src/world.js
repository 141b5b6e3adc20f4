// What is around a simulated robot: the network, a load, an object, and which arm it is.

import { button, choice, number, row } from "./form.js";

const PERFECT = { loss: 0, burst: 1, delay_ms: 0, jitter_ms: 0, stalls_per_second: 0, stall_ms: 0 };
const NETWORKS = {
  perfect: PERFECT,
  "1 % lost": { ...PERFECT, loss: 0.01 },
  "bursts of 8": { ...PERFECT, loss: 0.01, burst: 8 },
  slow: { ...PERFECT, delay_ms: 0.4, jitter_ms: 0.2 },
  "stalls of a Panda": { ...PERFECT, stalls_per_second: 7, stall_ms: 2.6 },
};
const NUMBERS = {
  loss: ["Lost", { min: 0, max: 0.5, step: 0.001 }],
  burst: ["in a row", { min: 1, max: 100, step: 1 }],
  delay_ms: ["Delay", { min: 0, max: 20, step: 0.1, unit: " ms" }],
  jitter_ms: ["jitter", { min: 0, max: 20, step: 0.1, unit: " ms" }],
  stalls_per_second: ["Stalls", { min: 0, max: 50, step: 1, unit: " /s" }],
  stall_ms: ["of", { min: 0, max: 50, step: 0.1, unit: " ms" }],
};

const SPEEDS = [
  ["", "as fast as possible"], ["0", "paused"], ["0.05", "0.05 ×"], ["0.1", "0.1 ×"], ["0.25", "0.25 ×"], ["0.5", "0.5 ×"],
  ["1", "1 ×"], ["2", "2 ×"], ["5", "5 ×"],
];

export function world(connection) {
  const place = document.getElementById("world");
  const disturb = (disturbance) => connection.send({ type: "disturb", disturbance });
  const named = (name, text, act) => {
    const it = button(text, "command", act);
    it.dataset.world = name;
    return it;
  };

  const kinds = ["ideal", "nominal", "realistic", "bad"].map((name) => [name, name]);
  const arm = choice("Arm", "command", kinds);
  arm.select.addEventListener("change", () => disturb({ kind: "arm", arm: arm.select.value }));
  const load = number("Load", "command", { type: "range", min: 0, max: 5, step: 0.1, value: 0, unit: " kg" });
  load.input.addEventListener("change", () => disturb({ kind: "load", mass: load.get() }));
  const seed = document.createElement("span");
  seed.className = "hint";
  const speed = choice("Time passes", "command", SPEEDS);
  speed.select.addEventListener("change", () => {
    disturb({ kind: "speed", speed: speed.select.value === "" ? null : Number(speed.select.value) });
  });
  place.append(row(arm.label, seed), row(load.label), row(speed.label));

  const width = number("Object", "command", { min: 1, max: 80, step: 1, value: 40, unit: " mm" });
  const object = row(
    width.label,
    named("put", "Put it into the hand", () => disturb({ kind: "object", width: width.get() / 1000 })),
    named("take", "Take it away", () => disturb({ kind: "object", width: null })),
  );
  place.append(object);

  const inputs = {};
  const network = choice("Network", "command", Object.keys(NETWORKS).map((name) => [name, name]));
  const show = (conditions) => {
    for (const [name, it] of Object.entries(inputs)) it.set(conditions[name]);
  };
  const numbers = row();
  for (const [name, [text, range]] of Object.entries(NUMBERS)) {
    inputs[name] = number(text, "command", { ...range, value: PERFECT[name] });
    numbers.append(inputs[name].label);
  }
  const apply = () => {
    const conditions = {};
    for (const [name, it] of Object.entries(inputs)) conditions[name] = it.get();
    disturb({ kind: "network", conditions });
  };
  network.select.addEventListener("change", () => {
    show(NETWORKS[network.select.value]);
    apply();
  });
  const cut = (milliseconds, text) => named(`cut-${milliseconds}`, text, () => disturb({ kind: "cut", milliseconds }));
  place.append(
    row(network.label, cut(25, "Cut for 25 ms"), cut(1000, "Cut for 1 s")),
    numbers,
    row(named("network", "Set the network", apply)),
  );

  connection.addEventListener("hello", ({ detail }) => {
    object.hidden = !detail.simulated_hand;
    speed.label.parentElement.hidden = !detail.virtual_time;
  });
  connection.addEventListener("status", ({ detail: { simulation } }) => {
    if (!simulation) return;
    if (simulation.arm) arm.select.value = simulation.arm;
    load.set(simulation.load);
    speed.select.value = simulation.speed === null ? "" : String(simulation.speed);
    if (simulation.network) show(simulation.network);
    seed.textContent = simulation.seed === null ? "" : `seed ${simulation.seed}`;
  });
}
