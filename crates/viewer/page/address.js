// The view in the address of the page: it is there again after a reload, and can be sent to somebody.

// Browsers refuse to write an address too often.
const EVERY = 400;

export class Address {
  #written = "";
  #wait = null;
  // The view that is still to be asked for.
  #wanted = read();

  constructor(connection) {
    this.connection = connection;
    // Each view of this visitor begins where the scene has its camera.
    connection.addEventListener("visitor", () => (this.#wanted = read()));
    connection.addEventListener("state", () => this.#ask());
    connection.addEventListener("frame", ({ detail }) => this.#keep(detail));
    addEventListener("hashchange", () => {
      this.#wanted = read();
      this.#ask();
    });
  }

  #ask() {
    const view = this.#wanted;
    this.#wanted = null;
    if (view) this.connection.send("view", view);
  }

  #keep({ eye, zoom }) {
    const text = zoom === null ? "" : `#view=${[...eye.flat(), zoom].map(short).join(",")}`;
    if (this.#wanted || text === this.#written) return;
    this.#written = text;
    this.#wait ??= setTimeout(() => {
      this.#wait = null;
      if (this.#written !== location.hash) history.replaceState(null, "", this.#written || location.pathname + location.search);
    }, EVERY);
  }
}

// The view that the address has, if there is one.
function read() {
  const numbers = location.hash.startsWith("#view=") ? location.hash.slice(6).split(",").map(Number) : [];
  if (numbers.length !== 7 || !numbers.every(Number.isFinite)) return null;
  return { position: numbers.slice(0, 3), pivot: numbers.slice(3, 6), zoom: numbers[6] };
}

const short = (x) => String(Number(x.toPrecision(7)));
