//! Tests of query plans: each query that may run on many rows must find them by an index.

use super::super::source::Dialect;
use super::super::{batches, curve, details, lots, reasons, retention, series, values};
use super::reading::operate;
use super::*;

/// Returns SQLite's plan for a statement, one line per step.
fn plan(file: &File, select: &filter::Select) -> String {
    explained(&file.by_hand(), &select.sql)
}

/// Returns SQLite's plan for an SQL text; the values of its parameters do not change the plan.
fn explained(by_hand: &rusqlite::Connection, sql: &str) -> String {
    let mut statement = by_hand
        .prepare(&format!("EXPLAIN QUERY PLAN {sql}"))
        .unwrap();
    let read = |row: &rusqlite::Row<'_>| row.get::<_, String>(3);
    let rows = statement.raw_query().mapped(read);
    rows.collect::<rusqlite::Result<Vec<_>>>()
        .unwrap()
        .join("\n")
}

#[test]
fn a_value_range_enters_the_index_once() {
    let file = File::new();
    let _store = filled(&file, 10);
    let lot = Filter {
        lot: Some("A".into()),
        verdict: Some("fail".into()),
        ..operate(7.0, 8.0)
    };
    let late = Filter {
        since: Some(Moment(5)),
        bin: Some("coil".into()),
        ..lot.clone()
    };
    for filter in [operate(7.0, 8.0), lot, late] {
        let plan = plan(&file, &filter.parts(Dialect::File));
        assert!(plan.contains("measurement_value (parameter_id=? AND population=? AND run_id=? AND part_verdict=? AND value>? AND value<?)"), "{plan}");
        assert!(
            plan.contains("SEARCH part USING INTEGER PRIMARY KEY"),
            "{plan}"
        );
        assert!(!plan.contains("TEMP B-TREE"), "sorted as found:\n{plan}");
    }
}

/// Returns the statement for the rows of some parts in a table.
fn of_parts(select: &str, table: &str, order: &str) -> String {
    let parts: Vec<Part> = (1..=3).map(|seq| Part::fixture("A", seq, "pass")).collect();
    let parts: Vec<&Part> = parts.iter().collect();
    details::of_parts(Dialect::File, (select, table, order), &parts).0
}

#[test]
fn values_of_a_part_come_from_their_index() {
    let file = File::new();
    let _store = filled(&file, 10);
    let values = of_parts(details::VALUES, "m", "m.part_id, m.parameter_id, m.attempt");
    let plan = explained(&file.by_hand(), &values);
    assert!(
        plan.contains("SEARCH m USING COVERING INDEX measurement_part (part_id=?)"),
        "{plan}"
    );
    assert!(!plan.contains("TEMP B-TREE"), "sorted as found:\n{plan}");
}

#[test]
fn statistics_read_the_index_alone() {
    let file = File::new();
    let _store = filled(&file, 10);
    let plan = plan(
        &file,
        &Filter::default().series("operate_voltage_v", Dialect::File),
    );
    assert!(
        plan.contains("SEARCH m USING COVERING INDEX measurement_value"),
        "{plan}"
    );
    let plan = explained(&file.by_hand(), series::OF_RUN);
    assert!(
        plan.contains("SEARCH measurement USING COVERING INDEX measurement_value"),
        "{plan}"
    );
}

#[test]
fn parts_are_found_by_an_index_of_their_own() {
    let file = File::new();
    let _store = filled(&file, 10);
    let base = Filter::default;
    let some = |text: &str| Some(text.to_owned());
    let cases = [
        (
            Filter {
                lot: some("A"),
                verdict: some("fail"),
                ..base()
            },
            "part_run_verdict",
        ),
        (
            Filter {
                lot: some("A"),
                bin: some("coil"),
                ..base()
            },
            "part_run_bin",
        ),
        (
            Filter {
                since: Some(Moment(5)),
                until: Some(Moment(9)),
                ..base()
            },
            "part_time",
        ),
    ];
    for (filter, index) in cases {
        let plan = plan(&file, &filter.parts(Dialect::File));
        assert!(
            plan.contains(index) && !plan.contains("SCAN part"),
            "{index}:\n{plan}"
        );
    }
}

