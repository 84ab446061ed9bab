// How far the picture is, and what is wrong.

import { byId, large } from "./element.js";

const announcer = byId("announcer");

export class Status {
  #problem = "";

  constructor(connection) {
    connection.addEventListener("frame", ({ detail }) => this.#frame(detail));
    connection.addEventListener("progress", ({ detail }) => this.#progress(detail));
    connection.addEventListener("state", ({ detail }) => this.tell(detail.problem ?? ""));
    connection.addEventListener("error", ({ detail }) => this.tell(detail?.message ?? ""));
    connection.addEventListener("full", ({ detail }) => {
      this.tell(detail.message);
      byId("waiting").textContent = "There is no place: this page tries again by itself.";
    });
    connection.addEventListener("lost", () => {
      this.tell("The viewer does not answer. Is it still running? This page connects again as soon as it does.");
    });
    connection.addEventListener("connected", () => this.tell(""));
  }

  // How far the picture is: more often than there are frames, since denoising takes long.
  #progress({ level, divisor, samples, total, noise, waits, denoises }) {
    const isFull = level === "full";
    byId("progress").value = isFull ? samples / total : 0;
    const part = divisor === 2 ? "Half size" : `1/${divisor} of the size`;
    const far = isFull ? `${samples} of ${total} samples` : divisor > 1 ? `${part}, ${samples} samples` : "Preview";
    byId("samples").textContent = waits ? `${far}, others have their turn` : denoises && isFull ? `${far}, denoising` : far;
    byId("noise").textContent = noise && isFull ? `${(noise * 100).toPrecision(2)}% noise` : "";
  }

  #frame({ samples, rate, rays, choice, preview, rests }) {
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
