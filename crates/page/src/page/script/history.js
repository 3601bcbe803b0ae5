// The history: the filter of `history query`, pages of parts, and one part down to its raw replies.

const PAGE = 100;
const FIELDS = ["lot", "recipe", "serial", "verdict", "bin", "param", "min", "max"];
let offset = 0;

function filter() {
  const members = {since: rfc3339(at("h_since").value), until: rfc3339(at("h_until").value)};
  for (const field of FIELDS) members[field] = at("h_" + field).value.trim();
  return members;
}

function makeFilter() {
  const all = ["", word("any")];
  fillSelect(at("h_verdict"), [all, ...[...VERDICTS, "unjudged"].map((it) => [it, word("verdict-" + it)])]);
  fillSelect(at("h_bin"), [all, ...BINS.map((it) => [it, word("bin-" + it)])]);
  fillSelect(at("h_param"), [all, ...keyOptions()]);
}

async function fillLots() {
  at("lots").replaceChildren(...[...new Set((await readLots()).map((it) => it.lot))].map((lot) => {
    const option = make("option");
    option.value = lot;
    return option;
  }));
}

async function readParts() {
  const isNewest = newest(readParts), members = filter();
  at("export_csv").href = "api/history/export.csv" + query(members);
  at("export_xlsx").href = "api/history/export.xlsx" + query({...members, lang: language});
  at("h_rejudge").hidden = !Object.hasOwn(SCRIPTS, "rejudge");
  at("h_rejudge").href = "#rejudge" + query({lot: members.lot});
  at("h_lot_report").hidden = !members.lot;
  at("h_lot_report").href = "api/history/report/lot" + query({lot: members.lot, lang: language});
  try {
    const [{parts: count}, parts] = await Promise.all([
      ask("api/history/count" + query(members)).then((it) => it.json()),
      ask("api/history/query" + query({...members, limit: PAGE, offset})).then((it) => it.json()), fillLots()]);
    if (!isNewest()) return;
    showParts(parts, count);
    at("h_trouble").textContent = "";
  } catch (error) {
    if (!isNewest()) return;
    showParts([], 0);
    at("h_trouble").textContent = error.message;
  }
}

function showParts(parts, count) {
  const key = at("h_param").value;
  at("h_value").textContent = key ? nameOf(key) + " / " + unitOf(key) : "";
  at("h_count").textContent = count === 0 ? word("h-none")
    : (offset + 1) + " – " + (offset + parts.length) + " " + word("judged_of") + " " + integerText(count);
  at("h_back").disabled = offset === 0;
  at("h_next").disabled = offset + parts.length >= count;
  at("parts").replaceChildren(...parts.map((part) => row(partLink(part), clock(part.time), part.recipe,
    verdictCell(part.verdict), wordOr("bin-" + (part.landed_bin || part.bin), NONE),
    reasonTexts(part).join(semicolon()), key ? measured(part.values[key], part.uncertainty[key]).join(" ± ") : "")));
}

at("h_filter").addEventListener("submit", (event) => {
  event.preventDefault();
  offset = 0;
  readParts();
});
at("h_back").addEventListener("click", () => { offset = Math.max(0, offset - PAGE); readParts(); });
at("h_next").addEventListener("click", () => { offset += PAGE; readParts(); });

// Takes the filter from the address, if present, in place of the bound of the page.
function takeFilter() {
  const given = Object.fromEntries(new URLSearchParams(location.hash.split("?")[1]));
  const named = FIELDS.filter((field) => Object.hasOwn(given, field));
  for (const field of named) at("h_" + field).value = given[field];
  if (named.length) at("h_since").value = "";
  else if (bounds.hours && !at("h_since").value) at("h_since").value = localText(new Date(Date.now() - bounds.hours * 3600000));
}

PAGES.history = {enter() { makeFilter(); takeFilter(); readParts(); }};

// --- one part ---

async function readPart() {
  const isNewest = newest(readPart);
  const which = Object.fromEntries(new URLSearchParams(location.hash.split("?")[1]));
  at("part_title").textContent = which.lot + " / " + which.run + " / " + which.seq;
  at("part_certificate").href = "api/history/report/certificate" + query({lot: which.lot, run: which.run, seq: which.seq, lang: language});
  at("part_certificate").hidden = which.kind !== "lot";
  try {
    const [part] = await (await ask("api/history/show" + query(which))).json();
    if (!isNewest()) return;
    showPart(part);
    await readBatch(part, isNewest);
    at("part_trouble").textContent = "";
  } catch (error) {
    if (isNewest()) at("part_trouble").textContent = error.message;
  }
}

