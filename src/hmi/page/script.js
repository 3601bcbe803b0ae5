
"use strict";
// Shows the view. Every text comes through textContent, every word from the table.
const WORDS = JSON.parse(document.getElementById("words").textContent);
const KEYS = ["coil_resistance_ohm", "operate_voltage_v", "release_voltage_v", "operate_time_ms",
  "release_time_ms", "operate_bounce_ms", "release_bounce_ms", "contact_resistance_no_mohm",
  "contact_resistance_nc_mohm"];
const UNITS = {ohm: "Ω", v: "V", ms: "ms", mohm: "mΩ"};
const BINS = ["pass", "coil", "contact", "voltage", "time", "retest"];
const VERDICTS = ["pass", "fail", "void"];
// Stop comes last, where no other button is hit by mistake.
const ORDERS = ["reset", "start", "hold", "unhold", "abort", "clear", "stop"];
const STALE_MS = 2500;
const AGAIN_MS = 1000;
const NONE = "–";

const asked = new URLSearchParams(location.search);
const kept = {
  get(name) { try { return localStorage.getItem(name); } catch { return null; } },
  set(name, value) { try { localStorage.setItem(name, value); } catch { /* private window: not kept */ } },
};
let language = asked.get("lang") || kept.get("lang") || (navigator.language.startsWith("zh") ? "zh" : "en");
let theme = asked.get("theme") || kept.get("theme") ||
  (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
if (language !== "zh") language = "en";
let view = null;
let me = null;
// What is drawn, with what carries it.
let bodies = [];
// Where each actuator stood last, mm.
const was = {};
let heard = -Infinity;
let alive = true;
let source = null;

const at = (id) => document.getElementById(id);
const word = (key) => WORDS[key][language];
const known = (key, text) => (Object.hasOwn(WORDS, key) ? word(key) : text);

function make(tag, text, name) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (name) element.className = name;
  return element;
}

// --- figures ---

const whole = (value) => (Number.isFinite(value) ? value.toLocaleString("en").replaceAll(",", "\u202f") : NONE);

// A value ends where its uncertainty ends, which has two significant digits.
function measured(value, uncertainty) {
  if (!Number.isFinite(value)) return [NONE, NONE];
  if (!(uncertainty > 0)) return [String(Number(value.toPrecision(6))), NONE];
  const digits = Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(uncertainty))));
  return [value.toFixed(digits), uncertainty.toFixed(digits)];
}

function share(part, all) {
  return all > 0 ? (100 * part / all).toFixed(1) + "\u202f%" : NONE;
}

// --- words made of what the rig says ---

function stateText(state) {
  const testing = /^testing: (\w+)/.exec(state);
  if (!testing) return known("state." + state, state);
  return word("state.testing") + ": " + known("stage." + testing[1], testing[1]);
}

function reasonText(reason) {
  if (Object.hasOwn(WORDS, "text." + reason)) return word("text." + reason);
  const space = reason.indexOf(" ");
  const key = reason.slice(0, space), rest = reason.slice(space + 1);
  if (!KEYS.includes(key)) return reason;
  return word("key." + key) + " " + known("reason." + rest, rest);
}

// --- the parts of the page ---

function showAlarms(alarms) {
  const lines = alarms.slice(0, 3).map((alarm, place) => {
    const line = make("p");
    line.append(make("b", "▲ " + alarm.code));
    line.append(make("span", language === "zh" ? alarm.text_zh : alarm.text_en));
    if (place === 0 && alarms.length > 1) line.append(make("b", "(" + word("first_out") + ")"));
    return line;
  });
  if (alarms.length > 3) lines.push(make("p", "+ " + (alarms.length - 3) + " " + word("more_alarms")));
  at("alarms").className = alarms.length ? "bad" : "";
  at("alarms").replaceChildren(...(lines.length ? lines : [make("p", word("no_alarm"))]));
}

