// The time of scenes that move, and the variant of their materials.

import { byId, element } from "./element.js";

const section = byId("time");

export class Time {
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
      element("div", { class: "heading" }, element("h2", { id: "time-title" }, "Time"), this.play),
      element("div", { class: "row" }, element("label", { for: "time-range" }, "Seconds"), element("div", { class: "pair" }, this.range, this.exact)),
      element("span", { id: "time-help", class: "unseen" }, "The time that is shown, in seconds"),
    );
    this.variant = element("select", { id: "variant", onchange: () => connection.send("variant", { name: this.variant.value }) });
    this.variants = element("div", { class: "row" }, element("label", { for: "variant" }, "Variant"), this.variant);
    section.replaceChildren(this.row, this.variants);
    connection.addEventListener("state", ({ detail }) => this.#show(detail));
    connection.addEventListener("frame", ({ detail }) => this.#next(detail));
  }

  #show({ seconds, settings, variants, variant, title }) {
    this.#seconds = seconds;
    section.hidden = !seconds && !variants.length;
    this.row.hidden = !seconds;
    this.variants.hidden = !variants.length;
    if (!seconds) this.#stop();
    const now = Number(settings.time);
    if (document.activeElement !== this.range) {
      this.range.max = Math.max(seconds ?? 1, now);
      this.range.value = now;
    }
    if (document.activeElement !== this.exact) this.exact.value = Number(now.toFixed(3));
    const key = JSON.stringify([variants, title]);
    if (key !== this.built) {
      const first = element("option", { value: "", disabled: true }, "as in the file");
      this.variant.replaceChildren(first, ...variants.map((name) => element("option", { value: name }, name)));
      this.built = key;
    }
    this.variant.value = variant ?? "";
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
