// The picture beside another one: with a setting changed, or before the edits. A slider splits the view between them.

import { busy } from "./busy.js";
import { byId, element, large, plain, shape, title } from "./element.js";
import { control } from "./inputs.js";
import { add, draw } from "./plot.js";

const section = byId("compare");
const divider = byId("divider");
const canvas = byId("other");
const view = byId("view");
// What is worth comparing; the first ones first.
const KEYS = ["integrator", "accel", "max_depth", "denoise", "seed", "exposure", "tonemap"];
const CURVES = [["own", "left"], ["other", "right"], ["difference", "between them"]];

export class Compare {
  #split = 0.5;
  #comparison = null;
  #frames = { own: null, other: null };
  #curves = { own: [], other: [], difference: [] };
  #pictures = {};

  constructor(connection, picture) {
    Object.assign(this, { connection, picture });
    connection.addEventListener("catalogue", ({ detail }) => this.#build(detail));
    connection.addEventListener("state", ({ detail }) => this.#show(detail));
    connection.addEventListener("frame", ({ detail }) => this.#take("own", detail));
    connection.addEventListener("progress", ({ detail }) => this.#work(detail));
    connection.addEventListener("other", ({ detail }) => this.#takeOther(detail));
    connection.addEventListener("visitor", () => (this.#frames = { own: null, other: null }));
    picture.addEventListener("arranged", () => this.#arrange());
    divider.addEventListener("pointerdown", (event) => this.#grab(event));
    divider.addEventListener("keydown", (event) => this.#key(event));
  }

  #build(catalogue) {
    const all = catalogue.groups.flatMap((group) => group.settings);
    this.parameters = KEYS.map((key) => all.find((p) => p.name === key)).filter(Boolean);
    const options = [["", "nothing"], ...this.parameters.map(({ name }) => [name, `another ${title(name).toLowerCase()}`]), ["unedited", "the scene before the edits"]];
    const choices = options.map(([value, words]) => element("option", { value }, words));
    this.what = element("select", { id: "compare-with", onchange: () => this.#choose(this.what.value) }, ...choices);
    this.place = element("div");
    this.working = element("p", { id: "compare-working", class: "hint", role: "status", hidden: true });
    this.results = element("div", { hidden: true });
    section.replaceChildren(
      element("h2", { id: "compare-title" }, "Compare"),
      element("div", { class: "row" }, element("label", { for: "compare-with" }, "With"), this.what),
      this.place,
      this.working,
      this.results,
    );
    this.#buildResults();
  }

  #buildResults() {
    const box = element("input", { id: "differences", type: "checkbox", onchange: () => this.connection.send("differences", { show: box.checked }) });
    const help = "how far the two are from each other as people see it (FLIP), from none (black) to all (pale yellow)";
    this.differences = box;
    this.plot = shape("svg", { class: "plot", role: "img", "aria-label": "Error against time of both pictures" });
    this.table = element("tbody");
    const heads = ["", "Samples", "Noise", "Rays/s", "Time"].map((words) => element("th", { scope: "col" }, words));
    const legend = CURVES.map(([kind, words]) => element("li", { class: `curve-${kind}` }, words));
    this.results.replaceChildren(
      element("div", { class: "row", title: help }, element("label", { for: "differences" }, "Differences"), box),
      element("table", {}, element("thead", {}, element("tr", {}, ...heads)), this.table),
      element("p", { class: "hint" }, "Error against time; both get the same time:"),
      this.plot,
      element("ul", { class: "legend" }, ...legend),
    );
  }

  // What is being done for the comparison, until both pictures are there.
  #work({ level, other, waits, samples }) {
    if (!this.working) return;
    const isThere = !canvas.hidden;
    this.working.hidden = !this.#comparison || isThere;
    if (this.working.hidden) return;
    const words = waits ? "Waiting for the turns of other visitors …"
      : level !== "full" || !samples ? "Rendering the picture on the left first …"
      : other?.samples ? `Rendering the picture on the right: ${other.samples} of ${other.total} samples …`
      : "Preparing the picture on the right …";
    if (this.working.textContent !== words) this.working.textContent = words;
  }

  #choose(key) {
    this.working.textContent = "Working …";
    busy("compare", key === "" ? "" : "Rendering the other picture …");
    this.working.hidden = key === "";
    this.place.replaceChildren();
    this.made = null;
    if (key === "") return this.connection.send("compare", { with: "nothing" });
    if (key === "unedited") return this.connection.send("compare", { with: "unedited" });
    this.#offer(key);
    const now = this.state.settings[key];
    const parameter = this.parameters.find((p) => p.name === key);
    this.#send(key, another(parameter, now));
  }

  // The input for what is compared.
  #offer(key) {
    const parameter = this.parameters.find((p) => p.name === key);
    this.made = control({ ...parameter, name: `${key}_on_the_right` }, (value) => this.#send(key, value));
    this.made.key = key;
    this.place.replaceChildren(this.made.row);
  }

  #send(key, value) {
    this.connection.send("compare", { with: "setting", key, value });
  }

  #show(state) {
    this.state = state;
    if (!this.what) return;
    const it = state.comparison;
    const was = this.#comparison !== null;
    this.#comparison = it;
    this.what.value = it ? it.key ?? "unedited" : "";
    this.what.querySelector("[value=unedited]").disabled = !state.can_undo && it?.with !== "unedited";
    if (it?.key && this.made?.key !== it.key) this.#offer(it.key);
    if (!it?.key) this.place.replaceChildren();
    if (!it?.key) this.made = null;
    if (it?.key) this.made.show(it.value);
    this.results.hidden = !it;
    this.differences.checked = Boolean(it?.differences);
    if (!it && was) this.#end();
    if (!it) this.#rest();
    this.#label();
  }

  #end() {
    this.#frames.other = null;
    this.#curves = { own: [], other: [], difference: [] };
    canvas.hidden = divider.hidden = true;
    byId("side-own").hidden = byId("side-other").hidden = true;
  }

  // Nothing is waited for any more.
  #rest() {
    this.working.hidden = true;
    busy("compare", "");
  }

  // Which of the two is where.
  #label() {
    const it = this.#comparison;
    if (!it) return;
    const words = (value) => `${title(it.key ?? "")}: ${value}`;
    byId("side-own").textContent = it.key ? words(this.state.settings[it.key]) : "Edited";
    byId("side-other").textContent = it.differences ? "Differences" : it.key ? words(it.value) : "Before the edits";
  }

  #take(side, frame) {
    this.#frames[side] = frame;
    if (!this.#comparison) return;
    // A picture that begins anew has a curve of its own.
    if (this.#pictures[side] !== frame.picture) {
      this.#pictures[side] = frame.picture;
      this.#curves[side] = [];
      this.#curves.difference = [];
    }
    if (!frame.preview) add(this.#curves[side], { x: frame.seconds, y: frame.noise });
    if (side === "other") add(this.#curves.difference, { x: frame.seconds, y: frame.difference });
    this.#report();
    this.#arrange();
  }

  #takeOther(frame) {
    if (!this.#comparison) return frame.bitmap.close();
    if (this.#frames.other && frame.frame < this.#frames.other.frame) return frame.bitmap.close();
    [canvas.width, canvas.height] = frame.size;
    canvas.getContext("2d").drawImage(frame.bitmap, 0, 0);
    frame.bitmap.close();
    this.#take("other", frame);
  }

  #report() {
    const row = (name, frame) => {
      const cells = frame && !frame.preview
        ? [frame.samples, frame.noise ? `${(frame.noise * 100).toPrecision(2)}%` : "–", large(frame.rays).trim(), `${plain(frame.seconds)} s`]
        : ["–", "–", "–", "–"];
      return element("tr", {}, element("th", { scope: "row" }, name), ...cells.map((cell) => element("td", {}, String(cell))));
    };
    const { own, other } = this.#frames;
    const apart = other?.difference ? [element("tr", {}, element("th", { scope: "row" }, "Apart"), element("td", { colspan: "4" }, `${(other.difference * 100).toPrecision(2)}% of the light`))] : [];
    this.table.replaceChildren(row("Left", own), row("Right", other), ...apart);
    draw(this.plot, CURVES.map(([kind]) => ({ kind, points: this.#curves[kind] })));
  }

  // The other picture lies over the picture, to the right of the divider. While the camera moves, there is only one.
  #arrange() {
    const { own, other } = this.#frames;
    const fits = this.#comparison && own && other && JSON.stringify(own.eye) === JSON.stringify(other.eye);
    canvas.hidden = divider.hidden = !fits;
    byId("side-own").hidden = byId("side-other").hidden = !fits;
    if (fits) this.#rest();
    if (!fits) return;
    const { x, y, width, height } = this.picture.place;
    for (const [name, value] of Object.entries({ left: x, top: y, width, height })) canvas.style[name] = `${value}px`;
    canvas.style.clipPath = `inset(0 0 0 ${this.#split * 100}%)`;
    divider.style.left = `${x + width * this.#split}px`;
    divider.style.top = `${y}px`;
    divider.style.height = `${height}px`;
    divider.setAttribute("aria-valuenow", String(Math.round(this.#split * 100)));
  }

  #move(to) {
    this.#split = Math.min(1, Math.max(0, to));
    this.#arrange();
  }

  #grab(event) {
    event.preventDefault();
    event.stopPropagation();
    divider.focus();
    divider.setPointerCapture(event.pointerId);
    const drag = ({ clientX }) => {
      const { x, width } = this.picture.place;
      this.#move((clientX - view.getBoundingClientRect().x - x) / width);
    };
    const end = () => {
      divider.removeEventListener("pointermove", drag);
      for (const name of ["pointerup", "pointercancel"]) divider.removeEventListener(name, end);
    };
    divider.addEventListener("pointermove", drag);
    for (const name of ["pointerup", "pointercancel"]) divider.addEventListener(name, end);
  }

  #key(event) {
    const by = { ArrowLeft: -0.02, ArrowRight: 0.02, PageDown: -0.1, PageUp: 0.1 }[event.key];
    const to = { Home: 0, End: 1 }[event.key];
    if (by === undefined && to === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    this.#move(to ?? this.#split + by);
  }
}

// Another value of a setting, to begin with.
function another({ kind, choices, min, max, name }, now) {
  if (kind === "choice") {
    const names = choices.map((choice) => choice.name);
    const wanted = { integrator: ["path", "bdpt", "vcm"], accel: ["bvh8", "bsp", "brute"], denoise: ["auto", "off"] }[name] ?? [];
    return [...wanted, ...names].find((other) => names.includes(other) && other !== now) ?? names[0];
  }
  const number = Number(now);
  if (name === "max_depth") return number > 1 ? 1 : 16;
  return Math.max(min, Math.min(max, number + 1));
}
