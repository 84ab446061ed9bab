// Puts the page together.

import { Accelerators } from "./accelerators.js";
import { Address } from "./address.js";
import { Compare } from "./compare.js";
import { Connection } from "./connection.js";
import { Controls } from "./controls.js";
import { Drop } from "./drop.js";
import { Edits } from "./edits.js";
import { byId, large } from "./element.js";
import { Model } from "./model.js";
import { Navigation } from "./navigation.js";
import { Pick } from "./pick.js";
import { PictureView } from "./picture.js";
import { Status } from "./status.js";

const connection = new Connection();
const picture = new PictureView(connection);
const pick = new Pick(connection, picture);
const status = new Status(connection);
new Controls(connection, picture);
new Edits(connection);
new Model(connection);
new Compare(connection, picture);
new Accelerators(connection);
new Address(connection);
new Drop(connection, (problem) => status.tell(problem));
new Navigation(connection, picture, { pick: (at) => pick.at(at), clear: () => pick.clear() });

for (const [id, path] of [["save-png", "picture.png"], ["save-exr", "picture.exr"], ["save-overlay", "overlay.toml"]]) {
  connection.addEventListener("visitor", () => (byId(id).href = connection.ours(path)));
}

connection.addEventListener("state", ({ detail: state }) => {
  document.title = `${state.title} – Bilux`;
  byId("title").textContent = state.title;
  const count = (n, one) => `${large(n).trim()} ${n === 1 ? one : `${one}s`}`;
  byId("contents").textContent = `${count(state.triangles, "triangle")}, ${count(state.objects, "object")}`;
  byId("command").textContent = state.command;
});

byId("copy").addEventListener("click", async () => {
  const text = byId("command").textContent;
  try {
    await navigator.clipboard.writeText(text);
    byId("copy").textContent = "Copied";
  } catch {
    // Without a clipboard, the text is selected instead.
    getSelection().selectAllChildren(byId("command"));
    byId("copy").textContent = "Selected";
  }
  byId("announcer").textContent = `The command is ${byId("copy").textContent.toLowerCase()}.`;
  setTimeout(() => (byId("copy").textContent = "Copy command"), 2000);
});

// The panel folds away; on a narrow screen it is folded at first.
const fold = byId("fold");
function setFolded(folded) {
  document.body.classList.toggle("folded", folded);
  fold.setAttribute("aria-expanded", String(!folded));
  fold.title = folded ? "Show the controls" : "Hide the controls";
}
fold.addEventListener("click", () => setFolded(!document.body.classList.contains("folded")));
setFolded(matchMedia("(max-width: 46rem)").matches);
