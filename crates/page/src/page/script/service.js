// For service: health of the lines, every signal, jogging.

const shareText = (bad, all) => (all ? (100 * bad / all).toFixed(3) + "\u202f%" : NONE);

const msText = (ms) => (ms === null ? NONE : ms.toFixed(2));

// Shows the SCPI instruments; a rig without them shows no table.
function showInstruments() {
  at("instruments_shown").hidden = !view.instruments.length;
  at("instruments").replaceChildren(...view.instruments.map((it) => {
    const failures = Object.entries(it.failures);
    const text = failures.map(([code, count]) => wordOr("failure-" + code, code) + " " + integerText(count)).join(comma());
    const element = row(it.name, it.profile, it.link, it.identity ?? NONE, integerText(it.programs), msText(it.p50_ms), msText(it.p99_ms), text);
    if (failures.length) element.className = "bad";
    return element;
  }));
}

function showBus() {
  at("bus").replaceChildren(...view.lines.flatMap((line) => line.modules.map((it) => {
    const bad = it.time_outs + it.checksum_errors + it.other_errors;
    const element = row(wordOr("line-" + line.name, line.name), it.address, integerText(it.transactions), msText(it.p50_ms),
      msText(it.p99_ms), integerText(it.time_outs), integerText(it.checksum_errors),
      integerText(it.other_errors), integerText(it.refusals), integerText(it.resets), shareText(bad, it.transactions));
    if (bad * 1000 > it.transactions) element.className = "bad";
    return element;
  })));
  const {bound_ms: bound, accepted_ms: accepted, worst_age_ms: age} = view.machine.reaction;
  at("reaction").textContent = [word("bus-bound") + " " + bound.toFixed(0) + " ms", word("bus-accepted") + " " +
    accepted.toFixed(0) + " ms", word("bus-age") + " " + age.toFixed(0) + " ms"].join(" · ");
}

// Shows what the system grants the program, and a histogram of how late this computer wakes the cycle.
function showHost() {
  const {fifo_priority: priority, memory_locked: locked, refused, lateness} = view.host;
  // The reason that the system gives for a refusal is English.
  const missing = language === "zh" ? [priority === null ? word("host-no_priority") : "", locked ? "" : word("host-not_locked")]
    : refused.map((it) => word("host-refused") + " " + it);
  const rights = [priority === null ? "" : "SCHED_FIFO " + priority, locked ? word("host-locked") : "",
    ...(refused.length ? missing : [])].filter(Boolean);
  const ms = (key, value) => word(key) + " " + value.toFixed(2) + " ms";
  const figures = lateness.waits ? [ms("host-p50", lateness.p50_ms), ms("host-p999", lateness.p999_ms),
    ms("host-worst", lateness.worst_ms), ms("host-recent", lateness.recent_ms)] : [word("host-virtual")];
  at("host").textContent = [...rights, ...figures].join(" · ");
  at("lateness").replaceChildren(...lateness.buckets.filter((it) => it.count).map((it) => {
    const bar = make("meter");
    // A logarithmic scale, because the few late waits matter most.
    bar.max = Math.log10(1 + lateness.waits);
    bar.value = Math.log10(1 + it.count);
    const element = row(it.up_to_ms.toFixed(3), integerText(it.count), shareText(it.count, lateness.waits));
    element.lastElementChild.prepend(bar, " ");
    return element;
  }));
}

// Shows what each database of the fleet lacks; a rig without a database shows no table.
function showFleet() {
  at("fleet_shown").hidden = !view.fleet.length;
  at("fleet").replaceChildren(...view.fleet.map((it) => {
    // The error that a database reports is English.
    const element = row(it.url, integerText(it.lag_parts), integerText(Math.round(it.lag_s)), integerText(it.sent_parts), it.last_error ?? NONE);
    if (it.late || it.last_error) element.className = "bad";
    return element;
  }));
}

