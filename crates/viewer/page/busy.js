// Says on the picture what takes a while, so that nobody thinks that nothing happens.

import { byId } from "./element.js";

const shown = byId("busy");
const at = new Map();

// Something that takes a while has begun, or is over if there are no words.
export function busy(what, words) {
  if (words) at.set(what, words);
  else at.delete(what);
  shown.textContent = [...at.values()].at(-1) ?? "";
  shown.hidden = at.size === 0;
}
