// Shows which verdicts of a lot would change under another recipe.

let judgedAgain = null;
// Name of the last recipe of each lot, by lot.
let judgedBy = new Map();

async function enterRejudge() {
  showRejudged();
  const asked = new URLSearchParams(location.hash.split("?")[1]);
  try {
    const [lots, recipes] = await Promise.all([readLots(), ask("/api/recipes").then((it) => it.json())]);
    judgedBy = new Map(lots.map((it) => [it.lot, it.recipe]));
    fillSelect(at("j_lot"), [...judgedBy.keys()].reverse().map((it) => [it, it]));
    fillSelect(at("j_recipe"), recipes.map((it) => [it.name, it.name]));
  } catch (error) {
    at("j_trouble").textContent = error.message;
  }
  if (asked.get("lot") && judgedAgain === null) at("j_lot").value = asked.get("lot");
  if (judgedAgain === null) proposeRecipe();
  showRejudged();
}

// Selects the lot's own recipe, whose newest revision is the likely choice.
const proposeRecipe = () => {
  const own = judgedBy.get(at("j_lot").value);
  if (Array.from(at("j_recipe").options).some((it) => it.value === own)) at("j_recipe").value = own;
};

async function rejudge() {
  const isNewest = newest(rejudge);
  at("j_trouble").textContent = "";
  judgedAgain = null;
  try {
    const members = {lot: at("j_lot").value, recipe: at("j_recipe").value, changed: true};
    const found = await (await ask("api/history/rejudge" + query(members))).json();
    if (!isNewest()) return;
    judgedAgain = found;
  } catch (error) {
    if (!isNewest()) return;
    at("j_trouble").textContent = error.message;
  }
  showRejudged();
}

const MOST_ROWS = 500;

function showRejudged() {
  const parts = judgedAgain ? judgedAgain.slice(0, -1) : [], {changes} = judgedAgain ? judgedAgain.at(-1) : {changes: []};
  at("j_changes").replaceChildren(...changes.map(({was, now, parts: count}) => {
    const pair = make("div");
    pair.append(make("dt", wordOr("verdict-" + was, was) + " → " + wordOr("verdict-" + now, now)), make("dd", integerText(count)));
    return pair;
  }));
  at("j_more").textContent = parts.length > MOST_ROWS ? word("j-first") + " " + MOST_ROWS
    : judgedAgain && parts.length === 0 ? word("j-none") : "";
  at("j_parts").replaceChildren(...parts.slice(0, MOST_ROWS).map((it) => row(partLink({...it, kind: "lot"}),
    verdictCell(it.verdict_was), verdictCell(it.verdict), wordOr("bin-" + it.bin, it.bin), reasonTexts(it).join(semicolon()))));
}

at("j_form").addEventListener("submit", (event) => {
  event.preventDefault();
  rejudge();
});
at("j_lot").addEventListener("change", () => { judgedAgain = null; proposeRecipe(); showRejudged(); });
at("j_recipe").addEventListener("change", () => { judgedAgain = null; showRejudged(); });

PAGES.rejudge = {enter: enterRejudge};
