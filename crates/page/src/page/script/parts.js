// Lots and parts of the history, as several pages show them.

const readLots = async () => (await ask("api/history/list" + query({since: bounds.lot_days && "-" + bounds.lot_days + "d"}))).json();

const verdictCell = (verdict) => {
  const cell = make("td", undefined, verdict);
  cell.append(make("span", wordOr("verdict-" + verdict, verdict), "verdict"));
  return cell;
};

const limitText = (it) => (it.low === null ? "" : "≥ " + it.low + " ") + (it.high === null ? "" : "≤ " + it.high);

// --- results from outside of the rig ---

function externalRow(it) {
  const [value, uncertainty] = measured(it.value, it.uncertainty);
  const verdict = it.superseded ? word("x-superseded") : verdictCell(it.verdict);
  return row(it.serial || (it.seq === null ? word("lot") : it.run + " / " + it.seq), nameOf(it.key), value, uncertainty, unitOf(it.key),
    limitText(it), verdict, clock(it.measured), it.who);
}

// Returns a sentence that says whether a lot is acceptable; empty for a lot that has and needs no such results.
function externalText(it) {
  if (!it) return "";
  if (it.acceptable) return word("x-acceptable");
  const counts = [[word("verdict-fail"), it.fail], [word("verdict-undecided"), it.undecided]].filter(([, count]) => count).map((pair) => pair.join(" "));
  const missing = it.missing.length ? [word("x-missing") + " " + it.missing.map(nameOf).join(comma())] : [];
  return word("x-not_acceptable") + colon() + [...counts, ...missing].join(comma());
}

// --- links and bars ---

// Links to the page of a part; on the page of many rigs, to the page of the part's rig.
function partLink(part) {
  const [site, ...rig] = (part.rig || "").split("/").map(encodeURIComponent);
  const link = make("a", part.lot + " / " + part.run + " / " + part.seq);
  link.href = (part.rig ? "/rigs/" + site + "/" + rig.join("%2F") + "/" : "") + "#part" + query({lot: part.lot, run: part.run, seq: part.seq, kind: part.kind});
  return link;
}

// --- stored times as bars ---

const seconds = (when) => Date.parse(when) / 1000;

// Draws rows of [label, bars] over a time axis; a bar is {from, to, name, kind} with times in seconds.
function timeBars(rows, label) {
  const all = rows.flatMap(([, bars]) => bars), high = 24, left = 190, wide = 1000 - left;
  const begin = Math.min(...all.map((it) => it.from)), span = Math.max(...all.map((it) => it.to)) - begin || 1;
  const x = (at) => left + wide * (at - begin) / span;
  const svg = drawn("svg", {viewBox: "0 0 1000 " + (rows.length * high + 26), role: "img", "aria-label": label, class: "bars"});
  const say = (text, at, y) => {
    const element = drawn("text", {x: at, y, class: "label"});
    element.textContent = text;
    svg.append(element);
  };
  const step = [.1, .2, .5, 1, 2, 5, 10, 20, 60].find((it) => span / it < 9) || 300;
  for (let at = 0; at <= span; at += step) {
    svg.append(drawn("path", {d: "M" + x(begin + at) + " 0V" + rows.length * high, class: "rule"}));
    say(Number(at.toFixed(1)) + " s", x(begin + at) - 4, rows.length * high + 18);
  }
  rows.forEach(([name, bars], place) => {
    say(name, 0, place * high + 17);
    for (const it of bars) {
      const bar = drawn("rect", {x: x(it.from), y: place * high + 4, width: Math.max(2, x(it.to) - x(it.from)), height: high - 8,
        class: "busy " + (it.kind || "")});
      const title = drawn("title", {});
      title.textContent = it.name + colon() + ((it.to - it.from) * 1000).toFixed(0) + " ms";
      bar.append(title);
      svg.append(bar);
    }
  });
  return svg;
}

// Returns two bars: the test, from probes up to the verdict, and the way to the beam of the bin.
function partBars(part) {
  const judged = seconds(part.time), bars = [];
  if (part.test_s !== null) bars.push({from: judged - part.test_s, to: judged, name: word("h-test_s")});
  if (part.landed_at) bars.push({from: judged, to: seconds(part.landed_at), name: word("g-travels"), kind: "soft"});
  return bars;
}
