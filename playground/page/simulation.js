// Driver and simulator, compiled to WebAssembly: the exports of the crate `franka-playground`.

const FILE = "franka_playground.wasm";
const NUMBERS = 36;
const KINDS = { fr3: 0, fer: 1 };

/** What the arm does, by the number in a view; between them it brakes or starts. */
export const FOLLOWING = 0;
export const STOPPED = 2;

export class Simulation {
  #wasm;

  constructor(exports) { this.#wasm = exports; }

  static async load() {
    const answer = await fetch(FILE);
    if (!answer.ok) throw new Error(`${FILE}: ${answer.status}`);
    const { instance } = await WebAssembly.instantiate(await answer.arrayBuffer(), {});
    return new Simulation(instance.exports);
  }

  /** A new arm at rest: `fr3` or `fer`, like a real one or ideal. */
  start(kind, real, seed) { this.#wasm.start(KINDS[kind], real ? 1 : 0, seed); }

  /** Lets so many whole milliseconds pass. */
  advance(milliseconds) { this.#wasm.advance(milliseconds); }

  /** Where the end effector is to go: position, `[m]`, and quaternion x y z w. */
  target({ position, orientation }) { this.#wasm.target(...position, ...orientation); }

  /** Pulls at the end effector, `[N]`, until the next call. */
  push([x, y, z]) { this.#wasm.push(x, y, z); }

  /** Has an obstacle hold the end effector, or let it go. */
  block(on) { this.#wasm.block(on ? 1 : 0); }

  /** After a reflex: the target is then where the arm is. */
  recover() { this.#wasm.recover(); }

  /** What there is to see now. */
  view() {
    // The memory may have grown: its buffer is then another one.
    const all = new Float64Array(this.#wasm.memory.buffer, this.#wasm.view(), NUMBERS).slice();
    const some = (start, count) => Array.from(all.subarray(start, start + count));
    return {
      seconds: all[0],
      state: all[1],
      q: some(2, 7),
      reference: some(9, 7),
      target: some(16, 7),
      endEffector: some(23, 7),
      force: some(30, 3),
      speed: all[33],
      guards: all[34],
      distance: all[35],
    };
  }

  get guardNames() {
    const names = [];
    for (;;) {
      const name = this.#text(this.#wasm.guard_name(names.length));
      if (name === null) return names;
      names.push(name);
    }
  }

  get message() { return this.#text(this.#wasm.message()) ?? ""; }

  #text(pointer) {
    if (pointer === 0) return null;
    const bytes = new Uint8Array(this.#wasm.memory.buffer, pointer);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }
}
