//! Tests: files of earlier schemas, and which runs may be pruned.

use super::super::open::{MIGRATIONS, SCHEMA};
use super::*;

/// Reasons of a part that failed and was interrupted, as programs before schema 8 stored them.
const TEXTS: [&str; 5] = [
    "operate_voltage_v high not proven",
    "coil_resistance_ohm low: current over range",
    "no Kelvin contact at COM: missing pin or dirty probe",
    "interrupted: door_open",
    "refused by the clerk",
];

/// Makes a file as the program of that schema left it: a closed run with one measured part and one void part.
fn of_schema(file: &File, schema: usize) {
    let by_hand = file.by_hand();
    for step in &MIGRATIONS[..schema] {
        by_hand.execute_batch(step).unwrap();
    }
    by_hand
        .execute_batch(&format!(
            "PRAGMA application_id = {APPLICATION_ID}; PRAGMA user_version = {schema};
             INSERT INTO lot VALUES (1, '批次', 5);
             INSERT INTO recipe VALUES (1, 'hash', 'jzc-22f-012', 'body', 5);
             INSERT INTO run (id, lot_id, number, recipe_id, opened_at_us, closed_at_us, source, written_by)
               VALUES (1, 1, 1, 1, 5, 9, 'rig', 'relayrig of old');
             INSERT INTO part (id, run_id, kind, seq, verdict, bin, reasons, judged_at_us)
               VALUES (1, 1, 'lot', 1, 'pass', 'pass', '[]', 7);
             INSERT INTO measurement (part_id, parameter_id, attempt, value, verdict, run_id, part_verdict,
               population) VALUES (1, 2, 1, 7.5, 'pass', 1, 'pass', 'lot');"
        ))
        .unwrap();
    by_hand
        .execute(
            "INSERT INTO part (id, run_id, kind, seq, verdict, bin, reasons, judged_at_us)
             VALUES (2, 1, 'lot', 2, 'void', 'retest', ?1, 8)",
            [serde_json::json!(TEXTS)],
        )
        .unwrap();
    if schema >= 8 {
        super::super::reasons::read_texts(&by_hand).unwrap();
    }
    if schema >= 11 {
        let rig = "INSERT INTO rig (id, source) VALUES (1, 'rig')";
        by_hand.execute_batch(rig).unwrap();
    }
}

#[test]
fn a_migrated_file_keeps_rows_and_takes_new_ones() {
    for schema in 1..MIGRATIONS.len() {
        let file = File::new();
        of_schema(&file, schema);
        let archive = file.archive();
        let parts = archive.query(&Filter::default()).unwrap();
        assert_eq!(parts.len(), 2, "schema {schema}");
        assert_eq!(parts[1].reasons, TEXTS);
        assert_eq!(parts[1].reason_codes, TEXTS.map(Reason::from_text));
        assert_eq!(
            (parts[0].lot.as_str(), &parts[0].values["operate_voltage_v"]),
            ("批次", &7.5.into())
        );
        let values = archive.values("operate_voltage_v", &Filter::default());
        assert_eq!(values.unwrap().values, [7.5]);
        let packed = i64::from(schema < 6);
        assert_eq!(
            count(&file.by_hand(), "series"),
            packed,
            "packed on the way to schema 6"
        );
        archive.check().unwrap();
        let mut store = file.store();
        assert!(store.begin_lot(&lot("批次")).is_err(), "simulated");
        let real = LotRecord {
            simulated: false,
            ..lot("批次")
        };
        assert_eq!(store.begin_lot(&real).unwrap(), 2);
        store
            .record(&[Row::Part(part("批次", 1, "pass", 7.6))])
            .unwrap();
        assert_eq!(store.pragma("user_version"), SCHEMA.to_string());
        assert_eq!(file.archive().count_parts(&Filter::default()).unwrap(), 3);
    }
}

#[test]
fn a_hold_of_an_older_file_keeps_its_text() {
    let file = File::new();
    of_schema(&file, 12);
    let held = "INSERT INTO lot_state (lot_id, state, why, since_us) VALUES (1, 'held', '3 of 20 failed', 8);
        INSERT INTO alarm (run_id, code, text, raised_at_us) VALUES (1, 'lot_discard_limit', '3 of 20 failed', 8);";
    file.by_hand().execute_batch(held).unwrap();
    let standing = file.archive().standing("批次").unwrap().unwrap();
    assert_eq!(standing.why.as_deref(), Some("3 of 20 failed"));
    assert_eq!(standing.why_zh, None);
}

#[test]
fn a_held_lot_stays_held_through_every_upgrade() {
    for schema in 3..MIGRATIONS.len() {
        let file = File::new();
        of_schema(&file, schema);
        let held = "INSERT INTO lot_state (lot_id, state, why, since_us) VALUES (1, 'held', 'wrong label', 8)";
        file.by_hand().execute_batch(held).unwrap();
        let mut store = file.store();
        store.cut_off(false, 9).unwrap();
        let standing = || file.archive().standing("批次").unwrap().unwrap();
        assert_eq!(standing().state, LotState::Held, "schema {schema}");
        assert_eq!(standing().why.as_deref(), Some("wrong label"));
        assert_eq!(file.archive().count_parts(&Filter::default()).unwrap(), 2);
        let released = LotStateRecord {
            lot: "批次".into(),
            state: LotState::Open,
            why: None,
            at_us: 10,
        };
        store.record(&[Row::LotState(released)]).unwrap();
        assert_eq!(standing().state, LotState::Open, "schema {schema}");
    }
}

