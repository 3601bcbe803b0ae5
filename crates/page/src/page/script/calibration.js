// Calibration: factors with uncertainty and due date, and the last readings of reference parts.

let instruments = null;

async function enterCalibration() {
  try {
    instruments = await (await ask("/api/calibration")).json();
    at("c_trouble").textContent = instruments.calibrations.length ? "" : word("c-none");
  } catch (error) {
    at("c_trouble").textContent = error.message;
  }
  if (!instruments) return;
  at("c_factors").replaceChildren(...instruments.calibrations.flatMap(calibrationTables));
  const {check} = instruments;
  at("c_check").textContent = check === null ? word("c-unchecked")
    : (check.passed ? word("c-agreed") : "▲ " + word("c-disagreed")) + " " + clock(check.at) + " · " + (check.text === "calibration" ? word("c-at_calibration") : said(check, "text"));
  at("c_check").className = check !== null && !check.passed ? "due bad" : "due";
  at("c_golden").replaceChildren(...instruments.golden.flatMap(goldenRows));
}

function calibrationTables(it) {
  const title = make("h2", (it.nominal_v === null ? word("c-rack") : it.nominal_v + " V") + " · " + word("c-made") + " " + clock(it.made));
  const due = make("p", (it.overdue ? "▲ " + word("c-overdue") + " " : word("c-due") + " ") + clock(it.due) +
    (it.verified ? "" : " · ▲ " + word("c-failed")), it.overdue || !it.verified ? "due bad" : "due");
  const table = make("table", undefined, "list"), body = make("tbody"), head = make("thead"), names = make("tr");
  names.append(...["c-factor", "value", "c-uncertainty", "unit"].map((key) => {
    const cell = make("th", word(key));
    cell.scope = "col";
    return cell;
  }));
  head.append(names);
  body.append(...it.factors.map((one) => row(wordOr("factor-" + one.name, one.name), ...measured(one.value, one.uncertainty),
    unitText(one.unit))));
  table.append(head, body);
  return [title, due, table];
}

function goldenRows(part) {
  return part.values.map((it, place) => {
    const unit = unitOf(it.parameter), [value] = it.value === null ? [NONE] : measured(it.value, it.uncertainty);
    const difference = it.value === null ? NONE : measured(it.value - it.certified, it.uncertainty).join(" ± ") + " " + unit;
    return row(place ? "" : part.serial, place ? "" : part.seen ? clock(part.seen) : word("c-never"), nameOf(it.parameter),
      measured(it.certified, it.certified_uncertainty)[0] + " " + unit, value === NONE ? NONE : value + " " + unit, difference);
  });
}

PAGES.calibration = {enter: enterCalibration};
