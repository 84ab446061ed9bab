// Inputs for the parameters of tables: names, help, units and ranges are theirs.

import { element, title } from "./element.js";

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

  number({ unit, min, max, soft, ...rest }, id, change) {
    if (unit === "EV") return slider({ min: -STOPS, max: STOPS, hard: [min, max], ...rest }, id, change, 0.1);
    if (max - min <= SLIDER) return slider({ min, max, hard: [min, max], ...rest }, id, change, (max - min) / 200);
    // What is edited has a slider in any case: up to a few times its value.
    if (soft) return slider({ min: Math.max(min, 0), max: Math.min(max, soft), hard: [min, max], ...rest }, id, change, soft / 400);
    return number({ min, max, ...rest }, id, change, "any");
  },

  text(_, id, change) {
    const input = element("input", { id, type: "text", spellcheck: "false", onchange: () => change(input.value) });
    return { element: input, show: (value) => busy(input) || (input.value = value) };
  },

  vector({ name }, id, change) {
    const axes = ["x", "y", "z"];
    const commit = () => {
      const values = inputs.map((input) => input.valueAsNumber);
      if (values.every(Number.isFinite)) change(values);
    };
    const inputs = axes.map((axis, i) => element("input", {
      id: i ? null : id, type: "number", step: "any", "aria-label": `${title(name)}, ${axis}`, onchange: commit,
    }));
    const show = (value) => {
      const list = triple(value);
      inputs.forEach((input, i) => busy(input) || (input.value = list[i]));
    };
    return { element: element("div", { class: "triple" }, ...inputs), show };
  },

  colour({ name, max }, id, change) {
    if (max > 1) return light({ name, max }, id, change);
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

// Light may be brighter than white: a colour, and how strong it is.
function light({ name, max }, id, change) {
  let now = [1, 1, 1];
  const strength = () => Math.max(...now);
  const commit = () => {
    const [colour, strong] = [toLinear(input.value), exact.valueAsNumber];
    if (!Number.isFinite(strong) || !exact.reportValidity()) return;
    const most = Math.max(...colour, 1e-6);
    now = colour.map((part) => Number(((part / most) * strong).toPrecision(5)));
    change(now);
  };
  const input = element("input", { id, type: "color", oninput: commit });
  const exact = element("input", { type: "number", min: 0, max, step: "any", "aria-label": `${title(name)}, strength`, onchange: commit });
  const show = (value) => {
    const list = triple(value);
    input.disabled = exact.disabled = !list.every((part) => Number.isFinite(part) && part >= 0);
    if (input.disabled) return;
    now = list;
    const strong = strength();
    if (!busy(input)) input.value = fromLinear(list.map((part) => part / Math.max(strong, 1e-6)));
    if (!busy(exact)) exact.value = Number(strong.toPrecision(6));
  };
  return { element: element("div", { class: "pair" }, input, exact), show };
}

// Three numbers; a single one stands for all.
function triple(value) {
  const list = typeof value === "string" ? value.split(" ").map(Number) : [value].flat();
  return list.length === 1 ? [list[0], list[0], list[0]] : list;
}

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
