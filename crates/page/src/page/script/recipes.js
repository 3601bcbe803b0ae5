// Recipes: shows revisions and saves the next one.

function drawRecipe() {
  at("r_fields").replaceChildren(...(recipe ? RECIPE_SECTIONS : []).map((sections) => {
    const column = make("div");
    column.append(...sections.map(fieldTable));
    return column;
  }));
  at("r_save").hidden = at("r_discard").hidden = !mayRevise();
  at("r_note").hidden = mayRevise();
  at("r_kept").hidden = !recipe || recipe.kept;
  const numbers = recipe ? Array.from({length: recipe.newest}, (_, place) => String(recipe.newest - place)) : [];
  fillSelect(at("r_revision"), numbers.map((it, place) => [it, place === 0 ? it + " (" + word("r-newest") + ")" : it]));
  if (recipe) at("r_revision").value = String(recipe.number);
  at("r_saved").textContent = recipe && recipe.saved_at_us ? word("r-saved_at") + " " + clock(recipe.saved_at_us) : "";
  at("r_card").href = "/api/recipes/card" + query({name: at("r_name").value, lang: language});
  const [text, bad] = recipeMessage();
  at("r_answer").textContent = text;
  at("r_answer").className = bad ? "trouble" : "";
  const refused = at("r_fields").querySelector(".trouble");
  if (refused) refused.scrollIntoView({block: "center"});
}

function showRecipe() {
  const now = JSON.stringify([recipe && recipe.hash, recipe && recipe.number, language, mayRevise(), refusedField, recipeMessage()]);
  if (now === drawnRecipe) return;
  drawnRecipe = now;
  drawRecipe();
}

// --- reading and saving ---

async function readRecipe(revision = "") {
  typed.clear();
  [refusedField, drawnRecipe, recipeMessage] = [null, "", () => ["", false]];
  try {
    recipe = await (await ask("/api/recipes/show" + query({name: at("r_name").value, revision}))).json();
  } catch (error) {
    recipe = null;
    recipeMessage = () => [error.message, true];
  }
  showRecipe();
}

async function enterRecipes() {
  const first = at("r_name").value === "";
  let all;
  try {
    all = await (await ask("/api/recipes")).json();
  } catch (error) {
    recipeMessage = () => [error.message, true];
    return showRecipe();
  }
  fillSelect(at("r_name"), all.map((it) => [it.name, it.name + (it.trouble ? " ▲" : "")]));
  if (first && view && all.some((it) => it.name === view.recipe)) at("r_name").value = view.recipe;
  // Typed text survives a change of language or page.
  if (recipe === null || typed.size === 0) await readRecipe();
  showRecipe();
}

// Writes found and expected in the language of the page; expected stays English where the page has no words for it.
function refusedValue(answer) {
  const field = recipe.fields.find((it) => (answer.key + ".").startsWith(it.path + "."));
  const {code, value} = answer.requirement;
  const ranged = code === "form" && field && field.low !== undefined;
  const expected = code === "at_most_high" ? word("r-at_most_high") + " " + value : code === "below" ? "< " + value
    : ranged ? word(field.form === "whole" ? "r-whole" : "r-number") + ", " + rangeText(field) + " " + unitText(field.unit)
      : answer.expected;
  return "▲ " + word("r-found") + " " + answer.found + word("r-expected") + " " + expected;
}

const refusal = (answer) => () => [answer.key ? word("r-refused") : whyRefused(answer), true];

async function saveRecipe() {
  const values = changedValues();
  if (!mayRevise() || Object.keys(values).length === 0) return () => [word("r-nothing"), false];
  try {
    const reply = await post("/api/recipes/revise", {name: recipe.name, from: recipe.hash, values});
    const answer = await reply.json();
    if (reply.ok) {
      await readRecipe();
      return () => [word("r-saved") + " " + answer.number + ". " + word("r-applies"), false];
    }
    if (answer.key) refusedField = answer;
    return refusal(answer);
  } catch {
    return () => [word("stop-lost"), true];
  }
}

at("r_fields").addEventListener("submit", async (event) => {
  event.preventDefault();
  refusedField = null;
  recipeMessage = await saveRecipe();
  showRecipe();
});
at("r_discard").addEventListener("click", () => readRecipe());
at("r_name").addEventListener("change", () => readRecipe());
at("r_revision").addEventListener("change", () => readRecipe(at("r_revision").value));

PAGES.recipes = {show: showRecipe, enter: enterRecipes};
