// A file that is dropped in is opened in the place of the scene.

import { byId, element } from "./element.js";

const hint = byId("drop-hint");

export class Drop {
  #may = false;

  constructor(connection, tell) {
    this.tell = tell;
    const input = element("input", { id: "open-file", type: "file", class: "unseen", "aria-label": "Open a file", tabindex: "-1", onchange: () => {
      if (input.files.length) this.#open([...input.files]);
      input.value = "";
    } });
    this.button = element("button", { type: "button", id: "open", onclick: () => input.click() }, "Open a file");
    byId("files").append(this.button, input);
    connection.addEventListener("state", ({ detail }) => {
      this.#may = detail.may_drop;
      byId("files").hidden = !this.#may;
      byId("save-overlay").hidden = !detail.may_edit;
    });
    let depth = 0;
    const isFiles = (event) => this.#may && event.dataTransfer?.types.includes("Files");
    addEventListener("dragenter", (event) => {
      if (isFiles(event)) hint.hidden = ++depth === 0;
    });
    addEventListener("dragleave", (event) => {
      if (isFiles(event) && --depth <= 0) hint.hidden = true;
    });
    addEventListener("dragover", (event) => isFiles(event) && event.preventDefault());
    addEventListener("drop", (event) => {
      if (!event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      [hint.hidden, depth] = [true, 0];
      if (this.#may) this.#open([...event.dataTransfer.files]);
    });
  }

  async #open(files) {
    if (files.length !== 1) return this.tell("Drop one file in, such as a .glb that holds all of its parts.");
    const [file] = files;
    this.button.disabled = true;
    this.tell("");
    try {
      const answer = await fetch(`open/${encodeURIComponent(file.name)}`, { method: "POST", body: file });
      if (!answer.ok) this.tell((await answer.text()).trim());
    } catch {
      this.tell(`${file.name} could not be sent.`);
    } finally {
      this.button.disabled = false;
    }
  }
}