PAGES.bus = {show: () => {
  showBus();
  showInstruments();
  showFleet();
  showHost();
}};

// --- signals and motions ---

const JOGS = ["escapement_release", "escapement_hold", "pusher_extend", "pusher_retract", "clamp_close", "clamp_open",
  "probes_up", "probes_down", "sort_down", "sort_up", "gripper_close", "gripper_open", "axis_nest", "axis_park", "axis_retest"];
const MODES = ["production", "maintenance", "manual"];

function makeJogs() {
  const answer = (text) => { at("io_answer").textContent = text; };
  at("modes").replaceChildren(...MODES.map((mode) => orderButton("mode", mode, {order: "mode", mode}, "", answer)),
    orderButton("step", "", {order: "step"}, "", answer), orderButton("lamp_test", "", {order: "lamp_test"}, "", answer));
  at("jogs").replaceChildren(...JOGS.map((motion) => {
    const item = make("li");
    item.append(orderButton("jog", motion, {order: "jog", motion}, "", answer), make("span", "", "clearance"));
    item.dataset.motion = motion;
    return item;
  }));
}

// Shows in advance how the guard decides on a jog; for a refused jog, the two bodies that would collide, with details as
// tooltip.
function showClearance(item, jog) {
  const text = !jog ? "" : jog.refused ? bodiesText(jog.refused)
    : word("io-clearance") + " " + (jog.clearance_mm === null ? word("io-far") : jog.clearance_mm.toFixed(2) + " mm");
  item.lastElementChild.textContent = text;
  item.lastElementChild.title = jog && jog.refused ? refusedText(jog.refused) : text;
  item.classList.toggle("blocked", Boolean(jog && jog.refused));
}

function signal(name, on) {
  const item = make("li", undefined, on === null ? "unknown" : on ? "on" : "off");
  item.append(make("i", undefined, "mark"), make("span", wordOr("signal-" + name, name)),
    make("b", on === null ? "?" : on ? "1" : "0"));
  item.title = name;
  return item;
}

let drawnSignals = "";

function showIo() {
  const now = JSON.stringify([view.machine.inputs, view.machine.outputs, language]);
  if (now !== drawnSignals) {
    drawnSignals = now;
    at("inputs").replaceChildren(...Object.entries(view.machine.inputs).map(([name, on]) => signal(name, on)));
    at("outputs").replaceChildren(...Object.entries(view.machine.outputs).map(([name, on]) => signal(name, on)));
  }
  const labels = {mode: (it) => word("mode-" + it), jog: (it) => word("motion-" + it)};
  const label = (order, withWhat) => (labels[order] ? labels[order](withWhat) : word("order-" + order));
  showButtons(at("modes"), label);
  showButtons(at("jogs"), label);
  for (const item of at("jogs").children) showClearance(item, view.machine.jogs.find((it) => it.motion === item.dataset.motion));
  for (const element of at("modes").children) element.classList.toggle("now", element.dataset.with === view.machine.mode);
  const {wear, probe_contact_ohm: contact} = view.machine;
  at("wear").replaceChildren(...Object.entries(wear).map(([name, count]) => row(wordOr("actuator-" + name, wordOr("counter-" + name, name)), integerText(count))),
    row(word("io-probe_contact"), contact === null ? NONE : contact.toFixed(2) + "\u202fΩ"));
}

// Shows at the link to plans for tooling how far the plan under way is.
async function showTooling() {
  at("to_tooling").textContent = word("page-tooling");
  const reply = await fetch("/api/plans/list?limit=1").catch(() => null);
  // A rig that never ran has no history.
  const [plan] = reply?.ok ? await reply.json() : [];
  if (plan && !plan.end) at("to_tooling").textContent += " \u00b7 " + word("tooling-under_way") + " " + plan.done + " / " + plan.steps;
}

makeJogs();
PAGES.io = {show: showIo, enter: showTooling};
