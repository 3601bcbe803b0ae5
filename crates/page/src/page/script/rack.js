// The rack of a rig that tests batches: plan of the sockets, and the air with the switchings of each socket.

// Drawing of the air, pixels: size before layout, room for the numbers beside it, least distance between numbers.
const AIR = {wide: 640, high: 230, left: 48, below: 24, above: 8, apartX: 64, apartY: 18};

function showRack() {
  const rack = view.machine?.rack;
  document.body.classList.toggle("rack", Boolean(rack));
  if (!rack) return;
  at("rack_phase").textContent = word("rack_phase-" + rack.phase) + (rack.batch ? comma() + word("rack-batch") + " " + rack.batch : "");
  showAir(rack.test);
  const plan = at("rack_plan");
  while (plan.children.length > rack.sockets.length) plan.lastElementChild.remove();
  rack.sockets.forEach((socket, place) => showSocket(plan.children[place] ?? plan.appendChild(make("li")), socket, rack.test));
}

// Returns the state of a socket: the verdict once the part is judged, else the state of the contact.
function socketState({number, closed}) {
  const part = view.machine.places["socket_" + number];
  if (part?.bin) return part.bin === "pass" ? "pass" : part.bin === "retest" ? "void" : "fail";
  if (closed === null) return "unread";
  return closed ? "closed" : part ? "open" : "empty";
}

const SOCKET_MARKS = {...SHORT, unread: "·", closed: "●", open: "○", empty: ""};

function showSocket(item, socket, test) {
  const state = socketState(socket), part = view.machine.places["socket_" + socket.number];
  item.className = state;
  item.style.gridArea = socket.row + " / " + socket.column;
  item.replaceChildren(make("small", socket.number), make("b", SOCKET_MARKS[state]));
  const list = part?.bin ? comma() + wordOr("bin-" + part.bin, part.bin) : "";
  const about = word("rack-socket") + " " + socket.number + (part ? comma() + word("rack-part") + " " + part.name : "") + colon() +
    word("rack_socket-" + state) + list;
  item.title = [about, ...switchedTexts(socket.number, test)].join("\n");
}

const minutes = (seconds) => (seconds / 60).toFixed(1) + " min";

// Returns a line for each switching of a socket: time and temperature.
function switchedTexts(number, test) {
  const own = test?.switched.find((it) => it.socket === number);
  if (!own) return [];
  const all = [...own.opened_s.map((t) => [t, "rack-opened"]), ...own.closed_s.map((t) => [t, "rack-closed"])];
  return all.sort((a, b) => a[0] - b[0]).map(([t, key]) => {
    const celsius = airAt(test.curve, t);
    return word(key) + " " + minutes(t) + (celsius === null ? "" : comma() + word("rack-reference") + " " + celsius.toFixed(1) + " °C");
  });
}

// Returns the temperature of the air at a time of the curve, C; null outside the curve.
function airAt({t_s: times, reference_c: air}, t) {
  const after = times.findIndex((it) => it >= t);
  if (after < 0) return air.at(-1) ?? null;
  if (after === 0) return air[0];
  const share = (t - times[after - 1]) / (times[after] - times[after - 1]);
  return air[after - 1] + share * (air[after] - air[after - 1]);
}

const celsiusText = (value) => (Number.isFinite(value) ? value.toFixed(2) : NONE);

function showAir(test) {
  at("air_set").textContent = celsiusText(test?.set_c);
  at("air_reference").textContent = celsiusText(test?.reference_c);
  at("air_rate").textContent = celsiusText(test?.rate_k_per_min);
  at("air_pass").textContent = test?.pass ? test.pass + " / " + test.passes : NONE;
  const box = at("air");
  box.replaceChildren(airDrawing(test, box.clientWidth || AIR.wide, box.clientHeight || AIR.high));
}

// Draws set point and reference over time, and each switching as a mark on the reference; sizes in pixels.
function airDrawing(test, wide, high) {
  const {left, below, above, apartX, apartY} = AIR;
  const svg = drawn("svg", {viewBox: "0 0 " + wide + " " + high, role: "img", "aria-label": word("rack-curve")});
  const {t_s: times, set_c: set, reference_c: air} = test?.curve ?? {t_s: [], set_c: [], reference_c: []};
  if (times.length < 2) return svg;
  const all = [...air, ...set.filter(Number.isFinite)], end = times.at(-1);
  const low = Math.floor(Math.min(...all) / 10) * 10, top = Math.ceil(Math.max(...all) / 10) * 10 || low + 10;
  const x = (t) => left + (wide - left) * t / end, y = (c) => high - below - (high - below - above) * (c - low) / (top - low || 1);
  const say = (text, right, down, anchor) => {
    const label = drawn("text", {x: right, y: down, "text-anchor": anchor, class: "label"});
    label.textContent = text;
    svg.append(label);
  };
  const rule = (d) => svg.append(drawn("path", {d, class: "rule"}));
  const most = (room, apart) => Math.max(1, room / apart);
  const degrees = [10, 20, 50].find((it) => (top - low) / it <= most(high - below - above, apartY)) ?? 100;
  for (let c = Math.ceil(low / degrees) * degrees; c <= top; c += degrees) {
    rule("M" + left + " " + y(c) + "H" + wide);
    say(c + " °C", left - 4, y(c) + 4, "end");
  }
  const step = [1, 2, 5, 10, 20, 30, 60].find((it) => end / 60 / it <= most(wide - left, apartX)) ?? 120;
  for (let minute = step; minute * 60 <= end; minute += step) {
    rule("M" + x(minute * 60) + " " + above + "V" + (high - below));
    say(minute + " min", Math.min(wide, x(minute * 60)), high - 6, minute * 60 > .95 * end ? "end" : "middle");
  }
  const line = (values) => values.flatMap((c, place) => (c === null ? [] :
    [(place && values[place - 1] !== null ? "L" : "M") + x(times[place]).toFixed(1) + " " + y(c).toFixed(1)])).join("");
  svg.append(drawn("path", {d: line(set), class: "set"}), drawn("path", {d: line(air), class: "reference"}));
  const mark = (t, up) => "M" + x(t).toFixed(1) + " " + (y(airAt(test.curve, t)) + (up ? -3 : 3)).toFixed(1) + "v" + (up ? -9 : 9);
  const marks = (key, up) => test.switched.flatMap((it) => it[key].map((t) => mark(t, up))).join("");
  svg.append(drawn("path", {d: marks("opened_s", true), class: "opened"}), drawn("path", {d: marks("closed_s", false), class: "closed"}));
  return svg;
}
