import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";

import { Hold } from "../src/hold.js";
import { Connection, element, event, newPage } from "./page.js";

beforeEach(() => {
  newPage();
  mock.timers.reset();
  mock.timers.enable({ apis: ["setInterval"] });
});

function page() {
  const connection = new Connection();
  const hold = new Hold(connection);
  const button = element();
  hold.bind(button, () => ({ motion: { kind: "stay" }, speed: 0.05 }));
  connection.tell("hello");
  connection.tell("status", { holding: false, begun: 0 });
  const press = () => button.dispatchEvent(event("pointerdown", { button: 0, pointerId: 1 }));
  const release = () => button.dispatchEvent(event("pointerup"));
  return { connection, hold, press, release };
}

test("hold ends when the server has ended it", () => {
  for (const seen of [true, false]) {
    const { connection, hold, press } = page();
    press();
    if (seen) connection.tell("status", { holding: true, begun: 1 });
    // Also if it began and ended between two messages.
    connection.tell("status", { holding: false, begun: 1 });
    assert.equal(hold.active, false);
  }
});

test("hold goes on when the end of the press before is told late", () => {
  const { connection, hold, press, release } = page();
  press();
  connection.tell("status", { holding: true, begun: 1 });
  release();
  press();
  connection.tell("status", { holding: false, begun: 1 });
  assert.equal(hold.active, true);
  connection.tell("status", { holding: true, begun: 2 });
  assert.equal(hold.active, true);
  connection.tell("status", { holding: false, begun: 2 });
  assert.equal(hold.active, false);
});

test("hold goes on when a request of the press before is refused late", () => {
  const { connection, hold, press, release } = page();
  press();
  release();
  press();
  connection.tell("refused", { why: "no hold goes on", begun: 1 });
  assert.equal(hold.active, true);
  connection.tell("refused", { why: "the round trip takes 2 s", begun: 2 });
  assert.equal(hold.active, false);
});

test("hold counts its presses anew on each connection", () => {
  const { connection, hold, press } = page();
  press();
  connection.close();
  assert.equal(hold.active, false);
  connection.tell("hello");
  connection.tell("status", { holding: false, begun: 0 });
  press();
  connection.tell("status", { holding: false, begun: 1 });
  assert.equal(hold.active, false);
});
