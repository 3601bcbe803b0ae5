//! Tests of figures of rig time and wall time.

use super::super::cycle::{pieces, times};
use super::super::pace::{profile, same_bytes};
use super::{figure, lot, near, row, three_good_one_bad, truth};
use serde_json::{Value, json};

#[test]
fn the_pieces_add_up_to_the_cycle() {
    let mut part = row(1, "pass", "pass", 8.0);
    part["spent"] = json!({"bus_s": 0.1, "settling_s": 0.05, "conversion_s": 0.2, "ramp_s": 0.1});
    let lots = [lot(&[part], &[truth(1, None, "pass", 8.0)])];
    let found = pieces(&lots);
    near(figure(&found, "test: rest").value, 0.05);
    near(figure(&found, "mechanics outside the test").value, 1.5);
    let whole = figure(&found, "cycle").value;
    near(
        whole,
        found
            .iter()
            .filter(|it| it.name != "cycle")
            .filter_map(|it| it.value)
            .sum(),
    );
}

#[test]
fn rows_without_pieces_give_test_and_mechanics() {
    let found = pieces(&[three_good_one_bad()]);
    let names: Vec<&str> = found.iter().map(|it| it.name.as_str()).collect();
    assert_eq!(names, ["cycle", "mechanics outside the test", "test"]);
}

#[test]
fn the_bar_applies_to_the_longest_test() {
    let mut long = row(2, "fail", "voltage", 8.0);
    long["test_s"] = json!(1.2);
    let truths = [
        truth(1, None, "pass", 8.0),
        truth(2, Some("weak_spring"), "voltage", 8.0),
    ];
    let found = times(&[lot(&[row(1, "pass", "pass", 8.0), long], &truths)], 0.85);
    assert_eq!(
        figure(&found, "test, longest of good parts").met(),
        Some(true)
    );
    let all = figure(&found, "test, longest of all parts");
    near(all.value, 1.2);
    assert_eq!(
        (all.met(), all.more[2]),
        (Some(false), ("over_bar_pct", Some(50.0)))
    );
}

#[test]
fn a_repeat_with_other_bytes_is_counted() {
    let (a, mut b) = (three_good_one_bad(), three_good_one_bad());
    assert_eq!(same_bytes(&[a.clone(), b.clone()]).met(), Some(true));
    b.summary.bytes.insert("measure".into(), "b2".into());
    near(same_bytes(&[a.clone(), b.clone(), b.clone()]).value, 1.0);
    b.summary.bytes.clear();
    assert_eq!(same_bytes(&[a, b]).met(), Some(false));
}

#[test]
fn the_first_parts_of_a_lot_count_apart() {
    let with_test = |seq: u64| {
        let mut row = row(seq, "pass", "pass", 8.0);
        row["test_s"] = json!(if seq == 6 { 1.05 } else { 0.7 });
        row
    };
    let rows: Vec<Value> = (1..=8).map(with_test).collect();
    let truths: Vec<Value> = (1..=8).map(|seq| truth(seq, None, "pass", 8.0)).collect();
    let found = times(&[lot(&rows, &truths)], 0.85);
    let first = figure(&found, "  of the first 6 of a lot, which teach");
    assert_eq!((first.n, first.met()), (6, Some(false)));
    let after = figure(&found, "  of those after them");
    assert_eq!((after.n, after.met()), (2, Some(true)));
}

#[test]
fn the_wall_profile_is_a_mean_over_runs() {
    let (mut a, mut b) = (three_good_one_bad(), three_good_one_bad());
    (a.wall_s, b.wall_s) = (4.0, 4.0);
    a.summary.wall_profile = [("rig".into(), 1.0), ("history".into(), 0.5)].into();
    b.summary.wall_profile = [("rig".into(), 3.0)].into();
    let found = profile(&[a, b]);
    assert_eq!(found[0].name, "wall: rig");
    near(found[0].value, 2.0);
    assert_eq!(found[0].more[0], ("share_pct", Some(50.0)));
    near(found[1].value, 0.25);
}
