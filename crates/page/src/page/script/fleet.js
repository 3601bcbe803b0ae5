// The page of all rigs, or of one: state, yield by shift, reasons, alarms, calibrations and reference parts.

// Plant and name of the rig on the page of one rig; `null` on the page of all rigs.
const ownRig = (() => {
  const path = location.pathname.match(/^\/rigs\/([^/]+)\/([^/]+)\/$/);
  return path && {site: decodeURIComponent(path[1]), rig: decodeURIComponent(path[2])};
})();
const isOwn = (it) => !ownRig || (it.site === ownRig.site && it.rig === ownRig.rig);
const rigName = (it) => it.site + " / " + it.rig;
const rigPath = (it) => "/rigs/" + encodeURIComponent(it.site) + "/" + encodeURIComponent(it.rig) + "/";
// Number of reference parts that the page of all rigs shows; the page of one rig shows all.
const REFERENCES = 20;
// The last answer of `/api/fleet`.
let fleet = null;

// Without this bound a question over all rigs would read months.
bounds.hours = 24;
bounds.lot_days = 7;

const ago = (seconds) => (seconds < 120 ? seconds.toFixed(0) + " s" : seconds < 7200 ? (seconds / 60).toFixed(0) + " min"
  : seconds < 172800 ? (seconds / 3600).toFixed(0) + " h" : (seconds / 86400).toFixed(0) + " d");
const firstPass = (counts) => share(counts.first_pass, counts.parts);

function linkTo(href, text) {
  const link = make("a", text);
  link.href = href;
  return link;
}

// Makes a cell that draws attention.
function marked(text, kind) {
  const cell = make("td", undefined, kind);
  cell.append(make("span", text, "verdict"));
  return cell;
}

// Returns the last shift with parts that has begun.
const lastShift = (day) => day?.shifts.findLast((it) => it.from <= fleet.day.at && it.parts > 0);

function shiftText(shift) {
  return shift ? shift.shift + colon() + integerText(shift.parts) + comma() + firstPass(shift) : NONE;
}

const CONDITIONS = {alarm: "fail", silent: "fail", late: "void", testing: "", idle: ""};

function calibrationCell(rig) {
  const bad = rig.calibrations.some((it) => it.overdue || !it.verified);
  const next = rig.calibrations.map((it) => it.due).sort()[0];
  return marked(next ? clock(next).slice(0, 10) : NONE, bad ? "fail" : "");
}

function contactText(rig) {
  const texts = [rig.silent_s === null ? NONE : ago(rig.silent_s) + " " + word("rigs-ago")];
  if (rig.lag_s !== null) texts.push(word("rigs-lag") + " " + ago(rig.lag_s));
  if (Math.abs(rig.clock_ahead_s) > 60) texts.push(word("rigs-clock") + " " + rig.clock_ahead_s.toFixed(0) + " s");
  return texts.join(semicolon());
}

const alarmText = (alarm) => (language === "zh" && alarm.text_zh) || alarm.text;

function rigRow(rig, day) {
  const run = rig.run;
  const alarms = rig.alarms.map((it) => it.code).join(comma());
  const reasons = (day?.reasons ?? []).slice(0, 2).map((it) => it[language] + bracketed(integerText(it.n)));
  return row(ownRig ? rigName(rig) : linkTo(rigPath(rig), rigName(rig)),
    marked(word("rigs-condition-" + rig.condition), CONDITIONS[rig.condition]),
    run ? linkTo(rigPath(rig) + "#history" + query({lot: run.lot}), run.lot + " / " + run.run + bracketed(run.recipe)) : NONE,
    integerText(rig.parts_per_hour), day ? firstPass(day.counts) + bracketed(integerText(day.counts.parts)) : NONE,
    shiftText(lastShift(day)), reasons.join(semicolon()) || NONE, marked(alarms || NONE, alarms ? "fail" : ""),
    calibrationCell(rig), contactText(rig));
}

function showShifts() {
  const rigs = (fleet.day?.rigs ?? []).filter(isOwn);
  const lines = rigs.flatMap((rig) => rig.shifts.filter((it) => it.parts + it.retest_pass > 0).map((it) => [rig, it]));
  // The newest shift first, rig by rig within a shift.
  lines.sort((one, other) => (one[1].from < other[1].from ? 1 : one[1].from > other[1].from ? -1 : 0));
  at("shifts").replaceChildren(...(lines.length ? lines.map(([rig, it]) => row(rigName(rig), it.day, it.shift,
    integerText(it.parts), firstPass(it), integerText(it.retest_pass))) : [row(showMarked(make("span"), word("rigs-no_shifts")))]));
}

function showReferences() {
  const name = ownRig && ownRig.site + "/" + ownRig.rig;
  const all = (fleet.day?.references ?? []).filter((it) => !ownRig || it.rig === name);
  const size = (it) => (it.shared ? 1e6 : 0) + (it.uncertainty > 0 ? Math.abs(it.last - it.first) / it.uncertainty : 0);
  const shown = all.sort((one, other) => size(other) - size(one)).slice(0, ownRig ? all.length : REFERENCES);
  at("references").replaceChildren(...(shown.length ? shown.map((it) => {
    const [value, uncertainty] = measured(it.last, it.uncertainty);
    const change = measured(it.last - it.first, it.uncertainty)[0] + (it.shared ? " " + word("rigs-shared") : "");
    return row(it.rig.replace("/", " / "), it.serial, nameOf(it.parameter), value, marked(change, it.shared ? "void" : ""), uncertainty,
      it.from_others === null ? NONE : measured(it.from_others, it.uncertainty)[0], unitOf(it.parameter), clock(it.first_at));
  }) : [row(word("rigs-no_references"))]));
}

// Shows what only the page of one rig has, below the row of the rig.
function showOwn(rig, day) {
  const or = (rows) => (rows.length ? rows : [row(NONE)]);
  at("rig_alarms").replaceChildren(...or(rig.alarms.map((it) =>
    row(clock(it.raised), it.code, alarmText(it), word(it.acknowledged ? "alarms-state-acknowledged" : "alarms-state-unacknowledged")))));
  at("rig_calibrations").replaceChildren(...or(rig.calibrations.map((it) => row(it.nominal_v === null ? NONE : it.nominal_v + " V",
    clock(it.made), marked(word("rigs-due") + " " + clock(it.due), it.overdue || !it.verified ? "fail" : "")))));
  at("rig_reasons").replaceChildren(...or((day?.reasons ?? []).map((it) => row(integerText(it.n), it[language]))));
  at("rig_lot").hidden = !rig.run;
  at("rig_lot").href = "#history" + query({lot: rig.run?.lot});
  const since = new Date(Date.now() - 7 * 86400000).toISOString();
  at("rig_alarm_list").href = "api/history/report/alarms" + query({since, limit: 500, lang: language});
}

function showFleet() {
  const rigs = (fleet?.now?.rigs ?? []).filter(isOwn);
  if (!fleet?.now) return;
  const day = (rig) => fleet.day?.rigs.find((it) => it.site === rig.site && it.rig === rig.rig);
  at("rigs").replaceChildren(...(rigs.length ? rigs.map((it) => rigRow(it, day(it))) : [row(word("rigs-none"))]));
  at("rig").hidden = !ownRig || !rigs.length;
  if (ownRig && rigs.length) showOwn(rigs[0], day(rigs[0]));
  showShifts();
  showReferences();
  at("day_as_of").textContent = fleet.day ? word("rigs-day_as_of") + " " + clock(fleet.day.at) : "";
}

PAGES.rigs = {enter: showFleet};
