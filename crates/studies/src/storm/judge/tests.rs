//! A storm that finds nothing must be able to find: one sound case, and an error planted for each rule.

#![allow(clippy::unwrap_used)]

use super::Case;
use crate::storm::life::{EPOCH_US, End, Lived};
use crate::storm::operator::Said;
use app::exit::{Cause, Exit};
use history::{Alarm, AlarmState, Moment, Part};
use rigsim::truth::{BodyTruth, PartTruth, Place};
use serde_json::json;
use units::{RigTime, Span};

const S: u64 = 1_000_000;

fn at(seconds: u64) -> Moment {
    Moment(EPOCH_US + i64::try_from(seconds * S).unwrap())
}

fn row(
    lot: &str,
    seq: u64,
    judged_s: u64,
    verdict: &str,
    bin: &str,
    landed_s: Option<u64>,
) -> Part {
    let mut row = Part::fixture(lot, seq, verdict);
    row.time = at(judged_s);
    row.bin = Some(bin.to_owned());
    row.test_s = Some(0.7);
    row.landed_bin = landed_s.map(|_| bin.to_owned());
    row.landed_at = landed_s.map(at);
    let values = json!({"coil_resistance_ohm": 400.2});
    row.values = values.as_object().unwrap().clone();
    let uncertainty = json!({"coil_resistance_ohm": 0.6});
    row.uncertainty = uncertainty.as_object().unwrap().clone();
    row
}

fn body(path: &[(u64, Place)], defect: Option<&'static str>) -> BodyTruth {
    BodyTruth {
        is_reference: false,
        clung: false,
        path: path
            .iter()
            .map(|(s, place)| (s * S, place.clone()))
            .collect(),
        part: PartTruth {
            coil_resistance_ohm: Some(400.0),
            defect,
            ..PartTruth::default()
        },
    }
}

fn way(from_s: u64, last: Place) -> Vec<(u64, Place)> {
    vec![
        (from_s, Place::Pocket),
        (from_s + 1, Place::Nest),
        (from_s + 3, Place::Gripper),
        (from_s + 5, last),
    ]
}

fn life(lot: &str, from_s: u64, to_s: u64, end: End) -> Lived {
    Lived {
        lot: lot.into(),
        began_us: from_s * S,
        ended_us: to_s * S,
        end,
        said: Vec::new(),
    }
}

fn said(order: &str, at_s: u64) -> Said {
    Said {
        at: RigTime(at_s * S),
        state: "Execute".into(),
        order: order.into(),
        refused: None,
    }
}

fn alarm(lot: &str, code: &str, raised_s: u64) -> Alarm {
    Alarm {
        lot: Some(lot.into()),
        run: Some(1),
        code: code.into(),
        line: None,
        text: code.into(),
        args: Default::default(),
        text_zh: None,
        cause_zh: None,
        raised: at(raised_s),
        cleared: None,
        acknowledged: None,
        acknowledged_by: None,
        shelf: None,
        state: AlarmState::Unacknowledged,
    }
}

/// Two lives. The first tests a good part and drops one on the way, which it tells; somebody aborts and the
/// program ends. The second one completes.
fn sound() -> Case {
    let mut first = life("one", 0, 20, End::Exit(Exit::Trouble(Cause::aborted())));
    first.said = vec![said("abort", 18)];
    Case {
        lives: vec![first, life("two", 30, 60, End::Exit(Exit::Done))],
        bodies: vec![
            body(&way(1, Place::Bin("pass".into())), None),
            body(&way(7, Place::Floor), Some("weak_spring")),
            body(&way(35, Place::Bin("voltage".into())), Some("weak_spring")),
        ],
        driven: vec![(S, "escapement"), (17 * S, "sort_axis"), (31 * S, "sort_z")],
        touched: Vec::new(),
        rows: vec![
            row("one", 1, 3, "pass", "pass", Some(7)),
            row("one", 2, 9, "fail", "voltage", None),
            row("two", 1, 37, "fail", "voltage", Some(41)),
        ],
        alarms: vec![alarm("one", "part_dropped", 13)],
        limits: vec![("coil_resistance_ohm", 360.0, 440.0)],
        faults: Vec::new(),
        disturbed_us: vec![22 * S],
        reaction: Span::ms(250),
        reaction_in_trouble: Span::ms(2_250),
        lines_suffer: false,
    }
}

