// The page of alarms: the active ones with their help, and the past ones.

const said = (alarm, what) => alarm[what + (language === "zh" ? "_zh" : "_en")];
const matches = (alarm) => {
  const text = at("alarm_search").value.trim().toLowerCase();
  return [alarm.code, alarm.text, alarm.text_en, alarm.text_zh, alarm.cause_zh].some((it) => it && it.toLowerCase().includes(text));
};

// One that stands, with why, what follows and what to do; the buttons stay while the text changes.
function standing(alarm) {
  const item = make("li", undefined, alarm.state);
  item.dataset.code = alarm.code;
  const head = make("div", undefined, "head"), help = make("dl");
  head.append(make("b", (alarm.first_out ? "▲ " : "△ ") + alarm.code), make("span", said(alarm, "text")));
  said(alarm, "help").forEach((text, place) => {
    const pair = make("div");
    pair.append(make("dt", word(["alarms-cause", "alarms-consequence", "alarms-action"][place])), make("dd", text || NONE));
    help.append(pair);
  });
  const state = [known("alarms-state-" + alarm.state, alarm.state), known("alarms-stops-" + alarm.stops, alarm.stops),
    alarm.count + " ×", clock(alarm.raised_at_us)];
  if (alarm.shelved) state.push(word("alarms-shelved"));
  if (alarm.first_out) state.push(word("first_out"));
  const buttons = make("div", undefined, "row");
  buttons.append(button(word("order-acknowledge"), () => tell({order: "acknowledge", alarm: alarm.code}), "acknowledge"),
    button(word("order-shelve"), () => askShelve(alarm.code), "shelve"));
  item.append(head, make("p", state.join(" · "), "about"), help, buttons);
  return item;
}

async function tell(order) {
  const why = me === null ? word("stop-login") : await give(order);
  at("alarm_answer").textContent = why || word("order-" + order.order) + ": " + word("order-taken");
}

function askShelve(code) {
  at("shelve").dataset.code = code;
  at("shelve_code").textContent = code;
  at("shelve").showModal();
}

at("shelve_cancel").addEventListener("click", () => at("shelve").close());
at("shelve").addEventListener("submit", (event) => {
  event.preventDefault();
  at("shelve").close();
  const minutes = Number(at("shelve_minutes").value);
  tell({order: "shelve", alarm: at("shelve").dataset.code, minutes, reason: at("shelve_reason").value});
});
at("acknowledge_all").addEventListener("click", () => tell({order: "acknowledge"}));
at("alarm_search").addEventListener("input", () => { drawnAlarms = ""; showView(); showPast(); });

// --- those that stand ---

let drawnAlarms = "";

function showStanding() {
  const shown = view.alarms.filter(matches);
  const now = JSON.stringify([shown, language]);
  if (now === drawnAlarms) return;
  drawnAlarms = now;
  at("standing").replaceChildren(...(shown.length ? shown.map(standing) : [make("li", word("no_alarm"))]));
}

// --- those that were ---

let past = [];

async function readPast() {
  const members = {since: moment(at("alarm_since").value), limit: 500};
  at("alarm_print").href = "/api/history/report/alarms" + query({since: members.since, lang: language});
  try {
    past = (await (await ask("/api/history/alarms" + query(members))).json()).reverse();
    at("alarm_trouble").textContent = "";
  } catch (error) {
    at("alarm_trouble").textContent = error.message;
  }
  showPast();
}

// Rows of before have their text in English only: beside it the cause that the catalogue has for the code.
function pastText(it) {
  const text = make("span", (language === "zh" && (it.text_zh || it.cause_zh)) || it.text);
  text.title = it.text;
  return text;
}

function showPast() {
  at("past").replaceChildren(...past.filter(matches).map((it) =>
    row(clock(it.raised), clock(it.cleared), it.lot || NONE, it.code, pastText(it))));
}

at("alarm_since").addEventListener("change", readPast);

PAGES.alarms = {show: showStanding, enter() { drawnAlarms = ""; readPast(); }};
