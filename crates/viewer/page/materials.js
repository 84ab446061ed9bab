// The parameters of materials, if the viewer lets them be changed.

import { byId, element, title } from "./element.js";
import { control } from "./controls.js";

const section = byId("materials");

export class Materials {
  #chosen = 0;
  #built = "";
  #controls = [];

  constructor(connection) {
    this.connection = connection;
    connection.addEventListener("catalogue", ({ detail }) => (this.kinds = detail.materials));
    connection.addEventListener("state", ({ detail }) => this.#show(detail));
    connection.addEventListener("picked", ({ detail }) => this.#choose(detail.surface?.material?.number));
  }

  #choose(number) {
    if (number === undefined || !this.state?.materials[number]) return;
    this.#chosen = number;
    this.#show(this.state);
  }

  #show(state) {
    this.state = state;
    section.hidden = !state.may_edit || !state.materials.length;
    if (section.hidden) return;
    this.#chosen = Math.min(this.#chosen, state.materials.length - 1);
    const material = state.materials[this.#chosen];
    const key = JSON.stringify([this.#chosen, material.kind, state.materials.map((m) => m.name)]);
    if (key !== this.#built) this.#build(state, material);
    this.#built = key;
    for (const made of this.#controls) made.show(material.parameters[made.name] ?? made.default);
    this.undo.disabled = !state.can_undo;
    this.redo.disabled = !state.can_redo;
  }

  #build({ materials }, material) {
    const options = materials.map(({ name, kind }, i) => element("option", { value: String(i) }, name || `${i}: ${kind}`));
    const choice = element("select", { id: "material", onchange: () => this.#choose(Number(choice.value)) }, ...options);
    choice.value = String(this.#chosen);
    const row = this.kinds.find((row) => row.name === material.kind);
    const make = (parameter) => {
      const made = control(parameter, (value) => this.connection.send("edit", { material: this.#chosen, key: parameter.name, value }));
      return made && { ...made, default: parameter.default };
    };
    this.#controls = (row?.parameters ?? []).map(make).filter(Boolean);
    this.undo = element("button", { type: "button", onclick: () => this.connection.send("undo") }, "Undo");
    this.redo = element("button", { type: "button", onclick: () => this.connection.send("redo") }, "Redo");
    section.replaceChildren(
      element("div", { class: "heading" }, element("h2", { id: "materials-title" }, "Materials"), element("div", { class: "buttons" }, this.undo, this.redo)),
      element("div", { class: "row" }, element("label", { for: "material" }, title("material")), choice),
      ...this.#controls.map((made) => made.row),
    );
  }
}
