// The picture in its place: as large as the view, with the newest frame in it.

import { byId } from "./element.js";

const canvas = byId("picture");
const overlay = byId("overlay");
const view = byId("view");

export class PictureView extends EventTarget {
  #place = { x: 0, y: 0, width: 1, height: 1 };
  #full = null;
  #frame = 0;
  // Pixels of the picture for a CSS pixel.
  #resolution = 1;

  constructor(connection) {
    super();
    this.connection = connection;
    connection.addEventListener("frame", ({ detail }) => this.#show(detail));
    // Another view counts its frames anew.
    connection.addEventListener("visitor", () => ([this.#frame, this.picture] = [0, 0]));
    new ResizeObserver(() => this.#follow()).observe(view);
  }

  set resolution(value) {
    this.#resolution = value;
    this.#follow();
  }

  // Where in the picture a place of the screen is, as fractions of its width and height; null beside it.
  fraction(x, y) {
    const bounds = view.getBoundingClientRect();
    const at = [(x - bounds.x - this.#place.x) / this.#place.width, (y - bounds.y - this.#place.y) / this.#place.height];
    return at.every((part) => part >= 0 && part < 1) ? at : null;
  }

  // Where the picture is in the view, in CSS pixels.
  get place() {
    return this.#place;
  }

  get height() {
    return this.#place.height;
  }

  get size() {
    return [this.#place.width, this.#place.height];
  }

  // Asks for a picture as large as the view.
  #follow() {
    this.#arrange();
    clearTimeout(this.wait);
    this.wait = setTimeout(() => {
      const sides = [view.clientWidth, view.clientHeight].map((side) => Math.max(16, Math.round(side * this.#resolution)));
      this.connection.send("size", { to: sides });
    }, 60);
  }

  #show(frame) {
    // Frames are decoded side by side: an older one may be ready after a newer one.
    if (frame.frame < this.#frame && frame.picture <= this.picture) return frame.bitmap.close();
    [this.#frame, this.picture] = [frame.frame, frame.picture];
    this.#full = frame.full;
    [canvas.width, canvas.height] = frame.size;
    canvas.getContext("2d").drawImage(frame.bitmap, 0, 0);
    frame.bitmap.close();
    byId("waiting").hidden = true;
    this.#arrange();
  }

  // The whole picture, in the middle of the view, as large as fits.
  #arrange() {
    if (!this.#full) return;
    const [width, height] = this.#full;
    const scale = Math.min(view.clientWidth / width, view.clientHeight / height);
    this.#place = {
      x: (view.clientWidth - width * scale) / 2,
      y: (view.clientHeight - height * scale) / 2,
      width: width * scale,
      height: height * scale,
    };
    for (const it of [canvas, overlay]) {
      it.style.left = `${this.#place.x}px`;
      it.style.top = `${this.#place.y}px`;
      it.style.width = `${this.#place.width}px`;
      it.style.height = `${this.#place.height}px`;
    }
    this.dispatchEvent(new Event("arranged"));
  }
}
