// The machine to scale: fetches the picture once and moves its groups with every view.

// Moving bodies with the actuators that carry them.
let bodies = [];
// Last known position of each actuator, mm.
const lastPositions = {};
const PLACES = {pocket: "part_pusher", nest: "part_nest", gripper: "part_gripper"};

async function fetchMimic() {
  try {
    const text = await (await fetch("/mimic.svg")).text();
    const svg = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
    at("mimic").replaceChildren(document.importNode(svg, true));
    bodies = Array.from(at("mimic").querySelectorAll("[data-rides]"),
      (body) => ({body, rides: JSON.parse(body.dataset.rides)}));
    nameBodies();
    showMimic();
  } catch { /* the page works without its picture */ }
}

// Names the picture and its bodies in the language of the page, for tooltips and screen readers.
function nameBodies() {
  at("mimic").firstElementChild.setAttribute("aria-label", word("mimic"));
  for (const body of at("mimic").querySelectorAll("[data-body]")) body.querySelector("title").textContent = bodyText(body.dataset.body);
}

// Draws a moving actuator at its target: CSS makes the transition.
function showMimic() {
  if (!view || !view.machine) return;
  const positions = {};
  for (const it of view.machine.actuators) {
    const from = lastPositions[it.name] ?? it.from_mm;
    if (it.from_mm === it.to_mm) lastPositions[it.name] = it.from_mm;
    const far = Math.abs(it.from_mm - from) > Math.abs(it.to_mm - from) ? it.from_mm : it.to_mm;
    positions[it.name] = it.from_mm === it.to_mm ? it.from_mm : it.moving ? far : (it.from_mm + it.to_mm) / 2;
  }
  showRefused(view.machine.refused);
  const held = {};
  for (const [place, token] of Object.entries(view.machine.places)) held[PLACES[place]] = token;
  for (const {body, rides} of bodies) {
    let right = 0, down = 0;
    for (const [name, x, y] of rides) {
      right += x * (positions[name] || 0);
      down += y * (positions[name] || 0);
    }
    body.style.transform = "translate(" + right + "px," + down + "px)";
    if (!body.classList.contains("part")) continue;
    const token = held[body.dataset.body];
    body.classList.toggle("held", token !== undefined);
    body.classList.toggle("pass", token !== undefined && token.bin === "pass");
    body.classList.toggle("fail", token !== undefined && token.bin !== "" && token.bin !== "pass");
  }
}

// --- a motion that the guard refused: mover, blocker and swept volume ---

// Returns the text of a body, or its id: a plant's own scene may have bodies without a text.
const bodyText = (id) => wordOr("body-" + id, id.replaceAll("_", " "));

const bodiesText = (refused) => (refused.mover === "" ? said(refused, "text") : bodyText(refused.mover) + " → " + bodyText(refused.blocker));

const refusedText = (refused) => {
  const {mover, distance_mm: distance, margin_mm: margin, at: place, last_clear_mm: clear} = refused;
  if (mover === "") return bodiesText(refused);
  const mm = (key, value) => word(key) + " " + value.toFixed(2) + " mm";
  const parts = [bodiesText(refused) + bracketed(place.map((it) => it.toFixed(1)).join(", ") + " mm"), mm("collision-distance", distance),
    word("collision-needed") + " > " + margin.toFixed(2) + " mm", ...(clear === null ? [] : [mm("collision-clear", clear)])];
  return parts.join(comma());
};

// Returns the corners of the convex hull of `points`, each [x, y] (Andrew's monotone chain).
function hull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (all) => all.reduce((chain, point) => {
    const left = ([a, b]) => (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]) > 0;
    while (chain.length > 1 && !left(chain.slice(-2))) chain.pop();
    return [...chain, point];
  }, []).slice(0, -1);
  return [...half(sorted), ...half(sorted.reverse())];
}

// Returns polygons of the area that a body sweeps during its strokes: the hull of each silhouette at the ends.
function swept(body, rides, strokes) {
  const shifts = [0, 1, 2].map((which) => rides.reduce(([right, down], [name, x, y]) => {
    const stroke = strokes.find((it) => it.actuator === name);
    const positions = view.machine.actuators.find((it) => it.name === name);
    const mm = !stroke ? (positions ? positions.from_mm : 0) : which === 2 ? stroke.to_mm : stroke.from_mm[which];
    return [right + x * mm, down + y * mm];
  }, [0, 0]));
  return Array.from(body.querySelectorAll("polygon"), (polygon) => {
    const corners = polygon.getAttribute("points").trim().split(" ").map((it) => it.split(",").map(Number));
    const points = hull(shifts.flatMap(([right, down]) => corners.map(([x, y]) => [x + right, y + down])));
    return drawn("polygon", {points: points.map((it) => it.join()).join(" "), class: "swept"});
  });
}

let drawnRefused = "";

function showRefused(refused) {
  const now = JSON.stringify([refused, language]);
  if (now === drawnRefused) return;
  drawnRefused = now;
  for (const old of at("mimic").querySelectorAll(".swept")) old.remove();
  const {mover, blocker} = refused ? refused.refused : {};
  for (const {body, rides} of bodies) {
    body.classList.toggle("mover", body.dataset.body === mover);
    body.classList.toggle("blocker", body.dataset.body === blocker);
    if (body.dataset.body === mover) body.parentNode.append(...swept(body, rides, refused.strokes));
  }
  at("refused").hidden = !refused;
  at("refused").replaceChildren(...(refused ? [make("b", "◆ " + word("collision") + colon() +
    wordOr("motion-" + refused.motion, refused.motion)), make("span", refusedText(refused.refused))] : []));
}
