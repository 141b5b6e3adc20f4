import assert from "node:assert/strict";
import { test } from "node:test";

import { compensated, turned, validity } from "../src/wrench.js";

const tare = {
  wrench: [1, -2, 3, 0, 0.5, 0], deviation: [0, 0, 0, 0, 0, 0], q: [0, -0.8, 0, -2.4, 0, 1.6, 0.8], near: 0.035,
};

test("tare comes off the wrench unless the robot has no estimate", () => {
  assert.deepEqual(compensated([2, 0, 3, 0, 0, 0], tare), [1, 2, 0, 0, -0.5, 0]);
  assert.equal(compensated([2, 0, 3, 0, 0, 0], null), null);
  assert.equal(compensated([0, 0, 0, 0, 0, 0], tare), null);
});

test("tare names its posture, and that it no longer holds elsewhere", () => {
  assert.match(validity(tare.q, tare), /valid here.*-45\.8°/);
  const away = tare.q.map((q, joint) => (joint === 3 ? q + 0.1 : q));
  assert.ok(Math.abs(turned(away, tare) - 0.1) < 1e-12);
  assert.match(validity(away, tare), /turned by 5\.7°.*expected 2\.0° at most.*take a new tare/);
});