#[test]
fn rows_of_an_older_file_name_its_rig() {
    let of = "INSERT INTO run (id, lot_id, number, recipe_id, opened_at_us, source, written_by)
        VALUES (2, 1, 2, 1, 5, 'simulated', 'relayrig of old');";
    let calibrated = "INSERT INTO calibration (hash, made_at_us, due_at_us, verified, body)
        VALUES ('x', 1, 2, 1, '{\"simulated\":true}');";
    let bare = "DELETE FROM measurement; DELETE FROM reason; DELETE FROM part; DELETE FROM run;";
    for (change, expected) in [
        ("", Some("rig")),
        (of, Some("rig")),
        (&format!("{bare}{of}"), Some("simulated")),
        (&format!("{bare}{calibrated}"), Some("simulated")),
        (bare, None),
    ] {
        let file = File::new();
        of_schema(&file, 10);
        file.by_hand().execute_batch(change).unwrap();
        file.archive();
        let found = file
            .by_hand()
            .query_row("SELECT source FROM rig", [], |row| row.get::<_, String>(0));
        assert_eq!(found.ok().as_deref(), expected, "{change}");
    }
}

#[test]
fn texts_without_codes_migrate_into_reason_rows() {
    let file = File::new();
    of_schema(&file, 7);
    file.archive();
    let by_hand = file.by_hand();
    let mut rows = by_hand
        .prepare(
            "SELECT seq, n, code, ifnull(parameter, ''), ifnull(side, ''), detail FROM reasons",
        )
        .unwrap();
    let rows: Vec<(i64, i64, String, String, String, String)> = rows
        .query_map([], |row| row.try_into())
        .unwrap()
        .collect::<rusqlite::Result<_>>()
        .unwrap();
    let row = |n, code: &str, parameter: &str, side: &str, detail: &str| {
        let [code, parameter, side, detail] = [code, parameter, side, detail].map(str::to_owned);
        (2, n, code, parameter, side, detail)
    };
    let expected = [
        row(1, "not_proven", "operate_voltage_v", "high", ""),
        row(
            2,
            "coil_current_over_range",
            "coil_resistance_ohm",
            "low",
            "",
        ),
        row(3, "pin_open", "", "", "COM"),
        row(4, "interrupted", "", "", "door_open"),
        row(5, "unclassified", "", "", "refused by the clerk"),
    ];
    assert_eq!(rows, expected);
}

#[test]
fn texts_beyond_one_batch_are_all_read() {
    let file = File::new();
    of_schema(&file, 7);
    let more =
        "WITH RECURSIVE n (seq) AS (SELECT 3 UNION ALL SELECT seq + 1 FROM n WHERE seq < 2600)
        INSERT INTO part (run_id, kind, seq, verdict, reasons, judged_at_us)
        SELECT 1, 'lot', seq, 'fail', '[\"coil open\"]', 8 FROM n";
    file.by_hand().execute(more, []).unwrap();
    file.archive();
    let read = 2600 - 2 + TEXTS.len() as i64;
    assert_eq!(count(&file.by_hand(), "reason"), read);
}

#[test]
fn what_was_not_copied_whole_is_never_pruned() {
    let file = File::new();
    let mut store = filled(&file, 3);
    assert_eq!(
        store
            .record_export(&Filter::default(), "copy.db", 10)
            .unwrap(),
        0,
        "it is open"
    );
    store.close_lot("A", 20).unwrap();
    store.begin_lot(&lot("B")).unwrap();
    store
        .record(&[Row::Part(part("B", 1, "pass", 7.0))])
        .unwrap();
    store.close_lot("B", 30).unwrap();
    assert!(store.prunable(i64::MAX).unwrap().is_empty());
    let only_a = Filter {
        lot: Some("A".into()),
        ..Filter::default()
    };
    assert_eq!(store.record_export(&only_a, "copy.db", 40).unwrap(), 1);
    assert!(store.prunable(20).unwrap().is_empty(), "it ended later");
    let mut done = Vec::new();
    store
        .prune(i64::MAX, 50, |run| done.push(run.clone()))
        .unwrap();
    assert_eq!(done.len(), 1);
    assert_eq!(
        (done[0].lot.as_str(), done[0].parts, done[0].file.as_str()),
        ("A", 3, "copy.db")
    );
    let archive = file.archive();
    assert_eq!(count(&file.by_hand(), "series"), 2, "of lot B alone");
    let left = archive.values("operate_voltage_v", &Filter::default());
    assert_eq!(left.unwrap().values, [7.0]);
    assert_eq!(archive.count_parts(&Filter::default()).unwrap(), 1);
    assert_eq!(
        archive.lots(&Filter::default()).unwrap().len(),
        2,
        "the runs stay"
    );
    archive.check().unwrap();
    assert!(store.prunable(i64::MAX).unwrap().is_empty());
    assert_eq!(store.begin_lot(&lot("A")).unwrap(), 2, "numbers go on");
}
