// The parameters of materials, lights and cameras, if the viewer lets them be changed.

import { byId, element } from "./element.js";
import { control } from "./inputs.js";

const section = byId("edits");
const GROUPS = { material: "Materials", light: "Lights", camera: "Cameras" };

export class Edits {
  #chosen = "material 0";
  #built = "";
  #controls = [];

  constructor(connection) {
    this.connection = connection;
    connection.addEventListener("catalogue", ({ detail }) => {
      this.kinds = detail.parts;
      this.#built = "";
    });
    connection.addEventListener("state", ({ detail }) => this.#show(detail));
    connection.addEventListener("picked", ({ detail }) => {
      const number = detail.surface?.material?.number;
      if (number !== undefined) this.#choose(`material ${number}`);
    });
  }

  #choose(chosen) {
    if (!this.state || !this.#part(chosen)) return;
    this.#chosen = chosen;
    this.#show(this.state);
  }

  // What a choice such as "light 2" stands for.
  #part(chosen) {
    const [part, number] = chosen.split(" ");
    return this.state.parts[part]?.[Number(number)];
  }

  #show(state) {
    this.state = state;
    const all = Object.keys(GROUPS).flatMap((part) => (state.parts[part] ?? []).map((_, i) => `${part} ${i}`));
    section.hidden = !state.may_edit || !all.length;
    if (section.hidden) return;
    if (!this.#part(this.#chosen)) this.#chosen = all[0];
    const it = this.#part(this.#chosen);
    const names = Object.keys(GROUPS).map((part) => state.parts[part].map(({ name, kind }) => [name, kind]));
    const key = JSON.stringify([this.#chosen, names]);
    if (key !== this.#built) this.#build(state, it);
    this.#built = key;
    for (const made of this.#controls) made.show(it.parameters[made.name] ?? made.default);
    this.undo.disabled = !state.can_undo;
    this.redo.disabled = !state.can_redo;
  }

  #build({ parts }, it) {
    const groups = Object.entries(GROUPS).filter(([part]) => parts[part].length).map(([part, label]) => {
      const options = parts[part].map(({ name, kind }, i) => element("option", { value: `${part} ${i}` }, name || `${i}: ${kind}`));
      return element("optgroup", { label }, ...options);
    });
    const choice = element("select", { id: "part", onchange: () => this.#choose(choice.value) }, ...groups);
    choice.value = this.#chosen;
    const [part, number] = this.#chosen.split(" ");
    const row = this.kinds[part].find((row) => row.name === it.kind);
    const make = (parameter) => {
      const send = (value) => this.connection.send("edit", { part, number: Number(number), key: parameter.name, value });
      const made = control({ ...parameter, soft: reach(it.parameters[parameter.name] ?? parameter.default) }, send);
      return made && { ...made, default: parameter.default };
    };
    this.#controls = (row?.parameters ?? []).map(make).filter(Boolean);
    this.undo = element("button", { type: "button", onclick: () => this.connection.send("undo") }, "Undo");
    this.redo = element("button", { type: "button", onclick: () => this.connection.send("redo") }, "Redo");
    const summary = row ? element("p", { class: "hint" }, `${row.name}: ${row.summary}`) : null;
    section.replaceChildren(
      element("div", { class: "heading" }, element("h2", { id: "edits-title" }, "Edit the scene"), element("div", { class: "buttons" }, this.undo, this.redo)),
      element("div", { class: "row" }, element("label", { for: "part" }, "What"), element("div", {}, choice, summary)),
      ...this.#controls.map((made) => made.row),
    );
  }
}

// How far a slider goes, if the range of its parameter is too wide for one.
function reach(value) {
  const number = Math.abs(Number(value));
  return Number.isFinite(number) && number > 0 ? Number((4 * number).toPrecision(2)) : 4;
}
