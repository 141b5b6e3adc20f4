import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";

import { Guards } from "../src/guards.js";
import { History } from "../src/history.js";
import { newPage } from "./page.js";

beforeEach(newPage);

const frame = (serverMs) => ({ serverMs, poses: new Float32Array(80) });

test("history keeps the last 60 seconds", () => {
  const history = new History();
  history.serve(1);
  for (let ms = 0; ms < 200_000; ms += 100) history.add(frame(ms));
  assert.ok(history.frames.length < 800, `${history.frames.length} frames`);
});

test("history begins anew with another server", () => {
  const history = new History();
  let cleared = 0;
  history.addEventListener("cleared", () => { cleared += 1; });
  history.serve(1);
  for (let ms = 3_600_000; ms < 3_700_000; ms += 100) history.add(frame(ms));
  history.told({ recent: {} });
  history.choose(10);
  // The same one, by another connection.
  history.serve(1);
  assert.ok(history.frames.length > 100);
  assert.equal(cleared, 1);
  history.serve(2);
  assert.equal(cleared, 2);
  assert.deepEqual([history.frames, history.control, history.live], [[], [], true]);
  for (let ms = 0; ms < 100_000; ms += 100) history.add(frame(ms));
  assert.ok(history.frames.length < 800, `${history.frames.length} frames`);
});

test("guards of the server before do not light up", () => {
  const guards = new Guards();
  guards.describe({ guards: ["leash"] });
  assert.ok(guards.lit({ guards: 1, serverMs: 5000 }).has("leash"));
  guards.describe({ guards: ["leash"] });
  assert.equal(guards.lit({ guards: 0, serverMs: 5500 }).size, 0);
});
