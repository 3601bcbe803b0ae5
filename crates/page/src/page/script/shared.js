"use strict";
// Functions that all pages share. Texts enter the page through textContent only, so that no value can become markup.
const WORDS = JSON.parse(document.getElementById("words").textContent);
// Characteristics of every kind of device and quantities measured outside of the rig, with unit and names; the bins that some kind of device names.
const {characteristics: CHARACTERISTICS, external: EXTERNAL, bins: BINS} = JSON.parse(document.getElementById("kinds").textContent);
const UNITS = {1: "", ohm: "Ω", mOhm: "mΩ", "mohm/V": "mΩ/V", C: "°C", uA: "µA", us: "µs", "V/us": "V/µs"};
const VERDICTS = ["pass", "fail", "void"];
const NONE = "–";

const options = new URLSearchParams(location.search);
const stored = {
  get(name) { try { return localStorage.getItem(name); } catch { return null; } },
  set(name, value) { try { localStorage.setItem(name, value); } catch { /* a private window stores nothing */ } },
};
let language = options.get("lang") || stored.get("lang") || (navigator.language.startsWith("zh") ? "zh" : "en");
let theme = options.get("theme") || stored.get("theme") ||
  (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
if (language !== "zh") language = "en";
let view = null;
let me = null;
// Bounds of a page: hours of history that the page shows at first, days of lots that it lists; `null` for no bound.
const bounds = {hours: null, lot_days: null};
// Functions of the pages by name: `enter` runs when the page opens or the language changes, `show` at every view.
const PAGES = {};

const at = (id) => document.getElementById(id);
const word = (key) => WORDS[key][language];
const wordOr = (key, text) => (Object.hasOwn(WORDS, key) ? word(key) : text);
// Marks of punctuation, with the blank that follows them in English.
const colon = () => (language === "zh" ? "\uff1a" : ": ");
const semicolon = () => (language === "zh" ? "\uff1b" : "; ");
const comma = () => (language === "zh" ? "\uff0c" : ", ");
const bracketed = (text) => (language === "zh" ? "\uff08" + text + "\uff09" : " (" + text + ")");
// Returns the Chinese or the English member of an answer; rows of older versions may have only the English member.
const said = (answer, key) => (language === "zh" && answer[key + "_zh"]) || answer[key];
const unitText = (unit) => UNITS[unit] ?? unit ?? "";

// --- characteristics ---

const characteristic = (key) => CHARACTERISTICS.find((it) => it.key === key) ?? EXTERNAL.find((it) => it.key === key);
// Returns the name of a characteristic, or its key: imported files may hold characteristics that no kind has.
const nameOf = (key) => characteristic(key)?.[language] ?? key;
const unitOf = (key) => unitText(characteristic(key)?.unit);
const keysOf = (has) => CHARACTERISTICS.map((it) => it.key).filter(has);
const keyOptions = () => CHARACTERISTICS.map((it) => [it.key, it[language]]);

function make(tag, text, name) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (name) element.className = name;
  return element;
}

// Shows a text in the element; parts between backticks, such as commands and keys, as code.
function showMarked(element, text) {
  element.replaceChildren(...text.split("`").map((part, place) => (place % 2 ? make("code", part) : part)));
  return element;
}

const row = (...cells) => {
  const element = make("tr");
  element.append(...cells.map((it) => {
    if (it instanceof HTMLTableCellElement) return it;
    const cell = make("td");
    cell.append(it);
    return cell;
  }));
  return element;
};

function button(text, press, name) {
  const element = make("button", text, name);
  element.type = "button";
  element.addEventListener("click", press);
  return element;
}

function fillSelect(element, options) {
  const had = element.value;
  element.replaceChildren(...options.map(([value, text]) => {
    const option = make("option", text);
    option.value = value;
    return option;
  }));
  if (options.some(([value]) => value === had)) element.value = had;
}

// Labels each cell of a list with the heading of its column: narrow screens show a row as a block.
new MutationObserver((changes) => {
  for (const {target} of changes) {
    for (const table of target.tagName === "TBODY" ? [target.parentElement] : target.querySelectorAll("table.list")) {
      const heads = table.tHead?.rows[0].cells ?? [];
      for (const it of table.tBodies[0].rows) Array.from(heads, (head, place) => { if (it.cells[place]) it.cells[place].dataset.head = head.textContent; });
    }
  }
}).observe(document.body, {childList: true, subtree: true});

// --- times ---

const two = (number) => String(number).padStart(2, "0");

// Formats RFC 3339 or microseconds since 1970 UTC as local time to the second.
function clock(when) {
  if (when === null || when === undefined) return NONE;
  const date = new Date(typeof when === "number" ? when / 1000 : when);
  return date.getFullYear() + "-" + two(date.getMonth() + 1) + "-" + two(date.getDate()) + " " +
    two(date.getHours()) + ":" + two(date.getMinutes()) + ":" + two(date.getSeconds());
}

// Returns the text of a field for local time, to the minute.
const localText = (date) => clock(date.toISOString()).slice(0, 16).replace(" ", "T");

// Converts the text of a field for local time to RFC 3339; empty for an empty field.
const rfc3339 = (text) => (text ? new Date(text).toISOString() : "");

// --- figures ---

const integerText = (value) => (Number.isFinite(value) ? value.toLocaleString("en").replaceAll(",", "\u202f") : NONE);

// Formats a value and its uncertainty: the uncertainty to two significant digits, the value to the same decimal.
function measured(value, uncertainty) {
  if (!Number.isFinite(value)) return [NONE, NONE];
  if (!(uncertainty > 0)) return [String(Number(value.toPrecision(6))), NONE];
  const digits = Math.min(6, Math.max(0, 1 - Math.floor(Math.log10(uncertainty))));
  return [value.toFixed(digits), uncertainty.toFixed(digits)];
}

function share(part, all) {
  return all > 0 ? (100 * part / all).toFixed(1) + "\u202f%" : NONE;
}

// Makes a query string of the members that are not empty.
function query(members) {
  const named = Object.entries(members).filter(([, value]) => value !== "" && value !== null && value !== undefined);
  return named.length ? "?" + new URLSearchParams(named) : "";
}

// Requests `path`; throws the reason of a refusal.
async function ask(path) {
  const lost = () => { throw new Error(word("link-lost")); };
  const reply = await fetch(path, {signal: AbortSignal.timeout(20000)}).catch(lost);
  if (reply.ok) return reply;
  throw new Error(said(await reply.json(), "reason"));
}

const calls = new Map();

// Counts a call of `reader`; returns a check that no later call has begun: only the newest call may show its answer.
function newest(reader) {
  const call = (calls.get(reader) ?? 0) + 1;
  calls.set(reader, call);
  return () => calls.get(reader) === call;
}

async function post(path, body) {
  const headers = {"Content-Type": "application/json"};
  const signal = AbortSignal.timeout(5000);
  return fetch(path, {method: "POST", headers, body: JSON.stringify(body), signal});
}
