// A plot of error against time, both in powers of ten.

import { plain, shape } from "./element.js";

const [WIDTH, HEIGHT] = [260, 150];
const MARGIN = { left: 40, right: 8, top: 8, bottom: 26 };
// Later points take the place of those that lie closer than this, so that a curve stays short.
const APART = 1.04;

// Adds a point to a curve whose times rise.
export function add(curve, point) {
  if (!(point.x > 0) || !(point.y > 0)) return;
  const before = curve.at(-2);
  if (before && point.x < before.x * APART) curve.pop();
  curve.push(point);
}

const log = Math.log10;

function range(values) {
  const [low, high] = [Math.floor(log(Math.min(...values))), Math.ceil(log(Math.max(...values)))];
  return high > low ? [low, high] : [low, low + 1];
}

// Draws curves, each with a class and its points, into an SVG element.
export function draw(svg, curves) {
  const all = curves.flatMap((curve) => curve.points);
  svg.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
  if (!all.length) return svg.replaceChildren();
  const [left, right] = range(all.map((p) => p.x));
  const [bottom, top] = range(all.map((p) => p.y));
  const x = (value) => MARGIN.left + ((log(value) - left) / (right - left)) * (WIDTH - MARGIN.left - MARGIN.right);
  const y = (value) => HEIGHT - MARGIN.bottom - ((log(value) - bottom) / (top - bottom)) * (HEIGHT - MARGIN.top - MARGIN.bottom);
  const parts = [];
  for (let i = left; i <= right; i++) {
    parts.push(shape("line", { class: "grid", x1: x(10 ** i), x2: x(10 ** i), y1: MARGIN.top, y2: HEIGHT - MARGIN.bottom }));
    parts.push(shape("text", { x: x(10 ** i), y: HEIGHT - MARGIN.bottom + 14, "text-anchor": i === right ? "end" : "middle" }, `${plain(10 ** i)} s`));
  }
  for (let i = bottom; i <= top; i++) {
    parts.push(shape("line", { class: "grid", x1: MARGIN.left, x2: WIDTH - MARGIN.right, y1: y(10 ** i), y2: y(10 ** i) }));
    parts.push(shape("text", { x: MARGIN.left - 5, y: y(10 ** i) + 4, "text-anchor": "end" }, `${plain(100 * 10 ** i)}%`));
  }
  for (const { kind, points } of curves) {
    if (!points.length) continue;
    const line = points.map((p) => `${x(p.x).toFixed(1)},${y(p.y).toFixed(1)}`).join(" ");
    parts.push(shape("polyline", { class: `curve ${kind}`, points: line }));
    const last = points.at(-1);
    parts.push(shape("circle", { class: `dot ${kind}`, cx: x(last.x), cy: y(last.y), r: 2.5 }));
  }
  svg.replaceChildren(...parts);
}