/// The case with an error planted is found out, in these words and no others.
fn found(plant: impl FnOnce(&mut Case), words: &str) {
    let mut case = sound();
    plant(&mut case);
    let broken = case.broken();
    assert!(!broken.is_empty(), "not found: {words}");
    for one in broken {
        assert!(one.contains(words), "{one}\nexpected: {words}");
    }
}

#[test]
fn a_sound_case_breaks_no_rule() {
    assert_eq!(sound().broken(), Vec::<String>::new());
}

#[test]
fn bodies_that_touched_are_found() {
    found(
        |case| case.touched.push("pusher and probes".into()),
        "bodies touched: pusher and probes",
    );
}

#[test]
fn a_row_that_names_another_bin_than_the_bodys_is_found() {
    found(
        |case| case.bodies[0].path[3].1 = Place::Bin("coil".into()),
        "lies in coil, row 1 of one says pass",
    );
}

#[test]
fn a_row_that_is_gone_is_found() {
    found(
        |case| drop(case.rows.remove(2)),
        "lies in voltage since 40.000 s without a row",
    );
}

#[test]
fn a_row_that_was_written_twice_is_found() {
    found(
        |case| case.rows.insert(1, case.rows[0].clone()),
        "has 2 rows",
    );
}

#[test]
fn a_body_that_landed_by_two_rows_is_found() {
    let again = |case: &mut Case| {
        let mut other = case.rows[0].clone();
        other.lot = "two".into();
        case.rows.push(other);
    };
    found(again, "landed 2 times");
}

#[test]
fn a_row_of_nobody_is_found() {
    found(
        |case| case.rows.push(row("two", 2, 55, "void", "retest", None)),
        "is nobody's",
    );
}

#[test]
fn a_landing_that_the_row_does_not_know_is_found() {
    let forget = |case: &mut Case| {
        case.rows[2].landed_bin = None;
    };
    found(forget, "its row does not know it");
}

#[test]
fn a_part_that_fell_while_the_program_was_killed_is_told_by_the_one_that_comes_after() {
    let mut case = sound();
    case.lives[0].ended_us = 6 * S - 1;
    case.lives[0].end = End::Killed;
    case.lives[1].began_us = 6 * S;
    case.lives[0].said.clear();
    case.bodies = vec![body(&way(1, Place::Bin("pass".into())), None)];
    case.bodies[0].path.insert(3, (6 * S - 2, Place::Air));
    case.rows.truncate(1);
    (case.rows[0].landed_bin, case.rows[0].landed_at) = (None, None);
    (case.alarms, case.driven, case.disturbed_us) = (Vec::new(), Vec::new(), Vec::new());
    assert!(case.broken()[0].contains("its row does not know it"));
    case.alarms.push(alarm("two", "part_lost", 8));
    assert_eq!(case.broken(), Vec::<String>::new());
}

#[test]
fn what_a_run_tells_after_another_one_has_judged_parts_does_not_declare_an_earlier_loss() {
    let mut case = sound();
    case.lives[0].ended_us = 14 * S;
    case.lives[0].end = End::Killed;
    case.lives[0].said.clear();
    case.lives
        .push(life("three", 70, 90, End::Exit(Exit::Done)));
    for (lot, declared) in [("one", true), ("two", true), ("three", false)] {
        let mut case = case.clone();
        let raised_s = match lot {
            "one" => 13,
            "two" => 33,
            _ => 71,
        };
        case.alarms = vec![alarm(lot, "part_lost", raised_s)];
        let broken = case.broken();
        let is_found = |it: &String| it.contains("lies on the floor since 12.000 s");
        assert_eq!(!broken.iter().any(is_found), declared, "{lot}: {broken:?}");
    }
}

#[test]
fn a_part_on_the_floor_that_no_alarm_declares_is_found() {
    found(
        |case| case.alarms[0].code = "door_open".into(),
        "lies on the floor since 12.000 s and no alarm",
    );
}

