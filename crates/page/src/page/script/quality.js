// Quality: the control charts and histograms of the printed reports, capability, and cycles as bars.

let lotsSeen = [];

async function enterQuality() {
  fillSelect(at("q_param"), keyOptions());
  try {
    lotsSeen = await readLots();
    fillSelect(at("q_lot"), [...new Set(lotsSeen.map((it) => it.lot))].reverse().map((it) => [it, it]));
    await readQuality();
  } catch (error) {
    at("q_trouble").textContent = error.message;
  }
}

// Returns the drawings of a printed report that match the selector `which`, without the style of the report.
async function figures(path, which) {
  const text = (await (await ask(path)).text()).replace(/<style[^]*?<\/style>/g, "").replace(/ style="[^"]*"/g, "");
  const page = new DOMParser().parseFromString(text, "text/html");
  return Array.from(page.querySelectorAll(which), (it) => {
    const figure = document.importNode(it, true);
    figure.querySelector("svg").setAttribute("aria-label", figure.querySelector("figcaption").textContent);
    return figure;
  });
}

async function readQuality() {
  const lot = at("q_lot").value, param = at("q_param").value;
  at("q_print").href = "/api/history/report/chart" + query({lot, param, lang: language});
  if (!lot) {
    at("q_trouble").textContent = word("h-none");
    return;
  }
  const read = [
    figures("/api/history/report/chart" + query({lot, param, last: 100, lang: language}), "main figure"),
    figures("/api/history/report/lot" + query({lot, lang: language}), ".figures figure"),
    ask("/api/history/stats" + query({lot, param})).then((it) => it.json()), showStoredCycles(lot)];
  const [charts, histograms, stats, cycles] = await Promise.allSettled(read);
  at("q_charts").replaceChildren(...(charts.value || []));
  at("q_histograms").replaceChildren(...(histograms.value || []));
  showCapability(stats.value, unitOf(param));
  const trouble = [charts, histograms, stats, cycles].find((it) => it.status === "rejected");
  at("q_trouble").textContent = trouble ? trouble.reason.message : "";
}

function showCapability(stats, unit) {
  const figure = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(5))) : NONE);
  const rows = [["n", ""], ["mean", unit], ["sd", unit], ["min", unit], ["max", unit], ["median", unit],
    ["cp", ""], ["cpk", ""], ["cpk_low95", ""], ["ppk", ""], ["lag1", ""]];
  at("q_stats").replaceChildren(...(stats ? rows : []).map(([key, of]) => row(word("q-" + key), figure(stats[key]), of)));
}

at("q_lot").addEventListener("change", readQuality);
at("q_param").addEventListener("change", readQuality);

const LAST_PARTS = 12;

// Draws how the last parts of a lot overlap: one is tested while the one before it travels to its bin.
async function showStoredCycles(lot) {
  const {parts: count} = await (await ask("/api/history/count" + query({lot}))).json();
  const members = {lot, limit: LAST_PARTS, offset: Math.max(0, count - LAST_PARTS)};
  const parts = (await (await ask("/api/history/query" + query(members))).json()).filter((it) => partBars(it).length);
  at("q_stored").replaceChildren(...(parts.length ? [timeBars(parts.map((it) => [word("h-part") + " " + it.seq, partBars(it)]), word("g-stored"))] : []));
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