function showProgress() {
  const {judged, count} = view;
  const percent = count > 0 ? Math.min(100, 100 * judged / count) : 0;
  at("judged").textContent = count === null ? whole(judged) + " " + word("judged")
    : whole(judged) + " " + word("judged_of") + " " + whole(count) + " " + word("judged");
  at("percent").textContent = count === null ? word("endless") : percent.toFixed(0) + "\u202f%";
  at("bar").setAttribute("aria-valuenow", percent.toFixed(0));
  at("bar").firstElementChild.style.width = percent + "%";
}

function showLast(last) {
  at("seq").textContent = last ? whole(last.seq) : "";
  const [, verdict, bin] = at("verdict").children;
  at("verdict").className = last ? last.verdict : "";
  verdict.textContent = last ? known("verdict." + last.verdict, last.verdict) : NONE;
  bin.textContent = last ? word("to_bin") + " " + known("bin." + last.bin, last.bin) : word("no_part");
  showRecent(view.recent);
  const reasons = last ? last.reasons : [];
  at("reasons").replaceChildren(...reasons.slice(0, 3).map((reason) => make("li", reasonText(reason))));
  at("values").replaceChildren(...KEYS.map((key) => valueRow(key, last)));
}

function valueRow(key, last) {
  const [value, uncertainty] = last ? measured(last.values[key], last.uncertainty[key]) : [NONE, NONE];
  const row = make("tr");
  const blamed = last && last.verdict === "fail" && last.reasons.some((it) => it.startsWith(key + " "));
  if (blamed) row.className = "bad";
  const unit = UNITS[key.slice(key.lastIndexOf("_") + 1)];
  row.append(make("td", word("key." + key)), make("td", value), make("td", uncertainty), make("td", unit), bandCell(key, last));
  return row;
}

// Where a value lies between its limits; one without a limit on that side ends where the band does.
function bandCell(key, last) {
  const cell = make("td"), limits = view.limits[key], value = last ? last.values[key] : undefined;
  if (!limits || !Number.isFinite(value)) return cell;
  const [low, high] = limits, all = [low, high, value].filter(Number.isFinite);
  const from = low ?? Math.min(0, value), to = high ?? Math.max(value, ...all) * 1.5;
  const place = (it) => 12 + 60 * Math.min(1.2, Math.max(-.2, (it - from) / (to - from || 1)));
  const svg = drawn("svg", {class: "band", viewBox: "0 0 84 16", role: "img"});
  const title = drawn("title", {});
  title.textContent = (low ?? "–") + " … " + (high ?? "–");
  svg.append(title, drawn("rect", {x: 12, y: 4, width: 60, height: 8}),
    drawn("path", {d: "M" + place(value) + " 0V16"}));
  cell.append(svg);
  return cell;
}

