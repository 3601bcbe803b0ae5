// The operator's page.

function showProgress() {
  const {judged, count} = view;
  const percent = count > 0 ? Math.min(100, 100 * judged / count) : 0;
  at("judged").textContent = count === null ? integerText(judged) + " " + word("judged")
    : integerText(judged) + " " + word("judged_of") + " " + integerText(count) + " " + word("judged");
  at("percent").textContent = count === null ? word("endless") : percent.toFixed(0) + "\u202f%";
  at("bar").setAttribute("aria-valuenow", percent.toFixed(0));
  at("bar").firstElementChild.style.width = percent + "%";
}

function showLast(last) {
  at("seq").textContent = last ? integerText(last.seq) : "";
  const [, verdict, bin] = at("verdict").children;
  at("verdict").className = last ? last.verdict : "";
  verdict.textContent = last ? wordOr("verdict-" + last.verdict, last.verdict) : NONE;
  bin.textContent = last ? word(view.machine?.rack ? "rack-to_list" : "to_bin") + " " + wordOr("bin-" + last.bin, last.bin) : word("no_part");
  showRecent(view.recent);
  const reasons = last ? reasonTexts(last) : [];
  at("reasons").replaceChildren(...reasons.slice(0, 3).map((text) => make("li", text)));
  at("values").replaceChildren(...measuredKeys(last).map((key) => valueRow(key, last)));
}

// Returns the characteristics that have limits in the recipe or a value of the last part; none before the first lot.
const measuredKeys = (last) => keysOf((key) => Object.hasOwn(view.limits, key) || Object.hasOwn(last?.values ?? {}, key));

function valueRow(key, last) {
  const [value, uncertainty] = last ? measured(last.values[key], last.uncertainty[key]) : [NONE, NONE];
  const row = make("tr");
  const blamed = last && last.verdict === "fail" && last.reason_codes.some((it) => it.param === key);
  if (blamed) row.className = "bad";
  row.append(make("td", nameOf(key)), make("td", value), make("td", uncertainty), make("td", unitOf(key)), bandCell(key, last));
  return row;
}

// Draws a value in the band of its limits. Without a lower limit the band begins at 0 or at a value below 0; without an
// upper limit the band ends at 1.5 times the greatest number.
function bandCell(key, last) {
  const cell = make("td"), limits = view.limits[key], value = last ? last.values[key] : undefined;
  if (!limits) return cell;
  cell.append(make("small", rangeOf(...limits)));
  if (!Number.isFinite(value)) return cell;
  const [low, high] = limits, all = [low, high, value].filter(Number.isFinite);
  const from = low ?? Math.min(0, value), to = high ?? Math.max(value, ...all) * 1.5;
  const place = (it) => 12 + 60 * Math.min(1.2, Math.max(-.2, (it - from) / (to - from || 1)));
  const svg = drawn("svg", {class: "band", viewBox: "0 0 84 16", "aria-hidden": true});
  svg.append(drawn("rect", {x: 12, y: 4, width: 60, height: 8}),
    drawn("path", {d: "M" + place(value) + " 0V16"}));
  cell.prepend(svg);
  return cell;
}

const rangeOf = (low, high) => (low === null && high === null ? "" : low === null ? "≤ " + high : high === null ? "≥ " + low : low + " … " + high);

const SHORT = {pass: "✓", fail: "✗", void: "?"};

function showRecent(recent) {
  at("recent").replaceChildren(...recent.map((part) => {
    const item = make("li", SHORT[part.verdict], part.verdict);
    item.title = part.seq + " · " + wordOr("verdict-" + part.verdict, part.verdict) + " · " + wordOr("bin-" + part.bin, part.bin);
    return item;
  }));
}

// Returns the usual names first, then the other names of `counts`.
const ordered = (names, counts) => [...names, ...Object.keys(counts).filter((it) => !names.includes(it))];

function showBins(bins) {
  const there = view.machine ? BINS.filter((it) => view.machine.bins.includes(it)) : [];
  const most = Math.max(1, ...Object.values(bins));
  at("bins").replaceChildren(...ordered(there, bins).map((name) => {
    const item = make("li"), bar = make("div", undefined, "bar"), fill = make("i");
    fill.style.width = 100 * (bins[name] || 0) / most + "%";
    bar.append(fill);
    item.append(make("span", wordOr("bin-" + name, name)), make("b", integerText(bins[name] || 0)), bar);
    return item;
  }));
}

function showVerdicts(verdicts) {
  at("verdicts").replaceChildren(...ordered(VERDICTS, verdicts).map((name) => {
    const pair = make("div");
    pair.append(make("dt", wordOr("verdict-" + name, name)), make("dd", integerText(verdicts[name] || 0)));
    return pair;
  }));
}

// In a lot whose parts a person scans, shows the field for a scanner that types like a keyboard.
function showScans() {
  const scans = view.machine ? view.machine.scans : null;
  at("scan").hidden = scans === null;
  if (scans === null) return;
  const first = scans.slice(0, 3).join(comma()) + (scans.length > 3 ? " + " + (scans.length - 3) : "");
  at("scan_waiting").textContent = scans.length ? word("scan-waiting") + " " + first : word("scan-none");
  at("scan_undo").disabled = scans.length === 0;
}

const answerScan = (text) => { at("scan_answer").textContent = text; };

at("scan").addEventListener("submit", async (event) => {
  event.preventDefault();
  const field = at("scan_serial"), serial = field.value.trim();
  field.value = "";
  if (serial && !await giveOrder({order: "scan", serial}, answerScan)) field.focus();
});
at("scan_undo").addEventListener("click", () => giveOrder({order: "unscan"}, answerScan));

// The scanner types wherever the focus is; on the operator's page its text belongs in the field. A blank presses the
// button that has the focus, and no serial number begins with it.
document.addEventListener("keydown", (event) => {
  const typed = event.key.length === 1 && event.key !== " " && !event.ctrlKey && !event.altKey && !event.metaKey;
  const free = !document.querySelector("dialog[open]") && !/^(input|select|textarea)$/i.test(document.activeElement.tagName);
  if (typed && free && !at("scan").hidden && at("scan").checkVisibility()) at("scan_serial").focus();
});

function showOperator() {
  at("state").replaceChildren(...stateTexts(view).map((text, place) => make(place ? "small" : "span", text)));
  for (const id of ["came_in", "inside", "went_out"]) at(id).textContent = integerText(view[id]);
  at("rate").textContent = view.parts_per_hour === null ? NONE : integerText(Math.round(view.parts_per_hour));
  const judged = Object.values(view.verdicts).reduce((sum, it) => sum + it, 0);
  at("yield").textContent = share(view.verdicts.pass || 0, judged);
  showMimic();
  showRack();
  showScans();
  showProgress();
  showLast(view.last);
  showBins(view.bins);
  showVerdicts(view.verdicts);
}

PAGES.operator = {show: showOperator};
