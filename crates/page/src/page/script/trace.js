// Trace: the last messages of the lines, each with its meaning.

let frozen = false;

// Returns as text the names of the signals that are on according to a reply.
function signalsText(signals) {
  const present = Object.keys(signals).filter((name) => signals[name]);
  return present.length ? word("trace-present") + colon() + present.map((name) => wordOr("signal-" + name, name)).join(comma())
    : word("trace-none_present");
}

const meaningText = (it) => (Object.keys(it.signals).length ? signalsText(it.signals)
  : language === "zh" ? it.meaning_zh ?? NONE : it.meaning);

const lineText = (name) => wordOr("line-" + name, name);

async function readTrace() {
  if (frozen || current !== "trace") return;
  try {
    const lines = await (await ask("/api/trace?last=200")).json();
    const only = at("trace_line").value;
    fillSelect(at("trace_line"), [["", word("any")], ...lines.map((it) => [it.line, lineText(it.line)])]);
    const rows = lines.filter((it) => !only || it.line === only).flatMap((it) => it.entries.map((entry) => [it.line, entry]));
    // Newest first, also among messages of one instant.
    rows.reverse().sort((a, b) => b[1].at_us - a[1].at_us);
    at("trace").replaceChildren(...rows.slice(0, 200).map(([line, it]) =>
      row((it.at_us / 1e6).toFixed(6), lineText(line), it.way, it.text, meaningText(it))));
    at("trace_trouble").textContent = "";
  } catch (error) {
    at("trace_trouble").textContent = error.message;
  }
}

at("trace_freeze").addEventListener("click", () => {
  frozen = !frozen;
  at("trace_freeze").setAttribute("aria-pressed", frozen);
  readTrace();
});
at("trace_line").addEventListener("change", readTrace);
setInterval(readTrace, 1000);

PAGES.trace = {enter: readTrace};