// Groups times into bars; a pause of 50 ms begins a new bar, because a test may read one characteristic, such as those
// of the NC contact, at times far apart.
function groupTimes(times, name) {
  const bars = [];
  for (const at of times.sort((a, b) => a - b)) {
    const last = bars.at(-1);
    if (last && at - last.to < .05) last.to = at;
    else bars.push({from: at, to: at, name});
  }
  return bars;
}

function showTestBars(part) {
  const rows = part.measurements.filter((it) => it.samples.length).map((it) => {
    const name = nameOf(it.parameter);
    return [name + (it.attempt > 1 ? " " + it.attempt : ""), groupTimes(it.samples.map((sample) => seconds(sample.at)), name)];
  }).sort((a, b) => a[1][0].from - b[1][0].from);
  const test = partBars(part).slice(0, 1);
  at("part_bars").replaceChildren(...(rows.length ? [timeBars(test.length ? [[word("h-test_s"), test], ...rows] : rows, word("g-test"))] : []));
}

function showPart(part) {
  const facts = [["h-time", clock(part.time)], ["recipe", part.recipe], ["h-serial", part.serial || NONE],
    ["verdict", wordOr("verdict-" + part.verdict, part.verdict)],
    ["h-bin", wordOr("bin-" + (part.landed_bin || part.bin), NONE)],
    ["h-test_s", part.test_s === null ? NONE : part.test_s.toFixed(2) + " s"],
    ["h-cycle_s", part.cycle_s === null ? NONE : part.cycle_s.toFixed(2) + " s"],
    ["h-reasons", reasonTexts(part).join(semicolon()) || NONE]];
  at("part_facts").replaceChildren(...facts.map(([key, text]) => {
    const pair = make("div");
    pair.append(make("dt", word(key)), make("dd", text));
    return pair;
  }));
  const values = part.measurements.map((it) => {
    const [value, uncertainty] = measured(it.value, it.uncertainty);
    return row(nameOf(it.parameter), String(it.attempt), value, uncertainty,
      unitOf(it.parameter), limitText(it), verdictCell(it.verdict));
  });
  // A part can fail at a characteristic without a value, such as a coil current over range.
  const isMeasured = (code) => part.measurements.some((it) => it.parameter === code);
  const missing = new Set(part.reason_codes.map((it) => it.param).filter((it) => it && !isMeasured(it)));
  values.push(...Array.from(missing, (it) => row(nameOf(it), NONE, NONE, NONE, unitOf(it), NONE, verdictCell(part.verdict))));
  at("part_values").replaceChildren(...values);
  const external = part.external ?? [];
  at("part_external").hidden = external.length === 0;
  at("part_results").replaceChildren(...external.map(externalRow));
  showCurves(part);
  showTestBars(part);
  at("part_replies").replaceChildren(...part.measurements.flatMap((it) => it.samples.map((sample) =>
    row(nameOf(it.parameter), wordOr("line-" + sample.line, sample.line), wordOr("module-" + sample.module, sample.module), sample.channel,
      sample.command, sample.raw, clock(sample.at).slice(11) + sample.at.slice(19, -1)))));
}

// Draws the batch of a part with the switchings of the part's own contact; hides the drawing of a part without a batch.
async function readBatch(part, isNewest) {
  const batches = await (await ask("api/history/batches" + query({lot: part.lot, run: part.run}))).json();
  if (!isNewest()) return;
  const judged = seconds(part.time);
  const batch = batches.find((it) => seconds(it.begin) <= judged && judged <= seconds(it.ended));
  at("part_batch").hidden = !batch;
  if (!batch) return;
  at("part_batch_number").textContent = batch.number;
  const own = {...batch, switched: batch.switched.filter((it) => it.seq === part.seq)};
  const box = at("part_air");
  box.replaceChildren(airDrawing(own, box.clientWidth || AIR.wide, box.clientHeight || AIR.high));
}

PAGES.part = {enter: readPart};
