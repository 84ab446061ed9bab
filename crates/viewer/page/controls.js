// The controls, made from the tables that the server sends: names, help, units and ranges are theirs.

import { byId, element, title } from "./element.js";

const form = byId("controls");
// A slider covers this many stops on each side.
const STOPS = 8;
// Wider ranges get no slider.
const SLIDER = 100;

let last = 0;

// A control for a parameter of a table: `change` is called with a new value. Returns a row, and a function that shows a value.
export function control(parameter, change) {
  const { name, summary, unit, kind } = parameter;
  const id = `control-${++last}`;
  const help = unit ? `${summary} (${unit})` : summary;
  const made = MAKERS[kind]?.(parameter, id, change);
  if (!made) return null;
  const label = element("label", { for: id, title: help }, title(name));
  const row = element("div", { class: "row", "data-setting": name, title: help }, label, made.element);
  row.append(element("span", { id: `${id}-help`, class: "unseen" }, help));
  for (const input of row.querySelectorAll("input, select")) input.setAttribute("aria-describedby", `${id}-help`);
  return { row, show: made.show, name };
}

const busy = (input) => document.activeElement === input;

const MAKERS = {
  choice({ choices }, id, change) {
    const options = choices.map((choice) => element("option", { value: choice.name, title: choice.summary }, choice.name));
    const select = element("select", { id, onchange: () => change(select.value) }, ...options);
    const hint = element("p", { class: "hint" });
    const show = (value) => {
      select.value = value;
      hint.textContent = choices.find((choice) => choice.name === select.value)?.summary ?? "";
      hint.hidden = !hint.textContent;
    };
    return { element: withHint(select, hint), show };
  },

  switch(_, id, change) {
    const box = element("input", { id, type: "checkbox", onchange: () => change(box.checked) });
    return { element: box, show: (value) => (box.checked = value === true || value === "true") };
  },

  integer: (parameter, id, change) => number(parameter, id, change, 1),

  number({ unit, min, max, ...rest }, id, change) {
    if (unit === "EV") return slider({ min: -STOPS, max: STOPS, hard: [min, max], ...rest }, id, change, 0.1);
    if (max - min <= SLIDER) return slider({ min, max, hard: [min, max], ...rest }, id, change, (max - min) / 200);
    return number({ min, max, ...rest }, id, change, "any");
  },

  text(_, id, change) {
    const input = element("input", { id, type: "text", spellcheck: "false", onchange: () => change(input.value) });
    return { element: input, show: (value) => busy(input) || (input.value = value) };
  },

  colour({ max }, id, change) {
    const input = element("input", { id, type: "color", oninput: () => change(toLinear(input.value)) });
    const show = (value) => {
      const list = typeof value === "string" ? value.split(" ").map(Number) : [value].flat();
      const is_colour = list.every((part) => typeof part === "number") && Math.max(...list) <= Math.min(max, 1);
      input.disabled = !is_colour;
      if (is_colour && !busy(input)) input.value = fromLinear(list.length === 1 ? [list[0], list[0], list[0]] : list);
    };
    return { element: input, show };
  },
};

function withHint(input, hint) {
  return element("div", {}, input, hint);
}

function number({ min, max }, id, change, step) {
  const commit = () => input.reportValidity() && input.value !== "" && change(input.valueAsNumber);
  const input = element("input", { id, type: "number", min, max, step, onchange: commit });
  return { element: input, show: (value) => busy(input) || (input.value = value) };
}

function slider({ name, min, max, hard }, id, change, step) {
  const round = (value) => Number(value.toPrecision(6));
  const range = element("input", {
    id, type: "range", min, max, step,
    oninput: () => {
      exact.value = range.value;
      change(round(range.valueAsNumber));
    },
  });
  const exact = element("input", {
    type: "number", min: hard[0], max: hard[1], step: "any", "aria-label": `${title(name)}, as a number`,
    onchange: () => exact.reportValidity() && exact.value !== "" && change(exact.valueAsNumber),
  });
  const show = (value) => {
    const is_number = Number.isFinite(Number(value)) && typeof value !== "object";
    range.disabled = exact.disabled = !is_number;
    if (!is_number) return;
    if (!busy(range)) range.value = value;
    if (!busy(exact)) exact.value = round(Number(value));
  };
  return { element: element("div", { class: "pair" }, range, exact), show };
}

// #rrggbb to linear light, and back.
function toLinear(text) {
  const channel = (at) => {
    const x = parseInt(text.slice(at, at + 2), 16) / 255;
    return Number((x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4).toPrecision(5));
  };
  return [channel(1), channel(3), channel(5)];
}

export function fromLinear(list) {
  const channel = (x) => {
    const y = Math.max(0, Math.min(1, x));
    const encoded = y <= 0.0031308 ? y * 12.92 : 1.055 * y ** (1 / 2.4) - 0.055;
    return Math.round(encoded * 255).toString(16).padStart(2, "0");
  };
  return "#" + list.map(channel).join("");
}

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
    for (const { name, settings } of catalogue.groups) {
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
