//! Tests of plan and document, on hand-written results.
#![allow(clippy::unwrap_used)]

use super::page::{Results, document};
use super::plan::Plan;
use super::result::{Head, RunResult, rows};

const PLAN: &str = r##"
about = "What the figures mean."

[[section]]
title = "Pace"
about = "How fast."

[[section.run]]
name = "cycle"
title = "Cycle"
command = "relayrig study cycle"
machine = "any"
shows = ["test"]
pictures = [{ file = "cycle.svg", about = "Where a cycle goes" }]

[[section.run]]
name = "pace"
title = "Wall time"
command = "relayrig study pace"
machine = "quiet"
larger = [{ command = "relayrig study pace --parts 3000", about = "ten times as many parts" }]
"##;

const CYCLE: &str = concat!(
    r#"{"type":"figure","study":"cycle","figure":"test, longest","n":1152,"value":0.85004,"unit":"s","bar":"<= 0.85","met":false,"mean":0.754}"#,
    "\n",
    r#"{"type":"figure","study":"cycle","figure":"test against bound","n":1152,"value":1.1241,"unit":"","bar":null,"met":null}"#,
    "\n",
    r#"{"type":"figure","study":"cycle","figure":"alarms","n":1,"value":3.0,"unit":"","bar":"<= 0","met":false}"#,
    "\n",
    r#"{"type":"summary","study":"cycle"}"#,
    "\n",
);

fn result(busy_cores: f64) -> RunResult {
    let head = Head {
        command: "relayrig study cycle".to_owned(),
        date: "2026-11-23".to_owned(),
        commit: Some("12345678".to_owned()),
        is_changed: true,
        cpu: "Xeon".to_owned(),
        cores: 2,
        busy_cores: Some(busy_cores),
        seconds: 12.3,
    };
    RunResult {
        head,
        rows: rows(CYCLE).unwrap(),
    }
}

fn rendered(name: &str, busy_cores: f64) -> String {
    let results = Results::from([(name.to_owned(), result(busy_cores))]);
    document(&Plan::read(PLAN).unwrap(), &results)
}

#[test]
fn missed_bars_come_first_though_not_shown() {
    let text = rendered("cycle", 0.0);
    let missed = "| test, longest | 0.85004 s | at most 0.85 | [Cycle](#cycle) |\n| alarms | 3 | 0 | [Cycle](#cycle) |";
    assert!(text.find(missed).unwrap() < text.find("## Pace").unwrap());
    assert!(text.contains("1 of 2 runs have a result; their figures miss 2 of 2 bars."));
    assert_eq!(text.matches("alarms").count(), 1, "{text}");
}

#[test]
fn rows_with_other_columns_have_another_table() {
    let text = rendered("cycle", 0.0);
    let first = "| figure | value | bar | n | mean |\n|---|---|---|---|---|\n\
                 | test, longest | 0.85004 s | at most 0.85, **missed** | 1,152 | 0.754 |\n\n";
    let second = "| figure | value | n |\n|---|---|---|\n| test against bound | 1.12 | 1,152 |\n\n";
    assert!(text.contains(&format!("{first}{second}")), "{text}");
}

#[test]
fn a_run_without_a_result_is_not_run() {
    let text = rendered("cycle", 0.0);
    assert!(text.contains("| [Wall time](#wall-time) | quiet | `relayrig study pace` |"));
    assert!(
        text.contains("Not run: `relayrig study pace`\n\nLarger runs, by hand:"),
        "{text}"
    );
    assert!(!text.contains("Not run: `relayrig study cycle`"));
}

#[test]
fn circumstances_are_said_once_per_run() {
    let text = rendered("cycle", 1.5);
    let line = "`relayrig study cycle` (any machine), 2026-11-23, commit `12345678` with changes, Xeon, 2 cores, 12 s";
    assert_eq!(text.matches(line).count(), 1, "{text}");
    assert!(text.contains("Where a cycle goes:\n\n![Where a cycle goes](pictures/cycle.svg)"));
}

#[test]
fn a_busy_machine_is_not_called_quiet() {
    let is_shared = |busy_cores| rendered("pace", busy_cores).contains("**shared**");
    assert!(is_shared(1.5) && !is_shared(0.1));
}

#[test]
fn a_plan_names_each_run_and_heading_once() {
    let error =
        |from: &str, to: &str| format!("{:#}", Plan::read(&PLAN.replace(from, to)).unwrap_err());
    assert!(error("name = \"pace\"", "name = \"cycle\"").contains("\"cycle\" twice"));
    assert!(error("title = \"Wall time\"", "title = \"cycle\"").contains("\"cycle\" twice"));
    assert!(error("name = \"pace\"", "name = \"../pace\"").contains("small letters"));
    assert!(error("machine = \"any\"", "machine = \"loud\"").contains("loud"));
}

#[test]
fn a_printed_line_that_is_no_figure_is_named() {
    let error = |text: &str| format!("{:#}", rows(text).unwrap_err());
    assert!(error("").contains("found no figure"));
    assert!(error("swept: 3 us\n").contains("printed line 1"));
    assert!(error(&CYCLE.replace("<= 0.85", "about 1")).contains("about 1"));
    assert!(error(&CYCLE.replace("1152", "-1")).contains("expected a count"));
}
