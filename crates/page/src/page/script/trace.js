// Trace: the last messages of the lines, each with its meaning.

let frozen = false;

async function readTrace() {
  if (frozen || current !== "trace") return;
  try {
    const lines = await (await ask("/api/trace?last=200")).json();
    const only = at("trace_line").value;
    fillSelect(at("trace_line"), [["", word("any")], ...lines.map((it) => [it.line, it.line])]);
    const rows = lines.filter((it) => !only || it.line === only).flatMap((it) => it.entries.map((entry) => [it.line, entry]));
    rows.sort((a, b) => b[1].at_us - a[1].at_us);
    at("trace").replaceChildren(...rows.slice(0, 200).map(([line, it]) =>
      row((it.at_us / 1e6).toFixed(6), line, it.way, it.text, it.meaning)));
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
