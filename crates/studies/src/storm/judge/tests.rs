//! Tests that the rules find errors: one sound case, and one planted error for each rule.

#![allow(clippy::unwrap_used)]

use super::Case;
use crate::storm::life::{EPOCH_US, End, EndedLife};
use crate::storm::operator::Answered;
use app::exit::{Cause, Exit};
use history::{Alarm, AlarmState, Moment, Part};
use machine::dut::em_relay::Parameter;
use rigsim::truth::{BodyTruth, ContactMove, Overdrive, PartTruth, Place};
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

fn life(lot: &str, from_s: u64, to_s: u64, end: End) -> EndedLife {
    EndedLife {
        lot: lot.into(),
        began_us: from_s * S,
        ended_us: to_s * S,
        end,
        answers: Vec::new(),
    }
}

fn answers(order: &str, at_s: u64) -> Answered {
    Answered {
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

fn contactor(moves: &[(u64, bool)]) -> Vec<ContactMove> {
    let moves = moves.iter().map(|(t_us, closed)| ContactMove {
        t_us: *t_us,
        contactor: "line_contactor",
        closed: *closed,
    });
    moves.collect()
}

/// Returns a case of two lives that breaks no rule. The first tests a good part, drops another one and declares it; the
/// operator aborts and the program ends. The second life completes.
fn sound() -> Case {
    let mut first = life("one", 0, 20, End::Exit(Exit::Trouble(Cause::aborted())));
    first.answers = vec![answers("abort", 18)];
    Case {
        lives: vec![first, life("two", 30, 60, End::Exit(Exit::Done))],
        bodies: vec![
            body(&way(1, Place::Bin("pass".into())), None),
            body(&way(7, Place::Floor), Some("weak_spring")),
            body(&way(35, Place::Bin("voltage".into())), Some("weak_spring")),
        ],
        driven: vec![(S, "escapement"), (17 * S, "sort_axis"), (31 * S, "sort_z")],
        touched: Vec::new(),
        overdrives: Vec::new(),
        contact_moves: contactor(&[
            (10 * S, true),
            (11 * S, false),
            (40 * S, true),
            (41 * S, false),
        ]),
        hold_us: 3 * S,
        welded_us: Vec::new(),
        watchdog: Span::ms(1_000),
        rows: vec![
            row("one", 1, 3, "pass", "pass", Some(7)),
            row("one", 2, 9, "fail", "voltage", None),
            row("two", 1, 37, "fail", "voltage", Some(41)),
        ],
        alarms: vec![alarm("one", "part_dropped", 13)],
        limits: vec![(Parameter::CoilResistance.into(), 360.0..=440.0)],
        faults: Vec::new(),
        disturbed_us: vec![22 * S],
        reaction: Span::ms(250),
        reaction_in_trouble: Span::ms(2_250),
        lines_disturbed: false,
    }
}

/// Checks that every broken rule of the sound case with a planted error contains `words`.
fn found(plant: impl FnOnce(&mut Case), words: &str) {
    let mut case = sound();
    plant(&mut case);
    let violations = case.violations();
    assert!(!violations.is_empty(), "not found: {words}");
    for one in violations {
        assert!(one.contains(words), "{one}\nexpected: {words}");
    }
}

#[test]
fn a_sound_case_breaks_no_rule() {
    assert_eq!(sound().violations(), Vec::<String>::new());
}

#[test]
fn bodies_that_touched_are_found() {
    found(
        |case| case.touched.push("pusher and probes".into()),
        "bodies touched: pusher and probes",
    );
}

#[test]
fn an_overdriven_coil_is_found() {
    let overdrive = Overdrive {
        t_us: 5_250_000,
        commanded: 1,
        range: 3,
        supply_v: 48.0,
    };
    found(
        |case| case.overdrives.push(overdrive),
        "coil overdriven: 48.00 V at 5.250 s, supply range 3 in place of 1",
    );
}

#[test]
fn a_row_with_another_bin_is_found() {
    found(
        |case| case.bodies[0].path[3].1 = Place::Bin("coil".into()),
        "lies in coil, row 1 of one says pass",
    );
}

#[test]
fn a_missing_row_is_found() {
    found(
        |case| drop(case.rows.remove(2)),
        "lies in voltage since 40.000 s without a row",
    );
}

#[test]
fn a_row_written_twice_is_found() {
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
fn a_row_without_a_body_is_found() {
    found(
        |case| case.rows.push(row("two", 2, 55, "void", "retest", None)),
        "has no body",
    );
}

#[test]
fn a_landing_without_a_confirmation_is_found() {
    let forget = |case: &mut Case| {
        case.rows[2].landed_bin = None;
    };
    found(forget, "its row has no landing");
}

#[test]
fn the_next_life_declares_a_part_lost_at_kill() {
    let mut case = sound();
    case.lives[0].ended_us = 6 * S - 1;
    case.lives[0].end = End::Killed;
    case.lives[1].began_us = 6 * S;
    case.lives[0].answers.clear();
    case.bodies = vec![body(&way(1, Place::Bin("pass".into())), None)];
    case.bodies[0].path.insert(3, (6 * S - 2, Place::Air));
    case.rows.truncate(1);
    (case.rows[0].landed_bin, case.rows[0].landed_at) = (None, None);
    (case.alarms, case.driven, case.disturbed_us) = (Vec::new(), Vec::new(), Vec::new());
    assert!(case.violations()[0].contains("its row has no landing"));
    case.alarms.push(alarm("two", "part_lost", 8));
    assert_eq!(case.violations(), Vec::<String>::new());
}

#[test]
fn a_late_alarm_declares_no_earlier_loss() {
    let mut case = sound();
    case.lives[0].ended_us = 14 * S;
    case.lives[0].end = End::Killed;
    case.lives[0].answers.clear();
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
        let violations = case.violations();
        let is_found = |it: &String| it.contains("lies on the floor since 12.000 s");
        assert_eq!(
            !violations.iter().any(is_found),
            declared,
            "{lot}: {violations:?}"
        );
    }
}

#[test]
fn an_undeclared_part_on_the_floor_is_found() {
    found(
        |case| case.alarms[0].code = "door_open".into(),
        "lies on the floor since 12.000 s and no alarm declares it",
    );
}

#[test]
fn a_landed_row_of_a_fallen_part_is_found() {
    found(
        |case| case.rows[1].landed_bin = Some("voltage".into()),
        "its row says Some(\"voltage\")",
    );
}

#[test]
fn a_second_body_without_a_beam_alarm_is_found() {
    let mut case = sound();
    let mut second = body(&way(1, Place::Bin("pass".into())), None);
    second.clung = true;
    case.bodies.insert(1, second);
    let violations = case.violations();
    assert_eq!(violations.len(), 1, "{violations:?}");
    assert!(violations[0].contains("second body") && violations[0].contains("came into pass"));
    for (code, bin, is_reported) in [
        ("bin_beam", "pass", true),
        ("bin_beam", "coil", false),
        ("part_dropped", "pass", false),
    ] {
        let mut case = case.clone();
        let mut one = alarm("one", code, 7);
        one.args = one.args.with("bin", bin);
        case.alarms.insert(0, one);
        assert_eq!(case.violations().is_empty(), is_reported, "{bin}");
    }
}

#[test]
fn an_alarm_while_the_fingers_open_declares_both_bodies() {
    for (opening_us, is_declared) in [(200_000, true), (400_000, false)] {
        let mut case = sound();
        let mut second = body(&way(1, Place::Bin("pass".into())), None);
        second.clung = true;
        let fell_us = 5 * S + opening_us;
        second.path.insert(3, (fell_us, Place::Air));
        case.bodies.insert(1, second);
        let mut one = alarm("one", "bin_beam", 5);
        one.args = one.args.with("bin", "pass");
        case.alarms.insert(0, one);
        assert_eq!(case.violations().is_empty(), is_declared, "{opening_us} us");
    }
}

#[test]
fn a_part_left_inside_is_found() {
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
        |case| case.limits[0].1 = 360.0..=390.0,
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
fn a_defect_in_the_wrong_bin_is_found() {
    found(
        |case| case.bodies[2].part.defect = Some("slow"),
        "slow belongs to time, its row says voltage",
    );
}

#[test]
fn a_motion_with_an_open_safety_input_is_found() {
    let open = |case: &mut Case| case.disturbed_us.push(14 * S + 500_000);
    found(
        open,
        "sort_axis was driven at 17.000 s while a safety input was open since 14.500 s",
    );
}

#[test]
fn a_motion_between_abort_and_reset_is_found() {
    found(
        |case| case.driven.push((19 * S, "pusher")),
        "pusher was driven at 19.000 s after the abort ordered at 18.000 s",
    );
    let mut case = sound();
    case.lives[0].answers.push(answers("reset", 19));
    case.driven.push((19 * S + 1, "pusher"));
    assert_eq!(
        case.violations(),
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
fn a_life_that_ends_badly_is_found() {
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
fn a_production_that_stays_down_is_found() {
    let held = |case: &mut Case| {
        case.lives[1].end = End::Exit(Exit::Trouble(Cause::aborted()));
        case.alarms.push(alarm("two", "bus_trouble", 59));
    };
    found(held, "production did not resume");
}

#[test]
fn a_contactor_that_stays_closed_is_found() {
    let closed = |from: u64, to: u64| contactor(&[(from, true), (to, false)]);
    found(
        |case| case.contact_moves = closed(19 * S, 21 * S + 11_000),
        "line_contactor was closed after the end of one",
    );
    found(
        |case| case.contact_moves = contactor(&[(59 * S, true)]),
        "line_contactor was closed after the end of two",
    );
    found(
        |case| {
            case.disturbed_us = vec![40 * S];
            case.contact_moves = closed(39 * S, 40 * S + 270_000);
        },
        "line_contactor was closed while a safety input was open",
    );
    let mut restarted = sound();
    restarted.lives[1].began_us = 20 * S + 500_000;
    restarted.disturbed_us = Vec::new();
    restarted.contact_moves = closed(19 * S, 21 * S + 11_000);
    assert_eq!(restarted.violations(), Vec::<String>::new());
    let mut welded = sound();
    welded.contact_moves = closed(19 * S, 22 * S);
    welded.welded_us = vec![19 * S + 500_000];
    assert_eq!(welded.violations(), Vec::<String>::new());
}
