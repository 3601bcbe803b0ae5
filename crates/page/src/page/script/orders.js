// Orders to the rig, and their buttons.

// Stop is last and apart, so that no finger hits it by mistake.
const ORDERS = ["reset", "start", "hold", "unhold", "abort", "clear", "stop"];

// Sends an order; returns `why`, the reason of a refusal or empty, and `said`, the words for an accepted order.
async function sendOrder(order) {
  try {
    const reply = await post("/api/orders", order);
    const body = await reply.json();
    if (reply.ok) return {why: "", said: body.remark ? body.remark[language] : word(order.order === "jog" ? "order-done" : "order-taken")};
    return {why: said(body, "reason")};
  } catch {
    return {why: word("stop-lost")};
  }
}

// Sends an order if a person is logged in; passes the answer or refusal to `show`; returns true when the rig accepts.
async function giveOrder(order, show) {
  const {why, said: outcome} = me === null ? {why: word("stop-login")} : await sendOrder(order);
  show(why || word("order-" + order.order) + colon() + outcome);
  return why === "";
}

function whyNot(order, withWhat = "") {
  const buttons = view && view.machine ? view.machine.buttons : [];
  const found = buttons.find((it) => it.order === order && it.with === withWhat);
  if (linkNow() === "ended" || !found) return word("stop-ended");
  if (me === null) return word("stop-login");
  if (found.enabled) return "";
  return language === "zh" ? found.why_zh : found.why_en;
}

// Makes the button of an order. While the rig would refuse the order, the button looks disabled and a press shows why.
function orderButton(order, withWhat, body, name, answer) {
  const element = button("", async () => {
    const {title, textContent: label} = element;
    const {why, said: outcome} = title ? {why: title} : await sendOrder(body);
    answer(why || label + colon() + outcome);
  }, name);
  element.dataset.order = order;
  element.dataset.with = withWhat;
  return element;
}

function showButtons(within, label) {
  for (const element of within.querySelectorAll("[data-order]")) {
    const {order, with: withWhat} = element.dataset;
    const why = whyNot(order, withWhat);
    element.textContent = label(order, withWhat);
    element.setAttribute("aria-disabled", why !== "");
    element.title = why;
  }
}

// Makes the buttons once: replacing a button between press and release would lose the click.
function makeOrders() {
  const made = (order, id) => orderButton(order, "", {order}, order === "stop" ? "stop" : "", (text) => { at(id).textContent = text; });
  at("orders").replaceChildren(...ORDERS.map((order) => made(order, "order_answer")));
  // A narrow screen has Stop below every page.
  at("stop_bar").replaceChildren(made("stop", "stop_answer"));
}

function showOrders() {
  for (const id of ["orders", "stop_bar"]) showButtons(at(id), (order) => word("order-" + order));
}

// --- audit ---

// Writes an order with lot, recipe and count first, then its other members; leaves out the hashes of recipes.
function orderedText(what) {
  const {order, change, name, role, lot, recipe, count, hash, from, ...others} = what;
  const named = change ? [wordOr("people-" + (change === "role" ? "change_role" : change), change), name, role && wordOr("role-" + role, role)] : [];
  const members = [...named, lot, recipe, count, ...Object.values(others)].filter((it) => ["string", "number"].includes(typeof it));
  return [wordOr("order-" + order, order), ...members.filter((it) => it !== "")].join(" · ");
}

const whoText = ({who, role}) => (who || NONE) + (role ? " (" + wordOr("role-" + role, role) + ")" : "");
const outcomeText = (it) => (language === "zh" && it.refused_zh) || it.refused || word("order-taken");
