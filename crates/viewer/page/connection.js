// The connection with the render: frames and answers come in, requests go out. When it is lost, it is tried again.

const WAITS = [500, 1000, 2000, 4000];

export class Connection extends EventTarget {
  #socket = null;
  #lost = 0;
  #size = null;

  constructor() {
    super();
    this.#open();
  }

  // Sends a request: `what` to do, and with what.
  send(what, fields = {}) {
    if (what === "size") this.#size = fields;
    if (this.#socket?.readyState === WebSocket.OPEN) {
      this.#socket.send(JSON.stringify({ do: what, ...fields }));
    }
  }

  #open() {
    const address = new URL("socket", document.baseURI);
    address.protocol = address.protocol.replace("http", "ws");
    const socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      this.#lost = 0;
      this.#say("connected");
      if (this.#size) this.send("size", this.#size);
    };
    socket.onmessage = ({ data }) => (typeof data === "string" ? this.#take(data) : this.#takeFrame(data));
    socket.onclose = () => {
      this.#socket = null;
      this.#say("lost");
      setTimeout(() => this.#open(), WAITS[Math.min(this.#lost++, WAITS.length - 1)]);
    };
    this.#socket = socket;
  }

  #take(text) {
    const message = JSON.parse(text);
    this.#say(message.say, message);
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
