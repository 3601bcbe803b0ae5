//! Tests of the outcome of the parts: bins, verdicts and exceptions.

use super::super::bins::{bin_of, defects, lots_without_reject, machine, outcome};
use super::super::exception;
use super::super::lot::Lot;
use super::{SUMMARY, figure, lot, near, row, three_good_one_bad, truth};
use machine::dut::em_relay::Parameter;
use serde_json::{Value, json};

#[test]
fn the_outcome_counts_rejects_passes_and_misplaced_bodies() {
    let rows = [
        row(1, "fail", "voltage", 8.0),
        row(2, "void", "retest", 8.0),
        row(3, "pass", "pass", 8.0),
        row(4, "fail", "coil", 8.0),
    ];
    let truths = [
        truth(1, None, "voltage", 8.0),
        truth(2, None, "retest", 8.0),
        truth(3, Some("slow"), "pass", 8.0),
        truth(4, Some("open_coil"), "pass", 8.0),
        truth(5, None, "pass", 8.0),
    ];
    let figures = outcome(&[lot(&rows, &truths)]);
    near(figure(&figures, "good parts rejected").value, 1.0);
    near(figure(&figures, "voids of good parts").value, 50.0);
    near(figure(&figures, "defective parts passed").value, 2.0);
    near(
        figure(&figures, "rows whose bin is not where the part is").value,
        1.0,
    );
    near(figure(&figures, "parts without a row").value, 1.0);
}

#[test]
fn a_row_without_a_truth_is_not_good() {
    let it = lot(&[row(1, "pass", "pass", 8.0)], &[]);
    assert_eq!(it.good().count(), 0);
    let figures = outcome(&[it]);
    assert_eq!(
        figure(&figures, "rows whose bin is not where the part is").met(),
        Some(false)
    );
    assert_eq!(
        figure(&figures, "defective parts passed").met(),
        Some(false)
    );
}

#[test]
fn incomplete_lots_of_a_hundred_count_only_alone() {
    let mut rejected = vec![false; 250];
    rejected[120] = true;
    rejected[249] = true;
    assert_eq!(lots_without_reject(&rejected), (1, 2));
    assert_eq!(lots_without_reject(&[false, true]), (0, 1));
    assert_eq!(lots_without_reject(&[]), (0, 0));
}

#[test]
fn a_defect_in_the_wrong_bin_misses_its_bar() {
    let rows = [
        row(1, "fail", "time", 8.0),
        row(2, "fail", "coil", 8.0),
        row(3, "void", "retest", 8.0),
    ];
    let truths = [
        truth(1, Some("weak_spring"), "time", 8.0),
        truth(2, Some("odd"), "coil", 8.0),
        truth(3, Some("turned"), "retest", 8.0),
    ];
    let found = defects(&[lot(&rows, &truths)]);
    let met: Vec<_> = found
        .iter()
        .map(|it| (it.name.as_str(), it.met()))
        .collect();
    assert_eq!(
        met,
        [
            ("odd in no known bin", Some(false)),
            ("turned in retest", Some(true)),
            ("weak_spring in voltage", Some(false))
        ]
    );
    assert_eq!(bin_of("bouncing"), Some("time"));
}

#[test]
fn uncounted_eeprom_writes_miss_the_bar() {
    let mut it = three_good_one_bad();
    assert!(
        machine(std::slice::from_ref(&it))
            .iter()
            .all(|figure| figure.met() == Some(true))
    );
    it.summary.eeprom_writes = None;
    assert_eq!(
        figure(&machine(&[it]), "EEPROM writes during the lots").met(),
        Some(false)
    );
}

#[test]
fn a_torn_row_is_refused_with_its_line() {
    let error = |rows: &str, truth: &str| format!("{:#}", Lot::read(1, rows, truth).unwrap_err());
    assert!(error("", "").contains("no summary"));
    assert!(error("{\"type\":\"part\"", "").contains("rows, line 1"));
    assert!(error(SUMMARY, "{\"seq\":1}\nx").contains("truth, line 2"));
}

#[test]
fn a_wrongly_judged_part_is_named_with_its_seed() {
    let mut rejected = row(1, "fail", "voltage", 8.0);
    rejected["reasons"] = json!(["not proven"]);
    let rows = [
        rejected,
        row(2, "pass", "pass", 8.0),
        row(3, "fail", "time", 8.0),
    ];
    let truths = [
        truth(1, None, "voltage", 8.0),
        truth(2, None, "pass", 8.0),
        truth(3, Some("slow"), "time", 8.0),
    ];
    let notes = exception::outcome(&[lot(&rows, &truths)]);
    assert_eq!(
        notes,
        ["seed 1 part 1: good, fail, row says voltage, lies in voltage, because not proven"]
    );
}

#[test]
fn a_long_list_of_parts_is_cut() {
    let rows: Vec<Value> = (1..=23).map(|seq| row(seq, "fail", "coil", 8.0)).collect();
    let truths: Vec<Value> = (1..=23).map(|seq| truth(seq, None, "coil", 8.0)).collect();
    let notes = exception::outcome(&[lot(&rows, &truths)]);
    assert_eq!((notes.len(), notes[20].as_str()), (21, "and 3 more"));
}

#[test]
fn slow_parts_are_named_with_both_times() {
    let notes = exception::slow(&[three_good_one_bad()], 0.4, 2.5);
    assert_eq!(notes.len(), 4);
    assert!(
        notes[0].ends_with("test 0.500 s, cycle 2.000 s"),
        "{}",
        notes[0]
    );
    assert!(exception::slow(&[three_good_one_bad()], 0.5, 2.0).is_empty());
}

#[test]
fn a_part_beyond_a_limit_is_rightly_rejected() {
    let rows = [
        row(1, "fail", "voltage", 9.1),
        row(2, "pass", "pass", 9.0),
        row(3, "pass", "pass", 9.0),
    ];
    let truths = [
        truth(1, None, "voltage", 9.1),
        truth(2, None, "pass", 9.0),
        truth(3, None, "pass", 9.001),
    ];
    let mut it = lot(&rows, &truths);
    it.mark_out_of_limits(&[(Parameter::OperateVoltage.into(), f64::NEG_INFINITY..=9.0)]);
    let notes = exception::outcome(std::slice::from_ref(&it));
    assert_eq!(notes.len(), 1);
    assert!(
        notes[0].starts_with("seed 1 part 3: beyond a limit, pass"),
        "{}",
        notes[0]
    );
    let figures = outcome(&[it]);
    let rejected = figure(&figures, "good parts rejected");
    assert_eq!((rejected.n, rejected.value), (1, Some(0.0)));
    let beyond = figure(&figures, "no defect, but truly beyond a limit");
    assert_eq!(
        (beyond.value, beyond.more[0], beyond.met()),
        (Some(2.0), ("passed", Some(1.0)), None)
    );
}
