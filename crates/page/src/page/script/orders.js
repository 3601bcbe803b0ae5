// Orders: to the rig, and the buttons that give them.

// Stop comes last, where no other button is hit by mistake.
const ORDERS = ["reset", "start", "hold", "unhold", "abort", "clear", "stop"];

// The reason why an order was not taken; nothing when it was.
async function give(order) {
  try {
    const reply = await post("/api/orders", order);
    const body = await reply.json();
    return reply.ok ? "" : (language === "zh" && refusedJog(order)) || whyRefused(body);
  } catch {
    return word("stop-lost");
  }
}

// Of a motion that the guard refuses: with the words of the page for both bodies.
function refusedJog({order, motion}) {
  const jog = order === "jog" && view.machine.jogs.find((it) => it.motion === motion);
  return jog && jog.refused && jog.refused.mover ? word("collision") + ": " + refusedText(jog.refused) : "";
}

function whyNot(order, withWhat = "") {
  const buttons = view && view.machine ? view.machine.buttons : [];
  const found = buttons.find((it) => it.order === order && it.with === withWhat);
  if (linkNow() === "ended" || !found) return word("stop-ended");
  if (me === null) return word("stop-login");
  if (found.enabled) return "";
  return language === "zh" ? found.why_zh : found.why_en;
}

// A button that would not be taken looks dead, and says why when it is pressed.
function orderButton(order, withWhat, body, name, answer) {
  const element = button("", async () => {
    const why = element.title;
    answer(why || await give(body) || element.textContent + ": " + word("order-taken"));
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

// Made once: a button that changed under the finger would lose the press.
function makeOrders() {
  const answer = (text) => { at("order_answer").textContent = text; };
  at("orders").replaceChildren(...ORDERS.map((order) =>
    orderButton(order, "", {order}, order === "stop" ? "stop" : "", answer)));
}

const showOrders = () => showButtons(at("orders"), (order) => word("order-" + order));
