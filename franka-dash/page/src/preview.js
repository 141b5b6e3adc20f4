// What a motion would do, before it does it: the server is asked, one question at a time, and the
// newest one next.

const AGAIN_MS = 2000;
const MOVED = 0.005;

export class Preview {
  #connection;
  #scene;
  #hold;
  #number = 0;
  #wanted = null;
  /** The question under way: its number, and when it was sent. */
  #pending = null;
  /** Where the arm was when the wanted question was asked as it is now. */
  #asked = null;
  #q = null;

  constructor(connection, scene, hold) {
    this.#connection = connection;
    this.#scene = scene;
    this.#hold = hold;
    connection.addEventListener("preview", ({ detail }) => this.#take(detail));
    connection.addEventListener("closed", () => { this.#pending = null; });
  }

  /** Wants to know what `motion` does at `speed`, functions both; `said` is told a line about it. */
  want(question) {
    this.#wanted = question;
    this.again();
  }

  /** No more of this question. */
  forget(question) {
    if (question !== this.#wanted) return;
    this.#wanted = null;
    this.#scene.preview(null);
  }

  /** Asks again: something that counts is another. */
  again() {
    this.#asked = null;
    this.#ask();
  }

  /** The arm is here, `[rad]`: what a motion does depends on it. */
  at(q) {
    this.#q = q;
    if (this.#hold.active) return;
    if (this.#asked?.some((before, i) => Math.abs(before - q[i]) > MOVED)) this.#asked = null;
    this.#ask();
  }

  #ask() {
    const late = this.#pending && performance.now() - this.#pending.at > AGAIN_MS;
    if (!this.#wanted || this.#asked || !this.#q || (this.#pending && !late)) return;
    const question = this.#wanted;
    this.#number += 1;
    const request = { type: "preview", number: this.#number, motion: question.motion(), speed: question.speed() };
    if (!this.#connection.send(request)) return;
    this.#pending = { number: this.#number, question, at: performance.now() };
    this.#asked = Array.from(this.#q);
  }

  #take({ number, way, refused }) {
    if (number !== this.#pending?.number) return;
    const { question } = this.#pending;
    this.#pending = null;
    if (question === this.#wanted) {
      this.#scene.preview(way);
      question.said(way ? describe(way) : `Refused: ${refused}`, way !== null);
    }
    this.#ask();
  }
}

function describe({ duration, length, fastest }) {
  const millimetres = (metres) => (metres * 1000).toFixed(0);
  return `Takes ${duration.toFixed(1)} s over ${millimetres(length)} mm; joints, flange and end effector at most ${millimetres(fastest)} mm/s`;
}
