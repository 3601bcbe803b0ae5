// Orders to the rig, and their buttons.

// Stop is last and apart, so that a finger does not hit another button.
const ORDERS = ["reset", "start", "hold", "unhold", "abort", "clear", "stop"];

// Sends an order; returns the reason of a refusal, empty when the rig took it.
async function sendOrder(order) {
  try {
    const reply = await post("/api/orders", order);
    const body = await reply.json();
    return reply.ok ? "" : (language === "zh" && refusedJog(order)) || whyRefused(body);
  } catch {
    return word("stop-lost");
  }
}

// Sends an order if a person is logged in; passes the answer, or the refusal, to `show`; returns whether the rig took
// it.
async function giveOrder(order, show) {
  const why = me === null ? word("stop-login") : await sendOrder(order);
  show(why || word("order-" + order.order) + ": " + word("order-taken"));
  return why === "";
}

// Returns why the guard refuses a jog, with the page's names of both bodies; empty for any other order.
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

// Makes a button of an order. While the rig would refuse the order it looks disabled, and a press shows the reason.
function orderButton(order, withWhat, body, name, answer) {
  const element = button("", async () => {
    const why = element.title;
    answer(why || await sendOrder(body) || element.textContent + ": " + word("order-taken"));
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
  const answer = (text) => { at("order_answer").textContent = text; };
  at("orders").replaceChildren(...ORDERS.map((order) =>
    orderButton(order, "", {order}, order === "stop" ? "stop" : "", answer)));
}

const showOrders = () => showButtons(at("orders"), (order) => word("order-" + order));
