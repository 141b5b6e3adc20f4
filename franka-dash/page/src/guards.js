// The guards that hold the arm back: they light up while they do, and for a moment after it.

const LIT_MS = 1000;
/** Those that a motion of the page can meet; others light up, too, once they bind. */
const ALWAYS = ["force cap", "speed cap", "clearance", "joint range", "joint velocity", "velocity limit", "leash", "deviation", "deadman"];

export class Guards {
  #names = [];
  #since = new Map();
  #chips = new Map();

  describe({ guards }) {
    this.#names = guards;
    this.#chips.clear();
    this.#since.clear();
    document.getElementById("guards-list").replaceChildren();
    for (const name of ALWAYS.filter((it) => guards.includes(it))) this.#chip(name);
  }

  #chip(name) {
    let chip = this.#chips.get(name);
    if (!chip) {
      chip = document.createElement("li");
      chip.textContent = name;
      document.getElementById("guards-list").append(chip);
      this.#chips.set(name, chip);
    }
    return chip;
  }

  /** The names of those that bind in a frame, or did within the last second before it. */
  lit({ guards, serverMs }) {
    this.#names.forEach((name, bit) => { if (guards & (1 << bit)) this.#since.set(name, serverMs); });
    const fresh = (at) => at <= serverMs && serverMs - at < LIT_MS;
    return new Set([...this.#since].filter(([, at]) => fresh(at)).map(([name]) => name));
  }

  show(lit) {
    for (const name of lit) this.#chip(name);
    for (const [name, chip] of this.#chips) {
      const binds = lit.has(name);
      if (chip.classList.contains("lit") === binds) continue;
      chip.classList.toggle("lit", binds);
      chip.setAttribute("aria-label", binds ? `${name}: binds` : name);
    }
    const text = lit.size ? [...lit].join(", ") : "none";
    const place = document.getElementById("guards");
    // A live region speaks when it is written to.
    if (place.textContent === text) return;
    place.textContent = text;
    place.title = text;
  }
}
