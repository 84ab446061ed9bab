// What is at a pixel, and the paths of light that reach it.

import { byId, element, plain } from "./element.js";
import { fromLinear } from "./inputs.js";
import { LEGEND, drawPaths } from "./paths.js";

const section = byId("pick");
const facts = byId("facts");
const COUNTS = [0, 1, 8, 32, 64];

export class Pick {
  #picked = null;
  #count = 8;
  // The number of the path that is shown alone; null for all.
  #alone = null;

  constructor(connection, picture) {
    Object.assign(this, { connection, picture });
    connection.addEventListener("picked", ({ detail }) => this.#take(detail));
    picture.addEventListener("arranged", () => this.#draw());
    // What was found belongs to the picture that was shown then.
    connection.addEventListener("frame", ({ detail }) => {
      if (this.#picked && detail.picture !== this.#picture && detail.picture - this.#picture > 0 && this.#moved(detail.eye)) this.clear();
      if (this.#picked === null) [this.#picture, this.#eye] = [detail.picture, detail.eye];
    });
  }

  #picture = 0;
  #eye = null;

  #moved(eye) {
    return JSON.stringify(eye) !== JSON.stringify(this.#eye);
  }

  at(place) {
    this.#place = place;
    this.connection.send("pick", { at: place, paths: this.#count });
  }

  #place = null;

  clear() {
    [this.#picked, this.#alone] = [null, null];
    section.hidden = facts.hidden = true;
    this.#draw();
  }

  #take(picked) {
    [this.#picked, this.#alone] = [picked, null];
    section.hidden = facts.hidden = false;
    facts.textContent = words(picked);
    this.#build();
    this.#draw();
  }

  #draw() {
    const paths = this.#picked?.paths ?? [];
    const shown = this.#alone === null ? paths : [paths[this.#alone]];
    drawPaths(this.picture.size, this.#picked?.at ?? null, shown);
  }

  #build() {
    const { pixel, surface, light, samples, interval } = this.#picked;
    const close = element("button", { type: "button", "aria-label": "Put the picked pixel away", onclick: () => this.clear() }, "Close");
    const heading = element("div", { class: "heading" }, element("h2", { id: "pick-title" }, `Pixel ${pixel[0]}, ${pixel[1]}`), close);
    const rows = [];
    const row = (name, ...what) => rows.push(element("div", {}, element("dt", {}, name), element("dd", { class: "number" }, ...what)));
    if (surface) {
      row("Object", surface.object === null ? "a light" : surface.object || `number ${surface.number}`);
      if (surface.material) row("Material", this.#material(surface.material));
      row("Position", `${surface.position.map((x) => plain(x, 4)).join(", ")} m`);
      row("Distance", `${plain(surface.distance, 4)} m`);
      row("Normal", surface.normal.map((x) => plain(x, 2)).join(", "));
    } else {
      row("Object", "none: the surroundings");
    }
    if (light) {
      const swatch = element("span", { class: "swatch", "aria-hidden": "true" });
      swatch.style.background = fromLinear(light);
      row("Light", swatch, light.map((x) => plain(x)).join(", "));
      row("", `mean of ${samples} samples; red, green, blue`);
    }
    if (interval) row("95% interval", ...interval.flatMap(({ mean, half }) => [`${plain(mean)} ± ${plain(half, 2)}`, element("br")]));
    section.replaceChildren(heading, element("dl", {}, ...rows), this.#paths());
  }

  #material({ name, kind, parameters }) {
    const show = (value) => (Array.isArray(value) ? value.map((x) => plain(x)).join(", ") : typeof value === "object" ? "texture" : String(value));
    const list = parameters.map(([key, value]) => element("div", {}, element("dt", {}, key), element("dd", {}, show(value))));
    const label = name ? `${name} (${kind})` : kind;
    return list.length ? element("details", {}, element("summary", {}, label), element("dl", {}, ...list)) : label;
  }

  #paths() {
    const { paths } = this.#picked;
    const options = COUNTS.map((count) => element("option", { value: String(count) }, count === 0 ? "none" : String(count)));
    const count = element("select", { id: "path-count", onchange: () => {
      this.#count = Number(count.value);
      this.at(this.#place);
    } }, ...options);
    count.value = String(this.#count);
    const choice = element("div", { class: "row" }, element("label", { for: "path-count" }, "Light paths"), count);
    if (!paths.length) return element("div", {}, choice);
    const alone = element("select", { id: "path-alone", onchange: () => {
      this.#alone = alone.value === "" ? null : Number(alone.value);
      this.#draw();
      this.#list(events);
    } }, element("option", { value: "" }, "all"), ...paths.map((path, i) => {
      return element("option", { value: String(i) }, `sample ${path.sample}: ${path.light.map((x) => plain(x, 2)).join(", ")}`);
    }));
    const events = element("div");
    const legend = element("ul", { class: "legend" }, ...LEGEND.map(([kind, words]) => element("li", { class: kind }, words)));
    const shown = element("div", { class: "row" }, element("label", { for: "path-alone" }, "Shown"), alone);
    return element("div", {}, choice, shown, legend, events);
  }

  // What happens along the path that is shown alone.
  #list(place) {
    const path = this.#picked.paths[this.#alone];
    const line = ({ what, vertex }) => {
      const brings = vertex && vertex.light.some((x) => x > 0);
      return element("li", { class: brings ? "brings" : null }, what);
    };
    place.replaceChildren(...(path ? [element("ol", { class: "events" }, ...path.events.map(line))] : []));
  }
}

// What was picked, in a line on the picture where the panel is folded.
function words({ surface }) {
  if (!surface) return "the surroundings";
  const object = surface.object === null ? "a light" : surface.object || `object ${surface.number}`;
  const { name, kind } = surface.material ?? {};
  const material = kind ? [name ? `${name} (${kind})` : kind] : [];
  return [object, ...material, `${plain(surface.distance, 4)} m away`].join(" · ");
}
