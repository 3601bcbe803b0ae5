// Quality: the control charts and histograms of the printed reports, capability, and cycles as bars.

let lotsSeen = [];

async function enterQuality() {
  // The page of many rigs follows no rig live, so it hides the cycle.
  for (const it of [at("q_cycle"), at("q_cycle").previousElementSibling]) it.hidden = !Object.hasOwn(SCRIPTS, "io");
  fillSelect(at("q_param"), keyOptions());
  try {
    lotsSeen = await readLots();
    const names = [...new Set(lotsSeen.map((it) => it.lot))].reverse().map((it) => [it, it]);
    fillSelect(at("q_lot"), names);
    fillSelect(at("q_others"), names);
    await readQuality();
  } catch (error) {
    at("q_trouble").textContent = error.message;
  }
}

// Returns the drawings and tables of a printed report that match the selector `which`, without the style of the report.
async function figures(path, which) {
  const text = (await (await ask(path)).text()).replace(/<style[^]*?<\/style>/g, "").replace(/ style="[^"]*"/g, "");
  const page = new DOMParser().parseFromString(text, "text/html");
  return Array.from(page.querySelectorAll(which), (it) => {
    const figure = document.importNode(it, true);
    const caption = figure.querySelector("figcaption");
    // A narrow screen scrolls a chart sideways, also by keyboard.
    figure.tabIndex = 0;
    if (caption) figure.querySelector("svg").setAttribute("aria-label", caption.textContent);
    else figure.className = "list";
    return figure;
  });
}

async function readQuality() {
  const isNewest = newest(readQuality), lot = at("q_lot").value, param = at("q_param").value;
  at("q_print").href = "api/history/report/chart" + query({lot, param, lang: language});
  if (!lot) {
    at("q_trouble").textContent = word("h-none");
    return;
  }
  const read = [
    figures("api/history/report/chart" + query({lot, param, last: 100, lang: language}), "main figure"),
    figures("api/history/report/lot" + query({lot, lang: language}), "figure.pareto, .figures figure"),
    ask("api/history/stats" + query({lot, param})).then((it) => it.json()), storedCycles(lot)];
  const [charts, histograms, stats, cycles] = await Promise.allSettled(read);
  if (!isNewest()) return;
  at("q_charts").replaceChildren(...(charts.value || []));
  const [paretos, classes] = [true, false].map((is) => (histograms.value || []).filter((it) => it.matches(".pareto") === is));
  at("q_paretos").replaceChildren(...paretos);
  at("q_histograms").replaceChildren(...classes);
  at("q_stored").replaceChildren(...(cycles.value || []));
  readComparison();
  showCapability(stats.value, unitOf(param));
  const trouble = [charts, histograms, stats, cycles].find((it) => it.status === "rejected");
  at("q_trouble").textContent = trouble ? trouble.reason.message : "";
}

function showCapability(stats, unit) {
  const figure = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(5))) : NONE);
  const rows = [["n", ""], ["without_value", ""], ["mean", unit], ["sd", unit], ["min", unit], ["max", unit], ["median", unit],
    ["cp", ""], ["cpk", ""], ["cpk_low95", ""], ["ppk", ""], ["lag1", ""]];
  at("q_stats").replaceChildren(...(stats ? rows : []).map(([key, of]) => row(word("q-" + key), figure(stats[key]), of)));
}

// --- lots side by side, and a gauge study from a file ---

async function readComparison() {
  const isNewest = newest(readComparison);
  const others = Array.from(at("q_others").selectedOptions, (it) => it.value);
  const lots = [...new Set([at("q_lot").value, ...others])];
  at("q_compare_print").hidden = lots.length < 2;
  at("q_compare_trouble").textContent = lots.length < 2 ? word("q-choose") : "";
  at("q_compared").replaceChildren();
  if (lots.length < 2) return;
  const path = "api/history/report/comparison" + query({param: at("q_param").value, lots: JSON.stringify(lots), lang: language});
  at("q_compare_print").href = path;
  try {
    const compared = await figures(path, "figure, table.compared");
    if (isNewest()) at("q_compared").replaceChildren(...compared);
  } catch (error) {
    if (isNewest()) at("q_compare_trouble").textContent = error.message;
  }
}

const GAUGE = ["repeatability", "reproducibility", "interaction", "grr", "part", "total", "pct_grr", "ndc", "interaction_p"];

async function readGauge() {
  const [file] = at("q_gauge_file").files;
  at("q_gauge").replaceChildren();
  at("q_gauge_trouble").textContent = "";
  if (!file) return;
  try {
    const reply = await post("api/quality/grr", {csv: await file.text()});
    const found = await reply.json();
    if (!reply.ok) throw new Error(said(found, "reason"));
    const figure = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(4))) : NONE);
    at("q_gauge").replaceChildren(...GAUGE.map((key) => row(word("q-gauge-" + key), figure(found[key]))));
  } catch (error) {
    at("q_gauge_trouble").textContent = error.message;
  }
}

at("q_others").addEventListener("change", readComparison);
at("q_gauge_file").addEventListener("change", readGauge);
at("q_lot").addEventListener("change", readQuality);
at("q_param").addEventListener("change", readQuality);

const LAST_PARTS = 12;

// Returns a drawing of how the last parts of a lot overlap: a part is under test while the part before goes to its bin.
async function storedCycles(lot) {
  const {parts: count} = await (await ask("api/history/count" + query({lot}))).json();
  const members = {lot, limit: LAST_PARTS, offset: Math.max(0, count - LAST_PARTS)};
  const parts = (await (await ask("api/history/query" + query(members))).json()).filter((it) => partBars(it).length);
  return parts.length ? [timeBars(parts.map((it) => [word("h-part") + " " + it.seq, partBars(it)]), word("g-stored"))] : [];
}

// --- the cycle as bars: moving actuators and tests of the last seconds ---

function showCycle() {
  const rows = [...view.machine.actuators.map((it) => it.name), "test"];
  const now = performance.now(), high = 22, left = 150, wide = 1000 - left;
  const x = (at) => left + wide * (1 - (now - at) / SPAN_MS);
  const svg = drawn("svg", {viewBox: "0 0 1000 " + (rows.length * high + 4), role: "img", "aria-label": word("q-cycle")});
  rows.forEach((name, place) => {
    const label = drawn("text", {x: 0, y: place * high + 16, class: "label"});
    label.textContent = wordOr("actuator-" + name, name);
    svg.append(label, drawn("path", {d: "M" + left + " " + ((place + 1) * high) + "H1000", class: "rule"}));
    activity.forEach((it, index) => {
      if (!it.busy.includes(name)) return;
      const from = Math.max(left, x(it.at)), to = index + 1 < activity.length ? x(activity[index + 1].at) : x(now);
      svg.append(drawn("rect", {x: from, y: place * high + 4, width: Math.max(1, to - from), height: high - 8, class: "busy"}));
    });
  });
  at("q_cycle").replaceChildren(svg);
}

PAGES.quality = {enter: enterQuality, show: showCycle};
