// Hold-to-run: a motion goes on while a button is held, and for no other reason. Messages come from
// a timer, which browsers slow down in hidden pages: the hold then ends.

const EVERY_MS = 50;

export class Hold {
  #connection;
  #timer = null;
  #seq = 0;
  #button = null;
  #pointer = null;
  /** Holds that were begun on this connection. */
  #begun = 0;

  constructor(connection) {
    this.#connection = connection;
    for (const name of ["blur", "pagehide", "resize", "orientationchange", "contextmenu"]) {
      addEventListener(name, () => this.end());
    }
    document.addEventListener("visibilitychange", () => this.end());
    visualViewport?.addEventListener("resize", () => this.end());
    connection.addEventListener("closed", () => this.end());
    connection.addEventListener("hello", () => { this.#begun = 0; });
    // What the server said before it had handled the newest begin is about an earlier press.
    const isNewest = (detail) => detail.begun === this.#begun;
    connection.addEventListener("refused", ({ detail }) => { if (isNewest(detail)) this.end(); });
    connection.addEventListener("status", ({ detail }) => {
      // The server has ended it: arrived, stopped, or too late.
      if (isNewest(detail) && !detail.holding) this.end();
    });
  }

  get active() { return this.#timer !== null; }

  /** Has `button` move the arm while it is held; `request` gives motion and speed. */
  bind(button, request) {
    button.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      this.#pointer = event.pointerId;
      button.setPointerCapture(event.pointerId);
      this.#begin(button, request());
    });
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
      button.addEventListener(name, () => this.#endOf(button));
    }
    button.addEventListener("pointermove", (event) => {
      // The pointer is captured: leaving the button is seen by where it is.
      const box = button.getBoundingClientRect();
      const inside = event.clientX >= box.left && event.clientX <= box.right
        && event.clientY >= box.top && event.clientY <= box.bottom;
      if (!inside) this.#endOf(button);
    });
    button.addEventListener("keydown", (event) => {
      if (event.key !== "Enter") return;
      event.preventDefault();
      // Repetitions are no sign that the key is held: they come from the system.
      if (!event.repeat) this.#begin(button, request());
    });
    for (const name of ["keyup", "blur"]) button.addEventListener(name, () => this.#endOf(button));
  }

  #begin(button, { motion, speed }) {
    this.end();
    if (!this.#connection.send({ type: "begin", motion, speed })) return;
    this.#begun += 1;
    this.#seq = 0;
    this.#button = button;
    button.classList.add("held");
    this.#timer = setInterval(() => {
      this.#seq += 1;
      if (!this.#connection.send({ type: "hold", seq: this.#seq })) this.end();
    }, EVERY_MS);
  }

  #endOf(button) {
    if (this.#button === button) this.end();
  }

  end() {
    if (this.#timer === null) return;
    clearInterval(this.#timer);
    this.#timer = null;
    this.#button.classList.remove("held");
    this.#button = null;
    this.#connection.send({ type: "end" });
  }
}
