// How fast each accelerator is in this scene, beside the others.

import { byId, element, large, plain } from "./element.js";

const section = byId("accelerators");

export class Accelerators {
  #rows = [];

  constructor(connection) {
    const button = element("button", { type: "button", onclick: () => {
      this.#rows = [];
      button.disabled = true;
      button.textContent = "Measuring …";
      this.#show();
      connection.send("measure");
    } }, "Measure all");
    this.button = button;
    this.table = element("div");
    section.replaceChildren(
      element("div", { class: "heading" }, element("h2", { id: "accelerators-title" }, "Accelerators"), button),
      element("p", { class: "hint" }, "Camera rays on one thread. “Show: Visits” is the heat map of the one that is chosen."),
      this.table,
    );
    connection.addEventListener("accelerator", ({ detail }) => {
      this.#rows.push(detail);
      if (detail.is_last) this.#end();
      this.#show();
    });
    // Whatever changes the picture ends the measurement.
    connection.addEventListener("state", ({ detail }) => {
      this.chosen = detail.accel;
      this.#end();
      this.#show();
    });
    connection.addEventListener("lost", () => this.#end());
  }

  #end() {
    this.button.disabled = false;
    this.button.textContent = "Measure all";
  }

  #show() {
    if (!this.#rows.length) return this.table.replaceChildren();
    const best = Math.max(...this.#rows.map((row) => row.rate ?? 0), 1);
    const heads = ["", "Rays/s", "Nodes", "Tests", "Build"].map((words) => element("th", { scope: "col" }, words));
    const rows = this.#rows.map(({ name, rate, nodes, tests, build, why_not: whyNot }) => {
      const head = element("th", { scope: "row", class: name === this.chosen ? "chosen" : null }, name);
      if (whyNot) return element("tr", {}, head, element("td", { colspan: "4" }, whyNot));
      const bar = element("span", { class: "bar", "aria-hidden": "true" });
      bar.style.width = `${(100 * rate) / best}%`;
      const cells = [large(rate).trim(), plain(nodes), plain(tests), `${plain(1000 * build, 2)} ms`].map((words) => element("td", {}, words));
      cells[0].append(bar);
      return element("tr", {}, head, ...cells);
    });
    const caption = element("caption", { class: "unseen" }, "Rays a second, nodes visited and triangles tested for a ray, and seconds to build");
    this.table.replaceChildren(element("table", {}, caption, element("thead", {}, element("tr", {}, ...heads)), element("tbody", {}, ...rows)));
  }
}
