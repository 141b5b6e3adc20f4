// The socket: frames and messages in, requests out. Connects again by itself, unless the server has
// refused this page; nothing else begins by that.

import { parse } from "./frame.js";

const AGAIN_MS = 1000;
const BUFFERED_MAX = 4096;

/** The secret in the fragment of the page's address; empty if there is none. */
export const token = () => location.hash.slice(1);

/** Asks the server for something other than a file of the page. Null if the server cannot be reached. */
export const ask = (url) => fetch(url, token() ? { headers: { Authorization: `Bearer ${token()}` } } : {}).catch(() => null);

// With another token, everything begins anew.
addEventListener("hashchange", () => location.reload());

export class Connection extends EventTarget {
  #socket = null;

  /** To the server of this page; of the robot at `path`, if that is given. */
  constructor(path = "") {
    super();
    this.url = new URL(`${path}ws`, location.href);
    this.url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    this.url.hash = "";
    this.access = `${path}access`;
    this.#open();
  }

  #open() {
    const protocols = token() ? ["franka-dash", `token.${token()}`] : ["franka-dash"];
    let socket;
    try {
      socket = new WebSocket(this.url, protocols);
    } catch {
      // The fragment has characters that no token has. Listeners come after the constructor.
      queueMicrotask(() => this.#closed());
      return;
    }
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { this.#socket = socket; };
    socket.onmessage = ({ data }) => this.#take(data);
    socket.onclose = () => this.#closed();
  }

  // A browser does not say why a socket was refused, so the page asks.
  async #closed() {
    const wasOpen = this.#socket !== null;
    this.#socket = null;
    if (!wasOpen) {
      const answer = await ask(this.access);
      if (answer && [401, 403].includes(answer.status)) {
        this.#refuse(answer.status === 403 ? await answer.text() : undefined);
        return;
      }
    }
    this.dispatchEvent(new Event("closed"));
    setTimeout(() => this.#open(), AGAIN_MS);
  }

  #refuse(why = token() ? "the token in the address is wrong" : "the address needs a token: http://HOST:PORT/#TOKEN") {
    this.dispatchEvent(new CustomEvent("denied", { detail: { why } }));
  }

  #take(data) {
    if (typeof data === "string") {
      const message = JSON.parse(data);
      this.dispatchEvent(new CustomEvent(message.type, { detail: message }));
      return;
    }
    const frame = parse(data);
    // At once: the time that this takes is the round trip that the server measures.
    this.send({ type: "seen", server_ms: frame.serverMs });
    this.dispatchEvent(new CustomEvent("frame", { detail: frame }));
  }

  /** Closes the connection, so that another one is made. */
  renew() { this.#socket?.close(); }

  /** Sends a request; false if there is no connection, or it is congested. */
  send(request) {
    const socket = this.#socket;
    if (socket?.readyState !== WebSocket.OPEN || socket.bufferedAmount > BUFFERED_MAX) return false;
    socket.send(JSON.stringify(request));
    return true;
  }
}