/// Tables that grow with the number of parts.
const GROWING: [&str; 7] = [
    "part",
    "measurement",
    "reason",
    "sample",
    "curve",
    "series",
    "m",
];

fn scans_a_growing_table(plan: &str) -> bool {
    let scans = |table: &str| {
        plan.lines().any(|line| {
            line == format!("SCAN {table}") || line.starts_with(&format!("SCAN {table} "))
        })
    };
    GROWING.into_iter().any(scans)
}

#[test]
fn no_query_scans_a_growing_table() {
    let file = File::new();
    let _store = filled(&file, 10);
    let of_lot = Filter {
        lot: Some("A".into()),
        ..Filter::default()
    };
    let of_run = Filter {
        run: Some(1),
        recipe: Some("jzc-22f-012".into()),
        ..of_lot.clone()
    };
    let of_span = Filter {
        since: Some(Moment(5)),
        until: Some(Moment(9)),
        ..Filter::default()
    };
    let bin = Some("coil".to_owned());
    let of_bin = Filter {
        bin: bin.clone(),
        ..of_lot.clone()
    };
    let page = Filter {
        limit: Some(20),
        offset: Some(40),
        ..of_lot.clone()
    };
    let late_in_bin = Filter {
        bin,
        ..of_span.clone()
    };
    for filter in [of_lot, of_run, of_span, of_bin, page, late_in_bin] {
        for select in [
            filter.parts(Dialect::File),
            filter.count(Dialect::File),
            filter.cycles(),
            filter.lot_yield(),
            filter.series("operate_voltage_v", Dialect::File),
        ] {
            let plan = plan(&file, &select);
            assert!(!scans_a_growing_table(&plan), "{}\n{plan}", select.sql);
        }
    }
    let valued = plan(&file, &operate(7.0, 8.0).count(Dialect::File));
    assert!(!scans_a_growing_table(&valued), "{valued}");
}

#[test]
fn rows_of_a_part_are_found_by_key() {
    let file = File::new();
    let _store = filled(&file, 10);
    let by_hand = file.by_hand();
    let fixed = [
        curve::CURVES,
        batches::SIGNALS,
        lots::YIELD,
        lots::COUNTS,
        values::LIMITS,
        series::PACKED,
        crate::scans::SCANS,
    ];
    let golden = filter::reference_part();
    let of_parts = [
        of_parts(details::VALUES, "m", "m.part_id, m.parameter_id, m.attempt"),
        of_parts(details::MEASUREMENTS, "m", "m.parameter_id, m.attempt"),
        of_parts(details::SAMPLES, "sample", "parameter_id, attempt, n"),
        of_parts(reasons::REASONS, "reason", "part_id, n"),
    ];
    let all = fixed.into_iter().chain([golden.as_str()]);
    let all = all.chain(of_parts.iter().map(String::as_str));
    for sql in all.chain(retention::EMPTYING) {
        let plan = explained(&by_hand, sql);
        let is_alarm = sql.contains("FROM alarm");
        assert!(plan.contains("SEARCH"), "{sql}\n{plan}");
        assert!(is_alarm || !scans_a_growing_table(&plan), "{sql}\n{plan}");
    }
}

#[test]
fn alarms_are_found_by_an_index() {
    let file = File::new();
    let _store = filled(&file, 10);
    let of_lot = Filter {
        lot: Some("A".into()),
        ..Filter::default()
    };
    let of_span = Filter {
        since: Some(Moment(5)),
        ..Filter::default()
    };
    for (filter, index) in [(of_lot, "alarm_run"), (of_span, "alarm_once")] {
        let plan = plan(&file, &filter.alarms());
        let found = plan.contains(&format!("SEARCH alarm USING INDEX {index}"));
        assert!(found, "{index}:\n{plan}");
    }
}

#[test]
fn a_scan_of_a_growing_table_is_seen() {
    let file = File::new();
    let _store = filled(&file, 10);
    let plan = explained(
        &file.by_hand(),
        "SELECT count(*) FROM part WHERE reasons = ?1",
    );
    assert!(scans_a_growing_table(&plan), "{plan}");
}
