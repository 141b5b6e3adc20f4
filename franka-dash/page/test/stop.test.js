import assert from "node:assert/strict";
import { beforeEach, mock, test } from "node:test";

import { Stop, stopControls } from "../src/stop.js";
import { Connection, element, event, newPage } from "./page.js";

beforeEach(() => {
  newPage();
  mock.timers.reset();
  mock.timers.enable({ apis: ["setTimeout", "setInterval"] });
});

const notice = () => document.getElementById("stop-notice");

test("stop without a connection waits for the next one and says so", () => {
  const connection = new Connection();
  stopControls([new Stop(connection)]);
  connection.close();
  document.getElementById("stop").dispatchEvent(event("click"));
  assert.equal(connection.count("stop"), 0);
  assert.equal(notice().hidden, false);
  assert.match(notice().textContent, /not sent.*user stop/);
  connection.tell("hello");
  assert.equal(connection.count("stop"), 1);
  connection.tell("stopping");
  assert.match(notice().textContent, /received/);
  mock.timers.tick(10_000);
  assert.equal(connection.count("stop"), 1);
  assert.equal(notice().hidden, true);
});

test("stop on a congested connection is sent once there is room", () => {
  const connection = new Connection();
  const stop = new Stop(connection);
  stopControls([stop]);
  connection.isOpen = false;
  stop.press();
  mock.timers.tick(1000);
  connection.isOpen = true;
  mock.timers.tick(1000);
  assert.equal(connection.count("stop"), 1);
});

test("stop without an answer is shown, and sent by a new connection", () => {
  const connection = new Connection();
  const stop = new Stop(connection);
  stopControls([stop]);
  stop.press();
  assert.equal(notice().hidden, true);
  mock.timers.tick(500);
  // A key that repeats does not put the notice off.
  stop.press();
  mock.timers.tick(500);
  assert.match(notice().textContent, /not confirmed.*user stop/);
  assert.equal(connection.renewed, 1);
  const before = connection.count("stop");
  connection.close();
  connection.tell("hello");
  assert.equal(connection.count("stop"), before + 1);
  connection.tell("stopping");
  assert.match(notice().textContent, /received/);
});

test("stop whose connection ends before the answer is shown at once", () => {
  for (const end of ["closed", "denied"]) {
    newPage();
    const connection = new Connection();
    const stop = new Stop(connection);
    stopControls([stop]);
    stop.press();
    assert.equal(notice().hidden, true);
    connection.isOpen = false;
    connection.tell(end);
    assert.match(notice().textContent, /not sent yet.*user stop/, end);
  }
});

test("stop with an answer shows nothing", () => {
  const connection = new Connection();
  const stop = new Stop(connection);
  stopControls([stop]);
  stop.press();
  connection.tell("stopping");
  mock.timers.tick(10_000);
  assert.equal(connection.count("stop"), 1);
  assert.equal(connection.renewed, 0);
  assert.equal(notice().hidden, true);
});

test("stop all names the robots that it has not reached", () => {
  const [left, right] = [new Connection(), new Connection()];
  stopControls([new Stop(left, "left"), new Stop(right, "right")]);
  right.close();
  dispatchEvent(event("keydown", { key: "Escape" }));
  assert.equal(left.count("stop"), 1);
  left.tell("stopping");
  assert.match(notice().textContent, /right/);
  assert.doesNotMatch(notice().textContent, /left/);
  right.tell("hello");
  assert.equal(right.count("stop"), 1);
});

/** An element of this kind, which counts its clicks. */
const focused = (kind) => Object.assign(element(), { clicks: 0, click() { this.clicks += 1; }, matches: (selector) => selector === kind });

test("stop before the robots are known is sent as soon as they are", () => {
  const add = stopControls([]);
  document.getElementById("stop").dispatchEvent(event("click"));
  assert.match(notice().textContent, /not sent yet: the page is still loading the robots.*user stop/);
  const connections = [new Connection(), new Connection()];
  add(connections.map((connection, i) => new Stop(connection, `robot ${i}`)));
  for (const connection of connections) {
    assert.equal(connection.count("stop"), 1);
    connection.tell("stopping");
  }
  assert.match(notice().textContent, /received/);
});

test("space bar and Escape stop regardless of what has the focus", () => {
  for (const [kind, key, stops, clicks] of [
    ["button", " ", 1, 0],
    ["input[type=range]", " ", 1, 0],
    ["input[type=checkbox]", " ", 1, 0],
    ["input[type=checkbox]", "Escape", 1, 0],
    ["input[type=checkbox]", "Enter", 0, 1],
    ["button", "Enter", 0, 0],
  ]) {
    newPage();
    const connection = new Connection();
    stopControls([new Stop(connection)]);
    const target = focused(kind);
    const send = (type, fields) => {
      const sent = event(type, { key, ...fields });
      Object.defineProperty(sent, "target", { value: target });
      dispatchEvent(sent);
      return sent.defaultPrevented;
    };
    assert.equal(send("keydown", {}), stops === 1, `${kind} ${key}`);
    // Some browsers press and switch when the key is released.
    assert.equal(send("keyup", {}), key === " ", `${kind} ${key}`);
    assert.equal(connection.count("stop"), stops, `${kind} ${key}`);
    assert.equal(target.clicks, clicks, `${kind} ${key}`);
    send("keydown", { repeat: true });
    assert.equal(target.clicks, clicks, "a key that repeats switches once");
  }
});
