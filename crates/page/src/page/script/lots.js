// Lots: starts, holds, releases, closes and reopens them; wear counters; audit of orders.

const DECISIONS = ["hold_lot", "release_lot", "close_lot", "reopen_lot"];
const WITH_REASON = ["hold_lot", "reopen_lot"];
const BOOK = 20;
const AUDIT = 50;
let book = [];
let skipped = 0;
// Lot and state at the time of the last read; when they change, the page reads the lots again.
let readFor = "";

const underWay = (lot) => view && view.under_way && view.lot === lot;

function lotAnswer(text) {
  at("l_answer").textContent = text;
}

async function orderLot(order) {
  if (await giveOrder(order, lotAnswer)) readBook();
}

// Returns why the machine or the lot forbids an order about the lot; empty when neither does.
function whyNotLot(order, line) {
  if (order === "reopen_lot" && underWay(line.lot)) return line.why_not[order]?.[language] ?? "";
  if (order === "release_lot" && underWay(line.lot)) return word("lots-clear_alarm");
  if (underWay(line.lot)) return order === "close_lot" ? whyNot("close_lot") : whyNot("start", "lot");
  if (me === null) return word("stop-login");
  const why = line.why_not[order];
  return why ? why[language] : order === "start" ? whyNot("start", "lot") : "";
}

// --- the form ---

async function readRecipes() {
  try {
    const recipes = await (await ask("/api/recipes")).json();
    const usable = recipes.filter((it) => !it.trouble).map((it) => [it.name, it.name + (it.approved ? "" : bracketed(word("r-not_approved")))]);
    fillSelect(at("l_recipe"), [["", NONE], ...usable]);
  } catch (error) {
    lotAnswer(error.message);
  }
}

// Fills the form with a lot and its recipe.
function choose(line) {
  at("l_lot").value = line.lot;
  at("l_recipe").value = line.recipe;
  at("l_count").focus();
}

at("l_form").addEventListener("submit", (event) => {
  event.preventDefault();
  const count = at("l_count").value, retest = at("l_retest").value.trim();
  const why = me === null ? word("stop-login") : whyNot("start", "lot");
  if (why) { lotAnswer(why); return; }
  const order = {order: "start", lot: at("l_lot").value.trim(), recipe: at("l_recipe").value};
  if (count) order.count = Number(count);
  if (retest) order.retest = retest;
  orderLot(order);
});

// --- the list of lots ---

function lotRow(line) {
  const state = make("span", word("lot_state-" + line.state), "lot_state " + line.state);
  if (line.why) state.append(make("small", said(line, "why")));
  if (line.cause && !underWay(line.lot)) state.append(make("small", line.cause + colon() + said(line, "cause_text")));
  if (line.external) state.append(make("small", externalText(line.external), line.external.acceptable ? "" : "trouble"));
  for (const it of line.reopenings) state.append(make("small", word("lots-reopened") + colon() + it.why + bracketed(it.who)));
  const orders = make("div", undefined, "row");
  orders.append(lotButton("start", line, () => choose(line)),
    ...DECISIONS.map((order) => lotButton(order, line, () => askDecision(order, line.lot))));
  if (line.external) orders.append(button(word("x-open"), () => openExternal(line.lot)));
  const final = line.first_pass + line.retest_pass;
  const passed = share(line.first_pass, line.parts) + (line.retest_pass ? bracketed(share(final, line.parts)) : "");
  return row(make("b", line.lot), state, line.recipe, clock(line.opened), integerText(line.runs), integerText(line.parts), passed,
    integerText(line.suspect), orders);
}

function lotButton(order, line, press) {
  const element = button("", () => { element.title ? lotAnswer(element.title) : press(); });
  element.dataset.lotOrder = order;
  element.textContent = word(order === "start" ? "lots-choose" : "order-" + order);
  element.line = line;
  return element;
}

function showLotButtons() {
  for (const element of document.querySelectorAll("[data-lot-order]")) {
    const why = whyNotLot(element.dataset.lotOrder, element.line);
    element.setAttribute("aria-disabled", why !== "");
    element.title = why;
  }
  const why = whyNot("start", "lot");
  at("l_start").setAttribute("aria-disabled", why !== "");
  at("l_start").title = why;
}

function showBook() {
  at("l_book").replaceChildren(...book.map(lotRow));
  if (!book.length) at("l_book").append(row(word("lots-none")));
  at("l_newer").hidden = skipped === 0;
  at("l_older").hidden = book.length < BOOK;
  showLotButtons();
}

