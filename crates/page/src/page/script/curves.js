// Curves of a part that did not pass: each record of a digitizer with the instants of results, or the whole test.

// Size of a panel, pixels.
const PANEL = {wide: 1000, high: 110};
// Up to as many samples of a signal have a dot each: the line between them is no reading.
const DOTTED = 60;
// Marks in the order of drawing: the dots of a zero stay visible over an instant at that zero.
const MARKS = ["switch_on", "switch_off", "next_zero"];
// Signals that come first, from top to bottom.
const FIRST = ["control_voltage", "load_voltage", "load_current", "output_voltage"];

const shortName = (curve) => curve.signal.split(".").at(-1);
const placeOf = (curve) => (FIRST.indexOf(shortName(curve)) + FIRST.length + 1) % (FIRST.length + 1);

// Returns the microseconds since 1970 UTC of a time of the history.
const micros = (when) => Date.parse(when.slice(0, 19) + "Z") * 1000 + Math.round(Number("0" + when.slice(19, -1)) * 1e6);
const pointsOf = (curve) => curve.t_us.map((t, place) => [micros(curve.begin) + t, curve.values[place]]);
const named = (curves, prefix) => curves.filter((it) => it.signal.startsWith(prefix));

// Returns {stage, from, to, zero} of each record in order of time; of a part without records, its whole test. `zero` is
// the trigger, from which the drawing counts.
function recordsOf(curves) {
  const records = named(curves, "record.").flatMap((curve) => {
    const points = pointsOf(curve), begins = points.filter((_, place) => place % 2 === 0);
    return begins.map(([from, since_s], place) => ({stage: curve.signal.slice(7), from, to: points[2 * place + 1]?.[0] ?? from,
      zero: from - since_s * 1e6}));
  });
  if (records.length) return records.sort((a, b) => a.from - b.from);
  const times = curves.flatMap((it) => pointsOf(it).map(([at]) => at)), from = Math.min(...times);
  return times.length ? [{stage: null, from, to: Math.max(...times), zero: from}] : [];
}

function showCurves(part) {
  const curves = part.curves ?? [], figures = recordsOf(curves).map((record) => recordFigure(curves, record)).filter(Boolean);
  at("part_curves").hidden = figures.length === 0;
  at("part_records").replaceChildren(...figures);
}

// Draws the signals of a record below each other; null for a record without any.
function recordFigure(curves, {stage, from, to, zero}) {
  const inside = (curve) => pointsOf(curve).filter(([at]) => from <= at && at <= to);
  const signals = curves.filter((it) => it.unit && !it.signal.startsWith("record.")).sort((a, b) => placeOf(a) - placeOf(b))
    .map((it) => [it, inside(it)]).filter(([, points]) => points.filter(([, value]) => value !== null).length > 1);
  if (signals.length === 0) return null;
  const marks = MARKS.map((name) => [name, named(curves, "mark." + name).flatMap(inside).map(([at]) => (at - zero) / 1000)]).filter(([, times]) => times.length);
  const figure = make("figure");
  const about = make("figcaption", stage === null ? word("curve-test") : word("curve-record") + colon() + wordOr("stage-" + stage, stage));
  for (const [name] of marks) about.append(make("span", word("mark-" + name), "mark_key " + name));
  const across = {from: (from - zero) / 1000, to: (to - zero) / 1000};
  figure.append(about, ...signals.flatMap(([curve, points], place) => {
    const isLast = place === signals.length - 1;
    const name = wordOr("curve-" + shortName(curve), curve.signal) + " / " + unitText(curve.unit);
    return [make("small", name), panel(name, {...across, text: (it, step) => (isLast ? stepped(it, step) + " ms" : "")},
      points.map(([at, value]) => [(at - zero) / 1000, value]), marks)];
  }));
  return figure;
}

// Formats a number with the decimals that a step needs.
const stepped = (value, step) => value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));

function panel(name, across, points, marks) {
  const values = points.map(([, value]) => value).filter(Number.isFinite), low = Math.min(...values), room = .08 * (Math.max(...values) - low) || .5;
  const {svg, x, y, path, line} = plot(name, [PANEL.wide, PANEL.high], across, {from: low - room, to: Math.max(...values) + room, text: stepped});
  for (const [kind, times] of marks) {
    const title = drawn("title", {});
    title.textContent = word("mark-" + kind) + colon() + times.map((it) => it.toFixed(3) + " ms").join(comma());
    path(times.map((it) => "M" + x(it).toFixed(1) + " " + PLOT.above + "V" + (PANEL.high - PLOT.below)).join(""), "mark " + kind).append(title);
  }
  line(points, "curve");
  if (points.length <= DOTTED) path(points.filter(([, value]) => value !== null).map(([at, value]) => "M" + x(at).toFixed(1) + " " + y(value).toFixed(1) + "h.1").join(""), "dots");
  return svg;
}
