// How far the picture is, and what is wrong.

import { byId, large } from "./element.js";

const announcer = byId("announcer");

export class Status {
  #problem = "";

  constructor(connection) {
    connection.addEventListener("frame", ({ detail }) => this.#frame(detail));
    connection.addEventListener("state", ({ detail }) => this.tell(detail.problem ?? ""));
    connection.addEventListener("error", ({ detail }) => this.tell(detail?.message ?? ""));
    connection.addEventListener("lost", () => {
      this.tell("The viewer does not answer. Is it still running? This page connects again as soon as it does.");
    });
    connection.addEventListener("connected", () => this.tell(""));
  }

  #frame({ samples, total, noise, rate, rays, choice, preview, rests }) {
    byId("progress").value = samples / total;
    byId("samples").textContent = preview ? "Preview" : `${samples} of ${total} samples`;
    byId("noise").textContent = noise && !preview ? `${(noise * 100).toPrecision(2)}% noise` : "";
    byId("rate").textContent = `${large(rate)}samples/s, ${large(rays)}rays/s`;
    byId("choice").textContent = choice && !preview ? `auto: ${choice}` : "";
    byId("choice").title = choice ?? "";
    if (rests && !this.rested) announcer.textContent = `The picture is done: ${samples} samples.`;
    this.rested = rests;
  }

  tell(problem) {
    if (problem === this.#problem) return;
    this.#problem = problem;
    const shown = byId("problem");
    shown.textContent = problem;
    shown.hidden = !problem;
  }
}
