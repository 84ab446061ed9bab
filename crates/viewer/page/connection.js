// The connection with the render: frames and answers come in, requests go out. When it is lost, it is tried again.

const WAITS = [500, 1000, 2000, 4000];
// How long to wait where there is no place.
const FULL = 5000;
// A page that nobody sees leaves after this time, and makes room for others.
const UNSEEN = 10000;

export class Connection extends EventTarget {
  #socket = null;
  #lost = 0;
  #size = null;
  // By this the viewer knows this visitor again when the connection was lost.
  #visitor = null;
  #full = false;

  constructor() {
    super();
    this.#open();
    document.addEventListener("visibilitychange", () => this.#see(!document.hidden));
    addEventListener("pagehide", () => this.#leave());
    addEventListener("pageshow", ({ persisted }) => persisted && this.#see(true));
  }

  #away = false;
  #unseen = null;

  // Whether anybody sees the page.
  #see(seen) {
    clearTimeout(this.#unseen);
    if (!seen) this.#unseen = setTimeout(() => this.#leave(), UNSEEN);
    else if (this.#away) this.#open();
  }

  #leave() {
    this.#away = true;
    this.#socket?.close();
  }

  // The address of something that each visitor has for themselves.
  ours(path) {
    return this.#visitor ? `${path}?visitor=${this.#visitor}` : path;
  }

  // Sends a request: `what` to do, and with what.
  send(what, fields = {}) {
    if (what === "size") this.#size = fields;
    if (this.#socket?.readyState === WebSocket.OPEN) {
      this.#socket.send(JSON.stringify({ do: what, ...fields }));
    }
  }

  #open() {
    this.#away = false;
    const address = new URL(this.ours("socket"), document.baseURI);
    address.protocol = address.protocol.replace("http", "ws");
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => (this.#full = false);
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.#take(data) : this.#takeFrame(data));
    socket.onclose = () => {
      this.#socket = null;
      if (this.#away) return;
      if (!this.#full) this.#say("lost");
      setTimeout(() => this.#open(), this.#full ? FULL : WAITS[Math.min(this.#lost++, WAITS.length - 1)]);
    };
    this.#socket = socket;
  }

  #take(text) {
    const message = JSON.parse(text);
    if (message.say === "full") this.#full = true;
    if (message.say === "visitor") this.#enter(message.key);
    this.#say(message.say, message);
  }

  // There is a place for this visitor.
  #enter(key) {
    this.#visitor = key;
    this.#lost = 0;
    this.#say("connected");
    if (this.#size) this.send("size", this.#size);
  }

  // The length of the header, the header, the picture.
  async #takeFrame(buffer) {
    const length = new DataView(buffer).getUint32(0, true);
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    const blob = new Blob([new Uint8Array(buffer, 4 + length)], { type: header.type });
    try {
      header.bitmap = await createImageBitmap(blob);
      this.#say(header.side === "other" ? "other" : "frame", header);
    } finally {
      this.send("seen", { frame: header.frame });
    }
  }

  #say(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }
}
