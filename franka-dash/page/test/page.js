// A page without a browser: events, elements by id, and a connection whose server is the test.

class Element extends EventTarget {
  textContent = "";
  hidden = true;
  title = "";
  classes = new Set();
  classList = {
    add: (name) => this.classes.add(name),
    remove: (name) => this.classes.delete(name),
    contains: (name) => this.classes.has(name),
    toggle: (name, on) => (on ? this.classes.add(name) : this.classes.delete(name)),
  };
  setPointerCapture() {}
  setAttribute() {}
  replaceChildren() {}
  append() {}
  getBoundingClientRect() { return { left: 0, right: 10, top: 0, bottom: 10 }; }
}

export const element = () => new Element();

/** Puts a new page in place of what modules take for theirs. */
export function newPage() {
  const elements = new Map();
  const target = new EventTarget();
  globalThis.document = Object.assign(new EventTarget(), {
    getElementById: (id) => {
      if (!elements.has(id)) elements.set(id, new Element());
      return elements.get(id);
    },
    createElement: () => new Element(),
  });
  globalThis.visualViewport = new EventTarget();
  globalThis.addEventListener = target.addEventListener.bind(target);
  globalThis.dispatchEvent = target.dispatchEvent.bind(target);
}

/** An event of a pointer or a key. */
export const event = (type, fields = {}) => Object.assign(new Event(type, { cancelable: true }), fields);

/** The connection of a page: what it sends is kept, and it loses what it sends while closed. */
export class Connection extends EventTarget {
  sent = [];
  isOpen = true;
  renewed = 0;

  send(request) {
    if (this.isOpen) this.sent.push(request);
    return this.isOpen;
  }

  renew() { this.renewed += 1; }

  close() {
    this.isOpen = false;
    this.dispatchEvent(new Event("closed"));
  }

  /** The server says this. */
  tell(type, detail = {}) {
    if (type === "hello") this.isOpen = true;
    this.dispatchEvent(new CustomEvent(type, { detail: { type, ...detail } }));
  }

  count(type) { return this.sent.filter((request) => request.type === type).length; }
}