async function readBook() {
  const isNewest = newest(readBook);
  try {
    const found = await (await ask("/api/lots" + query({limit: BOOK, offset: skipped}))).json();
    if (!isNewest()) return;
    book = found;
    showBook();
    showWear(await (await ask("/api/wear")).json());
    showAudit(await (await ask("api/history/orders" + query({since: dayAgo()}))).json());
  } catch (error) {
    if (isNewest()) lotAnswer(error.message);
  }
}

at("l_newer").addEventListener("click", () => { skipped = Math.max(0, skipped - BOOK); readBook(); });
at("l_older").addEventListener("click", () => { skipped += BOOK; readBook(); });

// --- decisions ---

function askDecision(order, lot) {
  at("decide").dataset.order = order;
  at("decide").dataset.lot = lot;
  at("decide_order").textContent = word("order-" + order);
  at("decide_lot").textContent = lot;
  at("decide_about").textContent = word("lots-about-" + order);
  at("decide_go").textContent = word("order-" + order);
  at("decide_reason").value = "";
  at("decide_reason").required = WITH_REASON.includes(order);
  at("decide").showModal();
}

at("decide_cancel").addEventListener("click", () => at("decide").close());
at("decide").addEventListener("submit", (event) => {
  event.preventDefault();
  at("decide").close();
  const {order, lot} = at("decide").dataset;
  orderLot({order, lot, reason: at("decide_reason").value.trim()});
});

// --- results from outside of the rig ---

function showExternal({standing, results}) {
  at("x_standing").textContent = externalText(standing);
  at("x_standing").className = standing.acceptable ? "" : "trouble";
  at("x_results").replaceChildren(...results.map(externalRow));
}

async function openExternal(lot) {
  at("external").dataset.lot = at("x_lot").textContent = lot;
  at("x_answer").textContent = "";
  fillSelect(at("x_key"), EXTERNAL.map((it) => [it.key, it[language] + " / " + unitText(it.unit)]));
  try {
    showExternal(await (await ask("api/history/external" + query({lot}))).json());
    at("external").showModal();
  } catch (error) {
    lotAnswer(error.message);
  }
}

at("x_close").addEventListener("click", () => at("external").close());
at("x_form").addEventListener("submit", async (event) => {
  event.preventDefault();
  const typed = {lot: at("external").dataset.lot, key: at("x_key").value, value: Number(at("x_value").value)};
  if (at("x_u").value) typed.u = Number(at("x_u").value);
  if (at("x_serial").value.trim()) typed.serial = at("x_serial").value.trim();
  if (at("x_seq").value) typed.seq = Number(at("x_seq").value);
  try {
    const reply = await post("/api/lots/external", typed), body = await reply.json();
    at("x_answer").textContent = reply.ok ? word("x-entered") : said(body, "reason");
    if (!reply.ok) return;
    showExternal(body);
    readBook();
  } catch {
    at("x_answer").textContent = word("stop-lost");
  }
});

// --- wear counters and audit ---

function showWear(counters) {
  at("l_wear").replaceChildren(...counters.map((it) => {
    const item = make("li"), replaced = it.replaced ? clock(it.replaced) + " · " + it.replaced_by : NONE;
    item.append(make("span", wordOr("counter-" + it.name, it.name)), make("b", integerText(it.count)),
      make("span", word("lots-replaced_at") + colon() + replaced),
      button(word("order-replaced"), () => orderLot({order: "replaced", counter: it.name})));
    return item;
  }));
}

// Start of the audit shown: 24 hours ago, which covers this shift and the one before.
const dayAgo = () => new Date(Date.now() - 24 * 3600 * 1000).toISOString();

function showAudit(orders) {
  const last = orders.slice(-AUDIT).reverse();
  at("l_audit").replaceChildren(...last.map((it) =>
    row(clock(it.at), it.lot || NONE, whoText(it), orderedText(it.what), outcomeText(it))));
}

function showLots() {
  const now = JSON.stringify([view.lot, view.under_way, view.machine.state]);
  if (now !== readFor) {
    readFor = now;
    readBook();
  }
  showLotButtons();
}

PAGES.lots = {show: showLots, enter() { readFor = ""; at("l_count").placeholder = word("endless"); readRecipes(); }};
