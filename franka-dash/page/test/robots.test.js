import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";

import { newPage } from "./page.js";

newPage();
globalThis.location = { hash: "" };
const { listed } = await import("../src/robots.js");

beforeEach(() => {
  mock.timers.reset();
  mock.timers.enable({ apis: ["setTimeout"] });
});

test("list of robots is asked for until the server answers", async () => {
  let asked = 0;
  globalThis.fetch = async () => {
    asked += 1;
    if (asked < 3) throw new TypeError("Failed to fetch");
    return { ok: true };
  };
  let told = 0;
  const answer = listed(() => { told += 1; });
  while (asked < 3) {
    await new Promise((turn) => setImmediate(turn));
    mock.timers.tick(1000);
  }
  assert.equal((await answer).ok, true);
  assert.deepEqual([asked, told], [3, 1]);
});

test("refusal is an answer", async () => {
  globalThis.fetch = async () => ({ ok: false, status: 401 });
  const answer = await listed(() => assert.fail("the server has answered"));
  assert.equal(answer.status, 401);
});