function drawn(tag, attributes) {
  const element = document.createElementNS(at("mimic").firstElementChild.namespaceURI, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

const SHORT = {pass: "✓", fail: "✗", void: "?"};

function showRecent(recent) {
  at("recent").replaceChildren(...recent.map((part) => {
    const item = make("li", SHORT[part.verdict], part.verdict);
    item.title = part.seq + " · " + known("verdict." + part.verdict, part.verdict) + " · " + known("bin." + part.bin, part.bin);
    return item;
  }));
}

// --- the machine to scale ---

const PLACES = {pocket: "part_pusher", nest: "part_nest", gripper: "part_gripper"};

async function fetchMimic() {
  try {
    const text = await (await fetch("/mimic.svg")).text();
    const svg = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
    svg.dataset.label = "mimic";
    svg.setAttribute("aria-label", word("mimic"));
    at("mimic").replaceChildren(document.importNode(svg, true));
    bodies = Array.from(at("mimic").querySelectorAll("[data-rides]"),
      (body) => ({body, rides: JSON.parse(body.dataset.rides)}));
    showMimic();
  } catch { /* the page works without its picture */ }
}

// A moving actuator is drawn on its way to the end that it left the other one for.
function showMimic() {
  if (!view || !view.machine) return;
  const stands = {};
  for (const it of view.machine.actuators) {
    const from = was[it.name] ?? it.from_mm;
    if (it.from_mm === it.to_mm) was[it.name] = it.from_mm;
    const far = Math.abs(it.from_mm - from) > Math.abs(it.to_mm - from) ? it.from_mm : it.to_mm;
    stands[it.name] = it.from_mm === it.to_mm ? it.from_mm : it.moving ? far : (it.from_mm + it.to_mm) / 2;
  }
  const held = {};
  for (const [place, token] of Object.entries(view.machine.places)) held[PLACES[place]] = token;
  for (const {body, rides} of bodies) {
    let right = 0, down = 0;
    for (const [name, x, y] of rides) {
      right += x * (stands[name] || 0);
      down += y * (stands[name] || 0);
    }
    body.style.transform = "translate(" + right + "px," + down + "px)";
    if (!body.classList.contains("part")) continue;
    const token = held[body.dataset.body];
    body.classList.toggle("held", token !== undefined);
    body.classList.toggle("pass", token !== undefined && token.bin === "pass");
    body.classList.toggle("fail", token !== undefined && token.bin !== "" && token.bin !== "pass");
  }
}

// The usual names first, then whatever else there is.
const ordered = (names, counts) => [...names, ...Object.keys(counts).filter((it) => !names.includes(it))];

function showBins(bins) {
  const most = Math.max(1, ...Object.values(bins));
  at("bins").replaceChildren(...ordered(BINS, bins).map((name) => {
    const item = make("li"), bar = make("div", undefined, "bar"), fill = make("i");
    fill.style.width = 100 * (bins[name] || 0) / most + "%";
    bar.append(fill);
    item.append(make("span", known("bin." + name, name)), make("b", whole(bins[name] || 0)), bar);
    return item;
  }));
}

function showVerdicts(verdicts) {
  at("verdicts").replaceChildren(...ordered(VERDICTS, verdicts).map((name) => {
    const pair = make("div");
    pair.append(make("dt", known("verdict." + name, name)), make("dd", whole(verdicts[name] || 0)));
    return pair;
  }));
}

function showView() {
  if (!view) return;
  at("simulated").hidden = !view.simulated;
  for (const id of ["lot", "recipe"]) {
    at(id).textContent = view[id] || NONE;
    at(id).title = view[id];
  }
  at("state").textContent = stateText(view.state);
  for (const id of ["came_in", "inside", "went_out"]) at(id).textContent = whole(view[id]);
  at("rate").textContent = view.parts_per_hour === null ? NONE : whole(Math.round(view.parts_per_hour));
  const judged = Object.values(view.verdicts).reduce((sum, it) => sum + it, 0);
  at("yield").textContent = share(view.verdicts.pass || 0, judged);
  showAlarms(view.alarms);
  showMimic();
  showOrders(linkNow());
  showProgress();
  showLast(view.last);
  showBins(view.bins);
  showVerdicts(view.verdicts);
}

const linkNow = () => (performance.now() - heard > STALE_MS ? "lost" : alive ? "live" : "ended");

// Live, lost or ended; a page that is not live says so and is grey.
function showLink() {
  const link = linkNow();
  document.body.classList.toggle("stale", link !== "live");
  at("link").className = link === "live" ? "" : "bad";
  at("link").lastElementChild.textContent = word("link." + link);
  document.title = (view && view.simulated ? word("simulation") + " · " : "") + "relayrig";
}

// Every order has its place; one that would not be taken says why when it is pressed.
function showOrders(link) {
  const buttons = view && view.machine ? view.machine.buttons : [];
  for (const element of at("orders").children) {
    const button = buttons.find((it) => it.order === element.dataset.order && it.with === "");
    const why = whyNot(button, link);
    element.textContent = word("order." + element.dataset.order);
    element.setAttribute("aria-disabled", why !== "");
    element.title = why;
  }
}

// Made once: a button that changed under the finger would lose the press.
function makeOrders() {
  at("orders").replaceChildren(...ORDERS.map((order) => {
    const element = make("button", "", order === "stop" ? "stop" : "");
    element.type = "button";
    element.dataset.order = order;
    element.addEventListener("click", () => {
      const why = element.title;
      if (why) answer(why);
      else give(order);
    });
    return element;
  }));
}

function whyNot(button, link) {
  if (link === "ended" || !button) return word("stop.ended");
  if (me === null) return word("stop.login");
  if (button.enabled) return "";
  return language === "zh" ? button.why_zh : button.why_en;
}

function answer(text) {
  at("order_answer").textContent = text;
}

function showAll() {
  document.documentElement.lang = language === "zh" ? "zh-CN" : "en";
  document.documentElement.dataset.theme = theme;
  for (const element of document.querySelectorAll("[data-word]")) element.textContent = word(element.dataset.word);
  for (const element of document.querySelectorAll("[data-label]")) element.setAttribute("aria-label", word(element.dataset.label));
  showView();
  showWho();
}

// --- from the rig ---

function connect() {
  if (source) source.close();
  source = new EventSource("/api/events");
  source.addEventListener("view", (event) => {
    view = JSON.parse(event.data);
    heard = performance.now();
    showView();
    showLink();
  });
  source.addEventListener("beat", (event) => {
    alive = JSON.parse(event.data).alive;
    heard = performance.now();
    showLink();
  });
}

let tried = performance.now();
setInterval(() => {
  showLink();
  const now = performance.now();
  const dead = source.readyState === EventSource.CLOSED || now - heard > 2 * STALE_MS;
  if (dead && now - tried > (source.readyState === EventSource.CLOSED ? AGAIN_MS : 2 * STALE_MS)) {
    tried = now;
    connect();
  }
}, 250);

// --- to the rig ---

async function give(order) {
  try {
    const reply = await post("/api/orders", {order});
    const body = await reply.json();
    if (reply.ok) answer(word("order." + order) + ": " + word("order.taken"));
    else answer((language === "zh" && body.reason_zh) || body.reason);
  } catch {
    answer(word("stop.lost"));
  }
}

// --- who is here ---

async function post(path, body) {
  const headers = {"Content-Type": "application/json"};
  const signal = AbortSignal.timeout(5000);
  return fetch(path, {method: "POST", headers, body: JSON.stringify(body), signal});
}

async function askWho() {
  try { me = await (await fetch("/api/me")).json(); } catch { /* asked again when the link is back */ }
  showWho();
}

function showWho() {
  at("who").textContent = me ? me.name + " · " + word("logout") : word("login");
  showLink();
  showOrders(linkNow());
}

at("who").addEventListener("click", async () => {
  if (me) {
    try { await post("/api/logout", {}); } catch { return; }
    me = null;
    showWho();
    return;
  }
  at("login_answer").textContent = "";
  at("login").showModal();
});
at("login_cancel").addEventListener("click", () => at("login").close());
at("login").addEventListener("submit", async (event) => {
  event.preventDefault();
  try {
    const answer = await post("/api/login", {user: at("user").value, password: at("password").value});
    const body = await answer.json();
    if (answer.ok) {
      me = body;
      at("password").value = "";
      at("login").close();
    } else {
      at("login_answer").textContent = known("login." + answer.status, body.reason);
    }
  } catch {
    at("login_answer").textContent = word("stop.lost");
  }
  showWho();
});

at("language").addEventListener("click", () => {
  language = language === "zh" ? "en" : "zh";
  kept.set("lang", language);
  showAll();
});
at("theme").addEventListener("click", () => {
  theme = theme === "dark" ? "light" : "dark";
  kept.set("theme", theme);
  showAll();
});

makeOrders();
showAll();
askWho();
fetchMimic();
connect();
