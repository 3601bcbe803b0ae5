// Elements of drawings.

// Makes an element of a drawing; every page holds one drawing from the start.
function drawn(tag, attributes) {
  const element = document.createElementNS(document.querySelector("svg").namespaceURI, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

// --- plots ---

// Pixels of a plot: room for the numbers beside it, least distance of numbers.
const PLOT = {left: 48, below: 24, above: 8, apartX: 64, apartY: 18};
const STEPS = [1, 2, 5].flatMap((it) => [1e-6, 1e-5, 1e-4, 1e-3, .01, .1, 1, 10, 100, 1000].map((ten) => it * ten)).sort((a, b) => a - b);

// Makes an empty plot of `wide` by `high` pixels. An axis is {from, to, text, steps}: `text` formats a number on it, given
// with the step between two numbers; `steps` are the steps to choose from.
function plot(label, [wide, high], across, up) {
  const {left, below, above, apartX, apartY} = PLOT;
  const svg = drawn("svg", {viewBox: "0 0 " + wide + " " + high, role: "img", "aria-label": label});
  const x = (value) => left + (wide - left) * (value - across.from) / (across.to - across.from || 1);
  const y = (value) => high - below - (high - below - above) * (value - up.from) / (up.to - up.from || 1);
  const ticks = ({from, to, text, steps = STEPS}, room, apart) => {
    const step = steps.find((it) => (to - from) / it <= Math.max(1, room / apart)) ?? steps.at(-1) * 2, all = [];
    for (let count = Math.ceil(from / step); count * step <= to; count += 1) all.push([count * step, text(count * step, step)]);
    return all;
  };
  const say = (text, right, down, anchor) => {
    const it = drawn("text", {x: right, y: down, "text-anchor": anchor, class: "label"});
    it.textContent = text;
    svg.append(it);
  };
  const path = (d, name) => svg.appendChild(drawn("path", {d, class: name}));
  for (const [value, text] of ticks(up, high - below - above, apartY)) {
    path("M" + left + " " + y(value) + "H" + wide, "rule");
    say(text, left - 4, y(value) + 4, "end");
  }
  for (const [value, text] of ticks(across, wide - left, apartX)) {
    path("M" + x(value) + " " + above + "V" + (high - below), "rule");
    const isLast = x(value) > .95 * wide;
    if (text) say(text, isLast ? wide : x(value), high - 6, isLast ? "end" : "middle");
  }
  // Draws a line through points [x, y]; a y of null parts it.
  const line = (points, name) => path(points.flatMap(([right, value], place) => (value === null ? [] :
    [(place && points[place - 1][1] !== null ? "L" : "M") + x(right).toFixed(1) + " " + y(value).toFixed(1)])).join(""), name);
  return {svg, x, y, path, line};
}
