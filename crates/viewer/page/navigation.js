// Moves of the camera by mouse, wheel, touch and keys. What happens between two frames of the screen is added up.

import { byId } from "./element.js";

const view = byId("view");
// Degrees for a drag over the whole height of the picture.
const TURN = 180;
const LOOK = 60;
// A shorter drag is a click.
const CLICK = 4;
// Distances to the point of view a second.
const SPEED = 0.8;

export class Navigation {
  #pointers = new Map();
  #dragged = 0;
  #mode = "orbit";
  #sums = {};
  #keys = new Set();
  #last = 0;
  #fast = false;
  #frame = null;

  constructor(connection, picture, { pick, clear }) {
    Object.assign(this, { connection, picture, pick, clear });
    // In a room, a drag looks around; otherwise it moves around what is in the picture.
    connection.addEventListener("state", ({ detail }) => (this.inside = detail.inside));
    view.addEventListener("pointerdown", (event) => this.#press(event));
    view.addEventListener("pointermove", (event) => this.#drag(event));
    for (const name of ["pointerup", "pointercancel"]) view.addEventListener(name, (event) => this.#release(event));
    view.addEventListener("wheel", (event) => this.#roll(event), { passive: false });
    view.addEventListener("dblclick", (event) => this.#focus(event.clientX, event.clientY));
    view.addEventListener("contextmenu", (event) => event.preventDefault());
    view.addEventListener("keydown", (event) => this.#keyDown(event));
    view.addEventListener("keyup", (event) => this.#keys.delete(event.code));
    view.addEventListener("blur", () => this.#keys.clear());
  }

  #press(event) {
    if (event.target.closest("#status, #problem, #divider")) return;
    view.setPointerCapture(event.pointerId);
    this.#pointers.set(event.pointerId, [event.clientX, event.clientY]);
    this.#dragged = this.#pointers.size > 1 ? CLICK : 0;
    const pans = event.button === 2 || event.button === 1 || event.shiftKey;
    const other = event.ctrlKey || event.metaKey || event.altKey;
    this.#mode = pans ? "pan" : Boolean(this.inside) !== other ? "look" : "orbit";
    view.classList.add("grabbed");
  }

  #drag(event) {
    const before = this.#pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const fingers = [...this.#pointers.values()];
    this.#pointers.set(event.pointerId, now);
    const [x, y] = [(now[0] - before[0]) / this.picture.height, (now[1] - before[1]) / this.picture.height];
    this.#dragged += Math.hypot(now[0] - before[0], now[1] - before[1]);
    if (fingers.length >= 2) {
      this.#pinch(fingers, [...this.#pointers.values()]);
    } else if (this.#dragged >= CLICK) {
      if (this.#mode === "pan") this.#add("pan", [-x, y]);
      else if (this.#mode === "look") this.#add("look", [-x * LOOK, y * LOOK]);
      else this.#add("orbit", [-x * TURN, y * TURN]);
    }
  }

  // Two fingers move the picture with them, and magnify it.
  #pinch(before, now) {
    const middle = (f) => [(f[0][0] + f[1][0]) / 2, (f[0][1] + f[1][1]) / 2];
    const apart = (f) => Math.max(1, Math.hypot(f[0][0] - f[1][0], f[0][1] - f[1][1]));
    const [a, b] = [middle(before), middle(now)];
    this.#add("pan", [-(b[0] - a[0]) / this.picture.height, (b[1] - a[1]) / this.picture.height]);
    this.#add("approach", apart(now) / apart(before));
  }

  #release(event) {
    if (!this.#pointers.delete(event.pointerId)) return;
    if (this.#pointers.size === 0) view.classList.remove("grabbed");
    const is_click = event.type === "pointerup" && this.#dragged < CLICK && this.#mode !== "pan";
    const at = this.picture.fraction(event.clientX, event.clientY);
    if (is_click && at) this.pick(at);
  }

  #roll(event) {
    if (event.target.closest("#problem")) return;
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : 1;
    this.#add("approach", Math.exp(-Math.max(-300, Math.min(300, event.deltaY * lines)) * 0.0016));
  }

  #focus(x, y) {
    const at = this.picture.fraction(x, y);
    if (at) this.connection.send("focus", { at });
  }

  #keyDown(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const plain = {
      "+": () => this.#add("approach", 1.15),
      "=": () => this.#add("approach", 1.15),
      "-": () => this.#add("approach", 1 / 1.15),
      h: () => this.connection.send("home"),
      p: () => this.pick([0.5, 0.5]),
      f: () => this.connection.send("focus", { at: [0.5, 0.5] }),
      Escape: () => this.clear(),
    }[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (arrows) {
      const [x, y] = arrows;
      if (event.shiftKey) this.#add("pan", [x * 0.05, y * 0.05]);
      else if (this.inside) this.#add("look", [x * 4, y * 4]);
      else this.#add("orbit", [x * 5, y * 5]);
    } else if (plain) {
      plain();
    } else if (["KeyW", "KeyA", "KeyS", "KeyD", "KeyQ", "KeyE"].includes(event.code)) {
      this.#fast = event.shiftKey;
      if (!event.repeat) {
        this.#keys.add(event.code);
        this.#schedule();
      }
    } else {
      return;
    }
    event.preventDefault();
  }

  #fly(seconds) {
    const held = (a, b) => Number(this.#keys.has(a)) - Number(this.#keys.has(b));
    const step = SPEED * (this.#fast ? 3 : 1) * Math.min(seconds, 0.1);
    this.#add("fly", [held("KeyD", "KeyA") * step, held("KeyE", "KeyQ") * step, held("KeyW", "KeyS") * step]);
  }

  #add(what, by) {
    const before = this.#sums[what];
    if (what === "approach") this.#sums[what] = (before ?? 1) * by;
    else this.#sums[what] = by.map((part, i) => part + (before?.[i] ?? 0));
    this.#schedule();
  }

  #schedule() {
    this.#frame ??= requestAnimationFrame((now) => this.#flush(now));
  }

  #flush(now) {
    this.#frame = null;
    for (const [what, by] of Object.entries(this.#sums)) this.connection.send(what, { by });
    this.#sums = {};
    if (this.#keys.size > 0) {
      if (this.#last) this.#fly((now - this.#last) / 1000);
      this.#last = now;
      this.#schedule();
    } else {
      this.#last = 0;
    }
  }
}
