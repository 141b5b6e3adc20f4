// The stop: open to every viewer, and never lost. The server answers it. Without a connection it
// waits for the next one; a person is told while it has not got through.

const AGAIN_MS = 250;
const ANSWER_MS = 1000;
const NOTICE_MS = 6000;
const MEANWHILE = "Use the user stop at the robot.";

export class Stop extends EventTarget {
  /** "none", "sent", "unconfirmed": sent without an answer in time, or "unsent". */
  state = "none";
  #connection;
  #timer = null;

  /** `name` is that of the robot, if the page shows several. */
  constructor(connection, name = null) {
    super();
    this.name = name;
    this.#connection = connection;
    connection.addEventListener("stopping", () => {
      clearTimeout(this.#timer);
      this.#become("none");
    });
    const lost = () => { if (this.state !== "none") this.#become("unsent"); };
    connection.addEventListener("closed", lost);
    connection.addEventListener("denied", lost);
    // The first message of a connection.
    connection.addEventListener("hello", () => { if (this.state !== "none") this.#send(); });
  }

  press() {
    if (this.state === "none" || this.state === "unsent") this.#send();
    else this.#connection.send({ type: "stop" });
  }

  #send() {
    clearTimeout(this.#timer);
    const sent = this.#connection.send({ type: "stop" });
    this.#timer = setTimeout(() => {
      if (this.state !== "sent") {
        this.#send();
        return;
      }
      // A network that is gone does not close a connection. The next one gets through first.
      this.#become("unconfirmed");
      this.#connection.renew();
    }, sent ? ANSWER_MS : AGAIN_MS);
    this.#become(sent ? "sent" : "unsent");
  }

  #become(state) {
    if (state === this.state) return;
    this.state = state;
    this.dispatchEvent(new Event("changed"));
  }
}

/**
 * Makes the button, Escape and the space bar press all `stops`, and shows which got through. Returns
 * a function that adds more: a stop that was pressed before any were known is sent by them.
 */
export function stopControls(known) {
  const stops = [];
  const notice = document.getElementById("stop-notice");
  let hide = null;
  let isEarly = false;
  const names = (of) => of.map((stop) => stop.name).filter((name) => name !== null).join(", ");
  const line = (state, text) => {
    const those = stops.filter((stop) => stop.state === state);
    const to = names(those);
    return those.length ? [`Stop ${text}${to ? `: ${to}` : ""}.`] : [];
  };
  const show = () => {
    const late = [
      ...(isEarly ? ["Stop not sent yet: the page is still loading the robots, and sends it then."] : []),
      ...line("unsent", "not sent yet: no connection; the page sends it after it reconnects"),
      ...line("unconfirmed", "not confirmed by the server yet; the page sends it again"),
    ];
    clearTimeout(hide);
    if (late.length) {
      notice.textContent = [...late, MEANWHILE].join(" ");
      notice.hidden = false;
    } else if (!notice.hidden) {
      const isWaiting = stops.some((stop) => stop.state === "sent");
      notice.textContent = isWaiting ? `Stop sent, not confirmed yet. ${MEANWHILE}` : "Stop received by the server.";
      if (!isWaiting) hide = setTimeout(() => { notice.hidden = true; }, NOTICE_MS);
    }
  };
  const press = () => {
    isEarly = stops.length === 0;
    for (const stop of stops) stop.press();
    show();
  };
  const add = (more) => {
    for (const stop of more) stop.addEventListener("changed", show);
    stops.push(...more);
    if (isEarly) press();
  };
  add(known);
  document.getElementById("stop").addEventListener("click", press);
  addEventListener("keydown", (event) => {
    // Checkboxes have this key, as the space bar stops.
    if (event.key === "Enter" && !event.repeat && event.target?.matches?.("input[type=checkbox]")) event.target.click();
    if (event.key !== "Escape" && event.key !== " ") return;
    // The space bar neither presses nor switches what has the focus.
    event.preventDefault();
    press();
  }, { capture: true });
  // Some browsers press a button when the key is released.
  addEventListener("keyup", (event) => { if (event.key === " ") event.preventDefault(); }, { capture: true });
  return add;
}
