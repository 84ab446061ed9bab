// The controls of the picture, made from the tables that the server sends.

import { byId, element, title } from "./element.js";
import { control } from "./inputs.js";

const form = byId("controls");

// All controls of the picture.
export class Controls {
  #controls = [];
  #own = { name: "", controls: [], place: null };
  #cameras = "";
  #shown = null;

  constructor(connection, picture) {
    Object.assign(this, { connection, picture });
    form.addEventListener("submit", (event) => event.preventDefault());
    connection.addEventListener("catalogue", ({ detail }) => this.#build(detail));
    connection.addEventListener("state", ({ detail }) => this.#show(detail));
  }

  #set(key, value) {
    this.connection.send("set", { key, value });
  }

  #build(catalogue) {
    this.catalogue = catalogue;
    this.#controls = [];
    this.#own = { name: "", controls: [], place: element("div") };
    this.#cameras = "";
    form.replaceChildren();
    // The time has a place of its own.
    for (const { name, settings } of catalogue.groups.filter(({ name }) => name !== "Time")) {
      const group = element("fieldset", {}, element("legend", {}, name));
      for (const parameter of settings) {
        if (parameter.name === "camera") {
          group.append((this.cameraPlace = element("div")));
          continue;
        }
        const made = control(parameter, (value) => this.#set(parameter.name, value));
        if (!made) continue;
        this.#controls.push(made);
        group.append(made.row);
        if (parameter.name === "integrator") group.append(this.#own.place);
      }
      if (name === "Camera and studio") group.append(this.#views());
      if (name === "Display") group.append(this.#resolution(), this.#layers(catalogue.layers));
      form.append(group);
    }
  }

  #views() {
    const home = element("button", { type: "button", id: "home", onclick: () => this.connection.send("home") }, "Back to the scene’s camera");
    return element("p", { class: "buttons" }, home);
  }

  // How many pixels are rendered for a pixel of the screen.
  #resolution() {
    const all = [["quarter", 0.25], ["half", 0.5], ["full", 1], ["of the device", window.devicePixelRatio]];
    const choices = all.filter(([, value], i) => i < 3 || value !== 1).map(([name]) => ({ name, summary: "" }));
    const parameter = { name: "resolution", summary: "pixels of the picture for a pixel of the screen", unit: "", kind: "choice", choices };
    const made = control(parameter, (name) => {
      made.show(name);
      this.picture.resolution = all.find(([own]) => own === name)[1];
    });
    made.show("full");
    return made.row;
  }

  // What is shown: the picture or one of its layers.
  #layers(layers) {
    const all = [{ name: "picture", summary: "the picture" }, ...layers];
    this.#shown = new Map();
    const segments = all.map(({ name, summary }) => {
      const input = element("input", {
        type: "radio", name: "shown", value: name,
        onchange: () => this.connection.send("show", { what: name }),
      });
      this.#shown.set(name, input);
      return element("label", { title: summary }, input, element("span", {}, title(name)));
    });
    const group = element("div", { class: "segments", role: "radiogroup", "aria-labelledby": "shown-label" }, ...segments);
    return element("div", { class: "row" }, element("label", { id: "shown-label" }, "Show"), group);
  }

  #show(state) {
    if (!this.catalogue) return;
    this.#showCameras(state);
    this.#showOwn(String(state.settings.integrator));
    for (const made of [...this.#controls, ...this.#own.controls]) made.show(state.settings[made.name]);
    const shown = this.#shown.get(state.shown);
    if (shown) shown.checked = true;
    byId("home").disabled = !state.moved;
  }

  // The cameras of the scene, if there are several.
  #showCameras({ cameras, settings }) {
    const key = JSON.stringify(cameras);
    if (key !== this.#cameras) {
      this.#cameras = key;
      const choices = cameras.map((name, i) => ({ name: String(i), summary: name }));
      const summary = "the camera of the scene";
      this.camera = control({ name: "camera", summary, unit: "", kind: "choice", choices }, (value) => this.#set("camera", value));
      this.cameraPlace.replaceChildren(...(cameras.length > 1 ? [this.camera.row] : []));
    }
    const named = cameras.indexOf(settings.camera);
    this.camera.show(named >= 0 ? String(named) : settings.camera);
  }

  // The parameters of the integrator itself.
  #showOwn(name) {
    if (name === this.#own.name) return;
    this.#own.name = name;
    const row = this.catalogue.integrators.find((row) => row.name === name);
    const make = (parameter) => control(parameter, (value) => this.#set(parameter.name, value));
    this.#own.controls = (row?.parameters ?? []).map(make).filter(Boolean);
    const details = element("details", {}, element("summary", {}, `Settings of ${name}`), ...this.#own.controls.map((c) => c.row));
    this.#own.place.replaceChildren(...(this.#own.controls.length ? [details] : []));
  }
}
