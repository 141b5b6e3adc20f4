// The socket: frames and messages in, requests out. Connects again by itself; nothing else begins
// by that.

import { parse } from "./frame.js";

const AGAIN_MS = 1000;
const BUFFERED_MAX = 4096;

export class Connection extends EventTarget {
  #socket = null;

  /** To the server of this page; of the robot at `path`, if that is given. */
  constructor(path = "") {
    super();
    this.url = new URL(`${path}ws`, location.href);
    this.url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    this.url.hash = "";
    this.#open();
  }

  #open() {
    const token = location.hash.slice(1);
    const protocols = token ? ["franka-dash", `token.${token}`] : ["franka-dash"];
    const socket = new WebSocket(this.url, protocols);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { this.#socket = socket; };
    socket.onmessage = ({ data }) => this.#take(data);
    socket.onclose = () => {
      this.#socket = null;
      this.dispatchEvent(new Event("closed"));
      setTimeout(() => this.#open(), AGAIN_MS);
    };
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

  /** Sends a request; false if there is no connection, or it is congested. */
  send(request) {
    const socket = this.#socket;
    if (socket?.readyState !== WebSocket.OPEN || socket.bufferedAmount > BUFFERED_MAX) return false;
    socket.send(JSON.stringify(request));
    return true;
  }
}
