// The page of alarms: the active ones with their help, and the past ones.

const inLanguage = (alarm, what) => alarm[what + (language === "zh" ? "_zh" : "_en")];
const matches = (alarm) => {
  const text = at("alarm_search").value.trim().toLowerCase();
  return [alarm.code, alarm.text, alarm.text_en, alarm.text_zh, alarm.cause_zh].some((it) => it && it.toLowerCase().includes(text));
};

// Makes the entry of an active alarm with cause, consequence, action and buttons.
function standing(alarm) {
  const item = make("li", undefined, alarm.state);
  item.dataset.code = alarm.code;
  const head = make("div", undefined, "head"), help = make("dl");
  head.append(make("b", (alarm.first_out ? "▲ " : "△ ") + alarm.code), make("span", inLanguage(alarm, "text")));
  inLanguage(alarm, "help").forEach((text, place) => {
    const pair = make("div");
    const name = word(["alarms-cause", "alarms-consequence", "alarms-action"][place]);
    pair.append(make("dt", name), showMarked(make("dd"), text || NONE));
    help.append(pair);
  });
  const state = [wordOr("alarms-state-" + alarm.state, alarm.state), wordOr("alarms-stops-" + alarm.stops, alarm.stops),
    alarm.count + " ×", clock(alarm.raised_at_us)];
  if (alarm.shelved) state.push(word("alarms-shelved"));
  if (alarm.first_out) state.push(word("first_out"));
  const buttons = make("div", undefined, "row");
  buttons.append(button(word("order-acknowledge"), () => giveAlarmOrder({order: "acknowledge", alarm: alarm.code}), "acknowledge"),
    button(word("order-shelve"), () => askShelve(alarm.code), "shelve"));
  item.append(head, make("p", state.join(" · "), "about"), help, buttons);
  return item;
}

const giveAlarmOrder = (order) => giveOrder(order, (text) => { at("alarm_answer").textContent = text; });

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
  giveAlarmOrder({order: "shelve", alarm: at("shelve").dataset.code, minutes, reason: at("shelve_reason").value});
});
at("acknowledge_all").addEventListener("click", () => giveAlarmOrder({order: "acknowledge"}));
at("alarm_search").addEventListener("input", () => { drawnAlarms = ""; showView(); showPast(); });

// --- active alarms ---

let drawnAlarms = "";

function showStanding() {
  const shown = view.alarms.filter(matches);
  const now = JSON.stringify([shown, language]);
  if (now === drawnAlarms) return;
  drawnAlarms = now;
  at("standing").replaceChildren(...(shown.length ? shown.map(standing) : [make("li", word("no_alarm"))]));
}

// --- past alarms ---

let past = [];

async function readPast() {
  const isNewest = newest(readPast), members = {since: rfc3339(at("alarm_since").value), limit: 500};
  at("alarm_print").href = "api/history/report/alarms" + query({since: members.since, lang: language});
  showRanked(members.since);
  try {
    const found = await (await ask("api/history/alarms" + query(members))).json();
    if (!isNewest()) return;
    past = found.reverse();
    at("alarm_trouble").textContent = "";
  } catch (error) {
    if (!isNewest()) return;
    at("alarm_trouble").textContent = error.message;
  }
  showPast();
}

// Lists the most frequent alarms, each with its count and the total time for which it was active.
async function showRanked(since) {
  const ranked = await ask("api/history/alarm-counts" + query({since})).then((it) => it.json(), () => []);
  at("ranked").replaceChildren(...ranked.slice(0, 10).map((it) => {
    const bar = make("meter");
    bar.max = ranked[0].n;
    bar.value = it.n;
    const cells = row(integerText(it.n), (it.active_s / 60).toFixed(1), (100 * it.cumulative).toFixed(0) + "\u202f%", it[language]);
    cells.firstElementChild.prepend(bar, " ");
    return cells;
  }));
}

// Rows of older versions have an English text only; the Chinese page then shows the cause from the catalogue.
function pastText(it) {
  const text = make("span", (language === "zh" && (it.text_zh || it.cause_zh)) || it.text);
  // Hovering shows the whole text, because a narrow column cuts it off.
  text.title = text.textContent;
  return text;
}

function showPast() {
  at("past").replaceChildren(...past.filter(matches).map((it) =>
    row(clock(it.raised), clock(it.cleared), it.lot || NONE, it.code, pastText(it))));
}

at("alarm_since").addEventListener("change", readPast);

PAGES.alarms = {show: showStanding, enter() { drawnAlarms = ""; readPast(); }};
