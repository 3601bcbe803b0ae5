// A revision of a recipe as a sheet: every key in words with its unit; for an engineer with range and input.

// Sections of the sheet, in order.
const RECIPE_SECTIONS = ["about", "part", "decision", "limits", "external", "test", "strategy", "prompt"];
let recipe = null, revisions = [], drawnRecipe = "";
// `typed`: texts typed into the newest revision, by path of the key. `refusedField`: the last refusal of a value.
// `recipeMessage` returns the last message in the language of the page.
const typed = new Map();
const NO_MESSAGE = () => ["", false];
let refusedField = null, recipeMessage = NO_MESSAGE;

const mayRevise = () => me !== null && me.role === "engineer" && recipe !== null && recipe.number === recipe.newest;
const recipeSection = (path) => (path.startsWith("test.strategy.") ? "strategy" : path.includes(".") ? path.split(".")[0] : "about");
const rangeText = (it) => (it.low === undefined ? "" : (it.low_allowed ? it.low + " … " : "> " + it.low + " … ") + it.high);

// Returns a value as the text of its input field; for a list, one text per number.
const asTyped = (value) => (Array.isArray(value) ? value.map(String) : value === null ? "" : String(value));

// Converts typed text to a value for the rig. Text that is no number stays text; the rig then refuses it with the key.
function asValue(field, text) {
  if (Array.isArray(text)) return text.map((it) => asValue({form: "number"}, it));
  if (text === "" && field.optional) return null;
  if (field.form === "flag") return text === "true";
  const number = Number(text.replace(",", "."));
  return ["number", "whole"].includes(field.form) && text.trim() !== "" && Number.isFinite(number) ? number : text;
}

function changedValues() {
  const values = {};
  for (const field of recipe.fields) {
    if (!typed.has(field.path)) continue;
    const value = asValue(field, typed.get(field.path));
    if (JSON.stringify(value) !== JSON.stringify(field.value)) values[field.path] = value;
  }
  return values;
}

// --- fields ---

const choiceText = (value) => (value === true || value === "true" ? word("r-yes") : value === false || value === "false" ? word("r-no")
  : wordOr("choice-" + value, value));

function shownText(field) {
  const {value} = field;
  if (value === null) return NONE;
  if (Array.isArray(value)) return value.join(" × ");
  return ["choice", "flag"].includes(field.form) ? choiceText(value) : String(value);
}

function typedInto(field, element, text, take) {
  element.value = text;
  element.setAttribute("aria-label", fieldName(field.path) + (unitText(field.unit) ? " / " + unitText(field.unit) : ""));
  element.dataset.path = field.path;
  element.addEventListener("input", () => {
    typed.set(field.path, take(element.value));
    element.classList.toggle("changed", field.path in changedValues());
  });
  element.classList.toggle("changed", field.path in changedValues());
  return element;
}

function fieldInputs(field) {
  const text = typed.get(field.path) ?? asTyped(field.value);
  if (["choice", "flag"].includes(field.form)) {
    const words = field.form === "flag" ? ["true", "false"] : field.words;
    const options = words.map((it) => [it, choiceText(it)]), element = make("select");
    fillSelect(element, field.optional ? [["", NONE], ...options] : options);
    return [typedInto(field, element, text, (it) => it)];
  }
  if (field.form === "numbers") {
    return text.map((it, place) => typedInto(field, make("input", undefined, "number"), it,
      (now) => (typed.get(field.path) ?? text).map((had, which) => (which === place ? now : had))));
  }
  return [typedInto(field, make("input", undefined, field.form === "text" ? "" : "number"), text, (it) => it)];
}

// Returns the numbers, from 1, of a prompt and its choice, as in "1.2 Answer, English".
const places = (path) => (path.match(/\d+/g) ?? []).map((it) => Number(it) + 1).join(".");

const fieldName = (path) => {
  const [section, key, side] = path.split(".");
  if (section === "prompt") return places(path) + " " + word("field-" + path.replace(/\.\d+/g, "").replaceAll(".", "-"));
  return ["limits", "external"].includes(section) ? nameOf(key) + " " + word("r-" + side) : wordOr("field-" + path.replaceAll(".", "-"), nameOf(path.split(".").at(-1)));
};

const isFixed = (field) => field.path === "name" || Boolean(field.words) && field.words.length === 1;

// Makes the cell with the value, or with its inputs.
function fieldCell(field) {
  const cell = make("td");
  cell.append(...(mayRevise() && !isFixed(field) ? fieldInputs(field) : [make("span", shownText(field))]));
  return cell;
}

// Makes the cell with the unit, and with the range where the value may be changed.
function unitCell(field) {
  const cell = make("td", unitText(field.unit));
  if (mayRevise()) cell.append(make("small", rangeText(field)));
  return cell;
}

// Adds the reason of a refusal below the row of the refused value; for a list, below its first row.
function withRefusal(element, path) {
  if (!refusedField) return [element];
  const first = recipe.fields.find((it) => it.path.startsWith(refusedField.key + "."));
  if (path !== first?.path && !(refusedField.key + ".").startsWith(path + ".")) return [element];
  const cell = make("td", refusedValue(refusedField), "trouble");
  cell.colSpan = 4;
  return [element, row(cell)];
}

function fieldRow(field) {
  const value = fieldCell(field);
  if (field.unit !== undefined) return withRefusal(row(fieldName(field.path), value, unitCell(field)), field.path);
  value.colSpan = 2;
  return withRefusal(row(fieldName(field.path), value), field.path);
}

// Makes the row of a characteristic with its lower and upper limit.
function limitRow(key, [low, high]) {
  return withRefusal(row(nameOf(key), fieldCell(low), fieldCell(high), unitCell(low)), "limits." + key);
}

// Makes the table of the prompts of every lot, which come from lot.toml, not from the recipe.
function lotPrompts() {
  const table = make("table", undefined, "list sheet"), body = make("tbody");
  table.append(make("caption", word("r-prompts_of_lots") + bracketed("lot.toml")), body);
  const request = (it) => (language === "zh" ? it.text_zh : it.text_en);
  body.append(...recipe.prompts_of_lots.map((it) => row(choiceText(it.when), request(it) + " — " + it.choices.map(request).join(" / "))));
  return table;
}

function recipeTables() {
  const filled = RECIPE_SECTIONS.filter((section) => recipe.fields.some((it) => recipeSection(it.path) === section));
  return [...filled.map(fieldTable), ...(recipe.prompts_of_lots.length ? [lotPrompts()] : [])];
}

function fieldTable(section) {
  const table = make("table", undefined, "list sheet " + section), body = make("tbody");
  table.append(make("caption", word("r-" + section)), body);
  const fields = recipe.fields.filter((it) => recipeSection(it.path) === section);
  if (section !== "limits") {
    body.append(...fields.flatMap(fieldRow));
    return table;
  }
  const ofKey = (key) => fields.filter((it) => it.path.startsWith("limits." + key + "."));
  body.append(...keysOf((key) => ofKey(key).length).flatMap((key) => limitRow(key, ofKey(key))));
  const head = make("thead"), heads = ["quantity", "r-low", "r-high", "unit"].map((it) => make("th", word(it)));
  heads.forEach((it) => { it.scope = "col"; });
  head.append(make("tr"));
  head.firstElementChild.append(...heads);
  body.before(head);
  return table;
}