#[test]
fn a_part_on_the_floor_whose_row_says_it_landed_is_found() {
    found(
        |case| case.rows[1].landed_bin = Some("voltage".into()),
        "its row says Some(\"voltage\")",
    );
}

#[test]
fn a_second_body_in_a_bin_that_no_beam_told_of_is_found() {
    let mut case = sound();
    let mut second = body(&way(1, Place::Bin("pass".into())), None);
    second.clung = true;
    case.bodies.insert(1, second);
    let broken = case.broken();
    assert_eq!(broken.len(), 1, "{broken:?}");
    assert!(broken[0].contains("second body") && broken[0].contains("came into pass"));
    for (code, bin, told) in [
        ("bin_beam", "pass", true),
        ("bin_beam", "coil", false),
        ("part_dropped", "pass", false),
    ] {
        let mut case = case.clone();
        let mut one = alarm("one", code, 7);
        one.args = one.args.with("bin", bin);
        case.alarms.insert(0, one);
        assert_eq!(case.broken().is_empty(), told, "{bin}");
    }
}

#[test]
fn a_part_that_was_left_inside_is_found() {
    found(
        |case| case.bodies.push(body(&[(45, Place::Pocket)], None)),
        "was left in Pocket",
    );
}

#[test]
fn a_value_of_another_part_is_found() {
    let other = json!({"coil_resistance_ohm": 395.0});
    found(
        |case| case.rows[0].values = other.as_object().unwrap().clone(),
        "cannot be of a part with 400",
    );
}

#[test]
fn a_defect_that_passed_is_found() {
    found(
        |case| case.bodies[0].part.defect = Some("weak_spring"),
        "passed with weak_spring",
    );
}

#[test]
fn a_part_that_passed_beyond_a_limit_is_found() {
    found(
        |case| case.limits[0].2 = 390.0,
        "passed with a true coil_resistance_ohm of 400",
    );
}

#[test]
fn a_good_part_that_failed_is_found() {
    found(
        |case| case.bodies[2].part.defect = None,
        "a good part failed",
    );
}

#[test]
fn a_defect_in_the_bin_of_another_cause_is_found() {
    found(
        |case| case.bodies[2].part.defect = Some("slow"),
        "slow belongs to time, its row says voltage",
    );
}

#[test]
fn a_motion_while_a_safety_input_is_open_is_found() {
    let open = |case: &mut Case| case.disturbed_us.push(14 * S + 500_000);
    found(
        open,
        "sort_axis was driven at 17.000 s while a safety input was open since 14.500 s",
    );
}

#[test]
fn a_motion_after_an_abort_and_before_the_reset_is_found() {
    found(
        |case| case.driven.push((19 * S, "pusher")),
        "pusher was driven at 19.000 s after the abort ordered at 18.000 s",
    );
    let mut case = sound();
    case.lives[0].said.push(said("reset", 19));
    case.driven.push((19 * S + 1, "pusher"));
    assert_eq!(
        case.broken(),
        Vec::<String>::new(),
        "after the reset it may move"
    );
}

#[test]
fn a_motion_without_a_controller_is_found() {
    found(
        |case| case.driven.push((28 * S, "gripper")),
        "gripper was driven at 28.000 s after the end of one at 20.000 s",
    );
}

#[test]
fn a_life_that_hangs_fails_or_ends_without_a_name_is_found() {
    found(|case| case.lives[0].end = End::Hung, "one never ended");
    found(
        |case| case.lives[0].end = End::Failed("disk".into()),
        "one could not go on: disk",
    );
    found(
        |case| case.lives[0].end = End::Exit(Exit::BadInput),
        "one ended with status 2",
    );
    let nameless = |case: &mut Case| {
        case.alarms.clear();
        case.bodies.remove(1);
        case.rows.remove(1);
    };
    found(nameless, "one ended in trouble that no alarm names");
}

#[test]
fn a_production_that_does_not_resume_is_found() {
    let held = |case: &mut Case| {
        case.lives[1].end = End::Exit(Exit::Trouble(Cause::aborted()));
        case.alarms.push(alarm("two", "bus_trouble", 59));
    };
    found(held, "production did not resume");
}
