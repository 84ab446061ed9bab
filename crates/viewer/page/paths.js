// Draws paths of light into the picture.

import { byId, shape } from "./element.js";

const overlay = byId("overlay");

// How each kind of vertex is drawn.
const STYLES = {
  "surface": "scatter",
  "reflection": "scatter",
  "transmission": "through",
  "absorption": "lost",
  "medium": "scatter",
  "emitter": "light",
  "escape": "lost",
  "light sample": "light",
  "distant light": "light",
  "light path": "from-light",
};

export const LEGEND = [
  ["scatter", "reflected"],
  ["through", "passed through"],
  ["light", "brings light"],
  ["lost", "brings nothing"],
  ["from-light", "from a light"],
];

const brightness = ([r, g, b]) => 0.2126 * r + 0.7152 * g + 0.0722 * b;

// Draws paths, and marks the pixel that they reach. The more light a segment brings, the wider it is.
export function drawPaths([width, height], at, paths) {
  overlay.replaceChildren();
  if (!at) return;
  const most = Math.max(1e-12, ...paths.flatMap((path) => path.segments.map((segment) => brightness(segment.light))));
  const [halos, lines, dots] = [[], [], []];
  for (const path of paths) {
    for (const segment of path.segments) {
      const share = brightness(segment.light) / most;
      const style = segment.kind === "escape" && share > 0 ? "light" : STYLES[segment.kind];
      const [x1, y1, x2, y2] = [segment.from[0] * width, segment.from[1] * height, segment.to[0] * width, segment.to[1] * height];
      const wide = style === "light" ? 1 + 3 * Math.sqrt(share) : 1.2;
      // From the camera a segment is seen end on.
      if (!segment.from_camera) {
        const strong = style === "light" ? 0.35 + 0.65 * Math.sqrt(share) : Math.max(0.25, 0.9 - 0.18 * segment.depth);
        halos.push(shape("line", { class: "halo", x1, y1, x2, y2, "stroke-width": wide + 1.6, opacity: strong * 0.8 }));
        lines.push(shape("line", { class: style, x1, y1, x2, y2, "stroke-width": wide, opacity: strong }));
      }
    }
    for (const { vertex } of path.events) {
      if (!vertex?.at) continue;
      const style = STYLES[vertex.kind];
      const r = style === "light" ? 3.2 : 2.4;
      dots.push(shape("circle", { class: style, cx: vertex.at[0] * width, cy: vertex.at[1] * height, r }));
    }
  }
  const [x, y] = [at[0] * width, at[1] * height];
  const mark = shape("path", { class: "mark", d: `M${x - 11} ${y}h7M${x + 4} ${y}h7M${x} ${y - 11}v7M${x} ${y + 4}v7` });
  overlay.append(...halos, ...lines, ...dots, mark);
}
