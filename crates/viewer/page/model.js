// What to show of a model: one of its animations and variants, at which time, and in which light.

import { busy } from "./busy.js";
import { byId, element } from "./element.js";

const section = byId("model");
// The choice of what was opened.
const OPENED = "";

export class Model {
  #seconds = null;
  #playing = false;
  #picture = 0;
  // When it was at which time, while it plays.
  #since = null;
  #waits = false;

  constructor(connection) {
    this.connection = connection;
    this.range = element("input", {
      id: "time-range", type: "range", min: 0, step: "any", "aria-describedby": "time-help",
      oninput: () => this.#go(this.range.valueAsNumber, true),
    });
    this.exact = element("input", { type: "number", min: 0, step: "any", "aria-label": "Time, as a number of seconds", onchange: () => {
      if (Number.isFinite(this.exact.valueAsNumber)) this.#go(this.exact.valueAsNumber, true);
    } });
    this.play = element("button", { type: "button", id: "play", "aria-pressed": "false", onclick: () => this.#toggle() }, "Play");
    this.row = element("div", {},
      element("div", { class: "row" }, element("label", { for: "time-range" }, "Seconds"), element("div", { class: "pair" }, this.range, this.exact)),
      element("span", { id: "time-help", class: "unseen" }, "The time that is shown, in seconds"),
    );
    const offer = (what, label) => new Offer(what, label, (name) => {
      busy("model", `${label}: opening the scene with it …`);
      connection.send(what, { name });
    });
    for (const done of ["state", "error", "lost"]) connection.addEventListener(done, () => busy("model", ""));
    this.offers = [offer("animation", "Animation"), offer("variant", "Variant"), offer("environment", "Light around")];
    section.replaceChildren(
      element("div", { class: "heading" }, element("h2", { id: "model-title" }, "Model"), this.play),
      ...this.offers.map((it) => it.row),
      this.row,
    );
    connection.addEventListener("state", ({ detail }) => this.#show(detail));
    connection.addEventListener("frame", ({ detail }) => this.#next(detail));
  }

  #show({ seconds, settings, animations, animation, variants, variant, environments, environment, title }) {
    this.#seconds = seconds;
    const [clips, looks, lights] = this.offers;
    const plays = animations.filter((it) => it.plays).map((it) => it.name).join(", ");
    clips.show(animations.map(({ word, name, seconds: long }) => [word, `${name} (${Number(long.toFixed(2))} s)`]), animation, title, plays);
    looks.show(variants.map((name) => [name, name]), variant, title);
    lights.show(environments.map((path) => [path, path.split(/[\\/]/).pop()]), environment, title);
    this.row.hidden = this.play.hidden = !seconds;
    section.hidden = !seconds && this.offers.every((it) => it.row.hidden);
    if (!seconds) this.#stop();
    const now = Number(settings.time);
    if (document.activeElement !== this.range) {
      this.range.max = Math.max(seconds ?? 1, now);
      this.range.value = now;
    }
    if (document.activeElement !== this.exact) this.exact.value = Number(now.toFixed(3));
  }

  #go(time, byHand) {
    if (byHand) this.#stop();
    this.exact.value = Number(time.toFixed(3));
    this.connection.send("set", { key: "time", value: Number(time.toFixed(4)) });
  }

  #toggle() {
    if (this.#playing) return this.#stop();
    this.#playing = true;
    this.#label();
    this.#since = [performance.now(), this.range.valueAsNumber % (this.#seconds || 1)];
    this.#step();
  }

  #stop() {
    if (!this.#playing) return;
    this.#playing = false;
    this.#label();
  }

  #label() {
    this.play.textContent = this.#playing ? "Pause" : "Play";
    this.play.setAttribute("aria-pressed", String(this.#playing));
  }

  // The time that it is now; the last picture has been seen.
  #step() {
    if (!this.#playing || !this.#seconds) return;
    const [began, from] = this.#since;
    const time = (from + (performance.now() - began) / 1000) % this.#seconds;
    this.range.value = time;
    this.#waits = true;
    this.#go(time, false);
    // A time at which nothing has moved gives no other picture.
    this.timer = setTimeout(() => this.#again(), 300);
  }

  #next(frame) {
    const isNew = frame.picture !== this.#picture;
    this.#picture = frame.picture;
    if (isNew) this.#again();
  }

  #again() {
    if (!this.#waits) return;
    this.#waits = false;
    clearTimeout(this.timer);
    requestAnimationFrame(() => this.#step());
  }
}

// A choice among what the model or the viewer has; what was opened is one of them.
class Offer {
  #built = "";

  constructor(what, label, choose) {
    this.select = element("select", { id: what, onchange: () => choose(this.select.value) });
    this.row = element("div", { class: "row" }, element("label", { for: what }, label), this.select);
  }

  show(choices, chosen, title, opened = "") {
    this.row.hidden = !choices.length;
    const key = JSON.stringify([choices, title]);
    if (key !== this.#built) {
      const first = element("option", { value: OPENED }, opened && !chosen ? `as opened: ${opened}` : "as opened");
      this.select.replaceChildren(first, ...choices.map(([value, words]) => element("option", { value }, words)));
      this.#built = key;
    }
    this.select.value = chosen ?? OPENED;
  }
}
