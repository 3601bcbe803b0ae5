// Recipes: shows revisions; saves the next one or a new recipe; approves.

function drawRecipe() {
  at("r_fields").replaceChildren(...(recipe ? recipeTables() : []));
  for (const id of ["r_why", "r_save", "r_save_as", "r_discard"]) at(id).hidden = !mayRevise();
  showApproval();
  showRevisions();
  at("r_note").hidden = mayRevise();
  at("r_kept").hidden = !recipe || recipe.kept;
  const numbers = recipe ? Array.from({length: recipe.newest}, (_, place) => String(recipe.newest - place)) : [];
  fillSelect(at("r_revision"), numbers.map((it, place) => [it, place === 0 ? it + bracketed(word("r-newest")) : it]));
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
  const now = JSON.stringify([recipe && [recipe.hash, recipe.number, recipe.approval], language, me, mayRevise(), refusedField, recipeMessage()]);
  if (now === drawnRecipe) return;
  drawnRecipe = now;
  drawRecipe();
}

// Shows the engineers who saved or approved the revision; only an engineer who has done neither may approve it.
function showApproval() {
  const {approved, signatures} = recipe?.approval ?? {approved: true, signatures: []};
  const names = signatures.map((it) => it.who + " " + clock(it.at)).join(comma());
  at("r_approval").textContent = !approved ? word(names ? "r-waits" : "r-unsigned") + " " + names
    : names ? word("r-approved") + " " + names : "";
  at("r_approval").className = approved ? "" : "trouble";
  at("r_approve").hidden = approved || !mayRevise();
  const signed = signatures.some((it) => it.who === me?.name);
  at("r_approve").setAttribute("aria-disabled", signed);
  at("r_approve").title = signed ? word("r-signed") : "";
}

// Shows who changed what and why; the lines are those of the command `config revisions`.
function showRevisions() {
  at("r_history").replaceChildren(...revisions.map((it) => {
    const item = make("li"), lines = make("ul");
    const who = it.who + (it.role ? " (" + wordOr("role-" + it.role, it.role) + ")" : "");
    lines.append(...it.lines.map((line) => make("li", line)));
    item.value = it.revision;
    item.append(clock(it.at) + " · " + who + " · " + (it.reason || NONE), lines);
    return item;
  }));
}

// --- reading and saving ---

// Returns the message of a failed read; the next read replaces the message.
const failedRead = (error) => Object.assign(() => [error.message, true], {ofRead: true});

async function readRecipe(revision = "") {
  const isNewest = newest(readRecipe), name = at("r_name").value;
  typed.clear();
  let found = null, lines = [], message = NO_MESSAGE;
  try {
    [found, lines] = await Promise.all([
      ask("/api/recipes/show" + query({name, revision})).then((it) => it.json()),
      // Without a history there are no revisions yet.
      ask("/api/recipes/revisions" + query({name})).then((it) => it.json()).catch(() => [])]);
  } catch (error) {
    message = failedRead(error);
  }
  if (!isNewest()) return;
  // The answer to an order stays when a change of language or page reads the same text again.
  if (found === null || found.hash !== recipe?.hash || recipeMessage.ofRead) [refusedField, recipeMessage] = [null, message];
  [recipe, revisions, drawnRecipe] = [found, lines, ""];
  showRecipe();
}

// Returns the number of the earlier revision that the page shows, "" for the newest one.
const earlierRevision = () => (Number(at("r_revision").value) < (recipe?.newest ?? 0) ? at("r_revision").value : "");

async function enterRecipes(chosen = "") {
  const first = at("r_name").value === "";
  let all;
  try {
    all = await (await ask("/api/recipes")).json();
  } catch (error) {
    recipeMessage = failedRead(error);
    return showRecipe();
  }
  fillSelect(at("r_name"), all.map((it) => [it.name, it.name + (it.trouble ? " ▲" : it.approved ? "" : bracketed(word("r-not_approved")))]));
  if (chosen) at("r_name").value = chosen;
  if (first && view && all.some((it) => it.name === view.recipe)) at("r_name").value = view.recipe;
  // Typed text and an earlier revision survive a change of language or page.
  if (recipe === null || typed.size === 0) await readRecipe(chosen ? "" : earlierRevision());
  showRecipe();
}

// Writes found and expected values in the language of the page. For a requirement without words of its own, an English
// page shows the text of the rig, a Chinese page a general text.
function refusedValue(answer) {
  const field = recipe.fields.find((it) => (answer.key + ".").startsWith(it.path + "."));
  const {code, value} = answer.requirement;
  const ranged = code === "form" && field && field.low !== undefined;
  const expected = code === "at_most_high" ? word("r-at_most_high") + " " + value : code === "below" ? "< " + value
    : ranged ? word(field.form === "whole" ? "r-whole" : "r-number") + comma() + rangeText(field) + " " + unitText(field.unit)
      : language === "zh" ? word("r-other") : answer.expected;
  return "▲ " + word("r-found") + " " + answer.found + word("r-expected") + " " + expected;
}

const refusal = (answer) => () => [answer.key ? word("r-refused") : said(answer, "reason"), true];

// Sends a change; returns the message about its outcome. `saved` makes the message from the answer to an accepted
// change.
async function change(path, body, saved) {
  refusedField = null;
  try {
    const reply = await post("/api/recipes/" + path, body);
    const answer = await reply.json();
    if (reply.ok) {
      typed.clear();
      await enterRecipes(answer.name);
      return () => [saved(answer), false];
    }
    if (answer.key) refusedField = answer;
    return refusal(answer);
  } catch {
    return () => [word("stop-lost"), true];
  }
}

async function revise(reason, members, saved) {
  const values = changedValues();
  recipeMessage = mayRevise() && (members.save_as || Object.keys(values).length)
    ? await change("revise", {name: recipe.name, from: recipe.hash, reason: reason.value.trim(), values, ...members}, saved)
    : () => [word("r-nothing"), false];
  showRecipe();
}

at("r_fields").addEventListener("submit", async (event) => {
  event.preventDefault();
  await revise(at("r_reason"), {}, (answer) => {
    at("r_reason").value = "";
    return word("r-saved") + " " + answer.number + semicolon() + word("r-applies");
  });
});
at("r_save_as").addEventListener("click", () => {
  at("r_new_name").value = recipe.name;
  at("r_new_reason").value = at("r_reason").value;
  at("r_new").showModal();
});
at("r_new_cancel").addEventListener("click", () => at("r_new").close());
at("r_new").addEventListener("submit", async (event) => {
  event.preventDefault();
  at("r_new").close();
  await revise(at("r_new_reason"), {save_as: at("r_new_name").value.trim()}, (answer) => word("r-created") + " " + answer.name);
});
at("r_approve").addEventListener("click", async () => {
  recipeMessage = at("r_approve").title ? () => [word("r-signed"), false]
    : await change("approve", {name: recipe.name, hash: recipe.hash}, (answer) => word(answer.approval?.approved === false ? "r-waits" : "r-approved") + " " + me.name);
  showRecipe();
});
at("r_discard").addEventListener("click", () => {
  [refusedField, recipeMessage] = [null, NO_MESSAGE];
  return readRecipe();
});
at("r_name").addEventListener("change", () => readRecipe());
at("r_revision").addEventListener("change", () => readRecipe(at("r_revision").value));

PAGES.recipes = {show: showRecipe, enter: () => enterRecipes()};
