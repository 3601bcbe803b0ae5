// The rack of a rig that tests batches: plan of the sockets, and the air with the switchings of each socket.

// Size of the drawing of the air before the page has given it one, pixels.
const AIR = {wide: 640, high: 230};

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
  const {t_s: times, set_c: set, reference_c: air} = test?.curve ?? {t_s: [], set_c: [], reference_c: []};
  const all = [...air, ...set.filter(Number.isFinite)], low = Math.floor(Math.min(...all) / 10) * 10;
  const top = Math.ceil(Math.max(...all) / 10) * 10 || low + 10;
  if (times.length < 2) return drawn("svg", {role: "img", "aria-label": word("rack-curve")});
  const across = {from: 0, to: times.at(-1) / 60, text: (it) => (it ? it + " min" : ""), steps: [1, 2, 5, 10, 20, 30, 60, 120]};
  const {svg, x, y, path, line} = plot(word("rack-curve"), [wide, high], across,
    {from: low, to: top, text: (it) => it + " °C", steps: [10, 20, 50, 100]});
  const over = (values) => values.map((celsius, place) => [times[place] / 60, celsius]);
  line(over(set), "set");
  line(over(air), "reference");
  const mark = (t, up) => "M" + x(t / 60).toFixed(1) + " " + (y(airAt(test.curve, t)) + (up ? -3 : 3)).toFixed(1) + "v" + (up ? -9 : 9);
  const marks = (key, up) => test.switched.flatMap((it) => it[key].map((t) => mark(t, up))).join("");
  path(marks("opened_s", true), "opened");
  path(marks("closed_s", false), "closed");
  return svg;
}
