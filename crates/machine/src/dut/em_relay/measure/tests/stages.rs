//! Conclusions on a moving armature: ramps, timed operation and release.

use super::super::board::{Armature, SentRamp};
use super::super::{Ramp, Stage, coil, fine, operate, release, timing};
use super::{PULLED, RESTING, assert_ends, at_23_c, context, drop_of, ended, gates, scan, watched};
use crate::dut::em_relay::act::Act;
use crate::dut::em_relay::bins;
use crate::dut::em_relay::contact::ContactDrop;
use crate::dut::em_relay::measure::ramp::Expected;
use crate::dut::em_relay::measure::{Context, TestState};
use crate::dut::em_relay::overshoot::{CoarseResults, OvershootModel};
use crate::dut::em_relay::points::DigitalOut;
use crate::dut::em_relay::readings::{BoardInputs, Readings};
use crate::dut::em_relay::threshold::Direction;
use crate::dut::em_relay::{Parameter, Strategy};
use crate::dut::verdict::Bin;
use crate::rig::sample::Quality;
use std::sync::Arc;
use units::{Span, Volt};

fn ramp_from(start: f64, span: f64) -> TestState {
    let mut state = at_23_c();
    state.board.ramp = Some(SentRamp {
        start: Volt(start),
        span: Volt(span),
        takes: Span(0),
    });
    state
        .plan
        .expect(Direction::Rising, Expected::new(Volt(7.9), 0.02));
    state
        .plan
        .expect(Direction::Falling, Expected::new(Volt(7.9), 0.02));
    state
}

#[test]
fn the_learned_overshoot_places_the_fine_ramp() {
    let mut state = ramp_from(5.0, 6.0);
    let readings = watched(true, PULLED, 40.0);
    let next = operate::conclude_coarse(&context(), &readings, &mut state);
    assert_eq!((next, ended(&state)), (None, None));
    let seen = 5.0 + 0.05 + 96.0 * 0.04;
    let coarse = state.record.own.operate.unwrap().coarse.indicated;
    assert!((coarse.0 - seen).abs() < 1e-9);
    let expected = state.plan.expected(Direction::Rising).unwrap();
    assert!((expected.centre.0 - (seen - 0.85)).abs() < 1e-9);
}

#[test]
fn a_coarse_ramp_without_make_means_high_threshold() {
    for (board, bin, word) in [
        (RESTING, bins::VOLTAGE, "above the coarse ramp"),
        (PULLED, Bin::RETEST, "outside the window"),
    ] {
        let mut state = ramp_from(5.0, 6.0);
        let silent = watched(false, board, 0.0);
        let next = operate::conclude_coarse(&context(), &silent, &mut state);
        assert_eq!(next, None);
        assert_ends(&state, bin, word);
    }
}

#[test]
fn an_unmoved_contact_is_stuck_unless_the_coil_fails() {
    let between = BoardInputs {
        nc_closed: false,
        ..RESTING
    };
    for (board, word) in [(RESTING, "NC does not open"), (between, "NO does not make")] {
        for (ampere, bin, word) in [
            (0.0125, bins::CONTACT, word),
            (0.0, bins::COIL, "coil open"),
        ] {
            let mut state = at_23_c();
            let unmoved = watched(false, board, 0.0);
            let next = timing::conclude_operate(&context(), &unmoved, &mut state);
            assert_eq!((next, ended(&state)), (Some(Stage::Coil), None));
            let readings = Readings {
                coil: vec![scan(5.0, ampere)],
                ..Readings::default()
            };
            coil::conclude(&context(), &readings, &mut state);
            assert_ends(&state, bin, word);
        }
    }
    let mut state = at_23_c();
    timing::conclude_operate(&context(), &Readings::default(), &mut state);
    assert_ends(&state, Bin::RETEST, "not read");
}

#[test]
fn a_fine_ramp_with_event_gives_the_threshold() {
    let mut state = ramp_from(7.8, 0.2);
    state.record.own.operate = Some(Ramp {
        coarse: state.record.coarse_results(Volt(8.8), Direction::Rising),
        fine: None,
    });
    let readings = watched(true, PULLED, 40.0);
    let next = fine::conclude(&context(), &readings, &mut state, (Direction::Rising, 0));
    assert_eq!((next, ended(&state)), (None, None));
    let result = state.record.result(Parameter::OperateVoltage).unwrap();
    assert!((result.value - 7.91).abs() < 1e-9 && result.expanded() < 0.02);
    let mut state = ramp_from(2.5, 0.2);
    let readings = watched(true, RESTING, 60.0);
    let next = fine::conclude(&context(), &readings, &mut state, (Direction::Falling, 0));
    assert_eq!((next, ended(&state)), (None, None));
    let result = state.record.result(Parameter::ReleaseVoltage).unwrap();
    assert!((result.value - 2.36).abs() < 1e-9 && result.expanded() < 0.02);
}

#[test]
fn a_missed_fine_ramp_repeats_at_most_five_times() {
    let miss = |readings: &Readings| {
        let mut state = ramp_from(7.8, 0.2);
        for attempt in 0..4 {
            let next = fine::conclude(
                &context(),
                readings,
                &mut state,
                (Direction::Rising, attempt),
            );
            let searched = Some(Stage::Search(Direction::Rising));
            let again = Some(Stage::OperateFine(attempt + 1));
            assert_eq!(next, if attempt == 1 { searched } else { again });
            assert_eq!(ended(&state), None);
        }
        let centre = state.plan.expected(Direction::Rising).unwrap().centre;
        let last = fine::conclude(&context(), readings, &mut state, (Direction::Rising, 4));
        assert_eq!(last, None);
        assert_ends(&state, Bin::RETEST, "not found in 5 fine ramps");
        centre
    };
    assert!(miss(&watched(false, RESTING, 30.0)) > Volt(7.9), "later");
    assert!(miss(&watched(false, PULLED, 30.0)) < Volt(7.9), "earlier");
}

#[test]
fn a_repeated_ramp_that_misses_searches_elsewhere() {
    let mut state = ramp_from(7.8, 0.2);
    let conclude = |state: &mut TestState, readings: &Readings| {
        fine::conclude(&context(), readings, state, (Direction::Rising, 0));
        state.plan.interval(Direction::Rising)
    };
    let around_first = conclude(&mut state, &watched(true, PULLED, 60.0));
    let missed = conclude(&mut state, &watched(false, PULLED, 60.0));
    assert!(missed.half_width > around_first.half_width);
    assert!(missed.centre < around_first.centre);
    let found = conclude(&mut state, &watched(true, PULLED, 60.0));
    assert_eq!(found, around_first);
}

#[test]
fn an_event_before_the_interval_lowers_the_search() {
    let mut state = ramp_from(7.8, 0.2);
    let readings = watched(true, PULLED, 2.0);
    let next = fine::conclude(&context(), &readings, &mut state, (Direction::Rising, 0));
    assert_eq!(next, Some(Stage::OperateFine(1)));
    assert_eq!(state.record.attempts(Parameter::OperateVoltage), 0);
    let centre = state.plan.expected(Direction::Rising).unwrap().centre;
    assert!(centre < Volt(7.9), "{centre}");
}

#[test]
fn an_early_release_raises_the_search() {
    for (board, higher) in [(RESTING, true), (PULLED, false)] {
        let mut state = ramp_from(8.0, 0.2);
        let readings = watched(false, board, 30.0);
        let next = fine::conclude(&context(), &readings, &mut state, (Direction::Falling, 0));
        assert_eq!(next, Some(Stage::ReleaseFine(1)));
        let centre = state.plan.expected(Direction::Falling).unwrap().centre;
        assert_eq!(centre > Volt(7.9), higher, "{centre}");
    }
}

#[test]
fn an_event_after_the_ramp_centres_the_next() {
    let mut state = ramp_from(7.8, 0.1);
    let readings = watched(true, PULLED, 80.0);
    let next = fine::conclude(&context(), &readings, &mut state, (Direction::Rising, 0));
    assert_eq!(next, Some(Stage::OperateFine(1)));
    let expected = state.plan.expected(Direction::Rising).unwrap();
    assert!((expected.centre.0 - 7.9).abs() < 1e-9);
    assert_eq!(state.record.attempts(Parameter::OperateVoltage), 0);
}

#[test]
fn a_coarse_release_without_break_starts_a_bisection() {
    for readings in [
        watched(false, PULLED, 0.0),
        // The ramp ended long before: the gate holds time, not voltage.
        watched(true, RESTING, 60.0),
        // The ramp ends after 41.1 ms; its last step may have been made.
        watched(true, RESTING, 40.6),
    ] {
        let mut state = ramp_from(4.0, 4.0);
        let next = release::conclude_coarse(&context(), &readings, &mut state);
        assert_eq!(next, Some(Stage::Search(Direction::Falling)));
        assert_eq!(state.record.own.release, None);
    }
    let mut state = ramp_from(4.0, 4.0);
    let readings = watched(true, RESTING, 25.0);
    release::conclude_coarse(&context(), &readings, &mut state);
    let coarse = state.record.own.release.unwrap().coarse.indicated;
    assert!((coarse.0 - (4.0 - 0.05 - 2.4)).abs() < 1e-9);
    let expected = state.plan.expected(Direction::Falling).unwrap();
    assert!((expected.centre.0 - (coarse.0 + 1.05)).abs() < 1e-9);
    let start = expected.falling(context().scale()).start;
    assert!(start > expected.centre);
}

#[test]
fn a_low_coarse_release_counts_until_the_last_refresh() {
    let mut state = ramp_from(4.0, 4.0);
    release::conclude_coarse(&context(), &watched(true, RESTING, 40.0), &mut state);
    let coarse = state.record.own.release.unwrap().coarse.indicated;
    assert!((coarse.0 - 0.11).abs() < 1e-9);
}

/// Readings of a timed stage: gates 0 and 1 in counts of 20 us, forward drop.
fn timed(seen: bool, counts: [u32; 2]) -> Readings {
    Readings {
        seen: vec![seen],
        boards: vec![PULLED],
        gates: vec![gates([100, 200]), gates([100 + counts[0], 200 + counts[1]])],
        drops: vec![drop_of(Quality::Good, 0.9)],
        ..Readings::default()
    }
}

#[test]
fn a_timed_operation_gives_time_bounce_and_contact() {
    let mut state = at_23_c();
    timing::conclude_operate(&context(), &timed(true, [236, 252]), &mut state);
    assert_eq!(ended(&state), None);
    for (parameter, value) in [
        (Parameter::OperateTime, 4.72),
        (Parameter::OperateBounce, 0.32),
        (Parameter::ContactResistanceNo, 18.0),
    ] {
        let found = state.record.result(parameter).unwrap().value;
        assert!((found - value).abs() < 1e-9, "{parameter}: {found}");
        assert!(state.record.evidence(parameter).count() > 0, "{parameter}");
    }
}

#[test]
fn a_timed_release_adds_an_nc_closure() {
    let mut state = at_23_c();
    state.plan.nc = vec![ContactDrop::single(Volt(-1.1), true, 0.003)];
    timing::conclude_release(&context(), &timed(true, [145, 150]), &mut state);
    assert_eq!(ended(&state), None);
    let time = state.record.result(Parameter::ReleaseTime).unwrap().value;
    assert!((time - 2.9).abs() < 1e-9);
    let nc = state.record.result(Parameter::ContactResistanceNc).unwrap();
    assert!((nc.value - 20.0).abs() < 1e-9, "mean of 22 and 18");
}

#[test]
fn a_missing_make_fails_and_unread_counters_void() {
    type Conclude =
        fn(&crate::dut::em_relay::measure::Context, &Readings, &mut TestState) -> Option<Stage>;
    let stages: [(Conclude, &str); 2] = [
        (timing::conclude_operate, "operate_time_ms"),
        (timing::conclude_release, "release_time_ms"),
    ];
    for (conclude, word) in stages {
        let mut state = at_23_c();
        conclude(&context(), &timed(false, [3000, 3000]), &mut state);
        assert_ends(&state, bins::TIME, word);
        let mut state = at_23_c();
        let mut unread = timed(true, [236, 252]);
        unread.gates.truncate(1);
        conclude(&context(), &unread, &mut state);
        assert_ends(&state, Bin::RETEST, "gate counters");
        let mut state = at_23_c();
        conclude(&context(), &timed(true, [0, 0]), &mut state);
        assert_ends(&state, Bin::RETEST, "0 and 0 counts");
    }
}

#[test]
fn a_closure_in_compliance_fails_by_contact() {
    let mut readings = timed(true, [236, 252]);
    readings.boards[0].compliance = true;
    readings.drops[0] = drop_of(Quality::OverRange, 0.0);
    let mut state = at_23_c();
    timing::conclude_operate(&context(), &readings, &mut state);
    assert_ends(&state, bins::CONTACT, "NO contact");
    let mut state = at_23_c();
    timing::conclude_release(&context(), &readings, &mut state);
    assert_ends(&state, bins::CONTACT, "NC contact");
}

/// The default context on the strategy `ramp`, with a model in which each millisecond of operate time adds 96 mV of
/// overshoot.
fn on_the_ramp() -> Context {
    let mut law = OvershootModel::guess(0.85, 1.0);
    for at in 0..40 {
        let turn = |by: f64| (f64::from(at) * by).fract() - 0.5;
        let late_ms = 0.8 * turn(0.618);
        let overshoot = Volt(0.85 + 0.096 * late_ms);
        let indicated = Volt(8.87 + 0.9 * turn(0.382_7));
        let shown = CoarseResults {
            indicated,
            operate: indicated,
            operate_ms: 4.7 + late_ms,
            release_ms: 2.9 + 0.4 * turn(0.271),
            coil_ohm: 400.0 + 20.0 * turn(0.724),
        };
        law.learn(&shown, shown.indicated - overshoot);
    }
    let mut context = context();
    let strategy = &mut Arc::make_mut(&mut context.relay).test.strategy;
    strategy.operate_voltage_v = Strategy::Ramp;
    let overshoots = Arc::make_mut(&mut context.calibration)
        .overshoots
        .as_mut()
        .unwrap();
    overshoots.operate.coarse = law;
    context
}

/// Concludes a coarse ramp on a part whose operate time is this number of counts.
fn coarse_after(context: &Context, counts: u32) -> (TestState, Option<Stage>) {
    let mut state = ramp_from(5.0, 6.0);
    timing::conclude_operate(context, &timed(true, [counts, counts]), &mut state);
    timing::conclude_release(context, &timed(true, [145, 150]), &mut state);
    let readings = Readings {
        coil: vec![scan(5.0, 0.0125)],
        ..Readings::default()
    };
    coil::conclude(context, &readings, &mut state);
    let next = operate::conclude_coarse(context, &watched(true, PULLED, 40.0), &mut state);
    (state, next)
}

#[test]
fn the_operate_time_corrects_a_coarse_value() {
    let context = on_the_ramp();
    for (counts, slower_ms) in [(235, 0.0), (245, 0.2)] {
        let (state, next) = coarse_after(&context, counts);
        assert_eq!((next, ended(&state)), (None, None));
        let corrected = state.record.result(Parameter::OperateVoltage).unwrap();
        let expected = 8.89 - (0.85 + 0.096 * slower_ms);
        let off = corrected.value - expected;
        assert!(off.abs() < 2e-3, "{off} V");
        assert!(corrected.expanded() < 0.03, "{corrected:?}");
    }
}

#[test]
fn an_unlike_part_needs_the_fine_ramp() {
    let (state, next) = coarse_after(&on_the_ramp(), 420);
    assert_eq!((next, ended(&state)), (Some(Stage::OperateFine(0)), None));
    assert_eq!(state.record.attempts(Parameter::OperateVoltage), 0);
    let expected = state.plan.expected(Direction::Rising).unwrap();
    assert!(expected.half_width > Volt(0.01), "{expected:?}");
}

/// Last state written to the source before an output is switched on.
fn source_before(switched: DigitalOut, acts: &[Act]) -> Option<bool> {
    let words = acts.iter().filter_map(|act| match act {
        Act::Board(word) => Some(word),
        _ => None,
    });
    let mut last = None;
    for word in words {
        let source = word.iter().find(|it| it.0 == DigitalOut::SourceOn);
        last = source.map(|it| it.1).or(last);
        if word.contains(&(switched, true)) {
            return last;
        }
    }
    panic!("{switched:?} is never switched on");
}

#[test]
fn a_closure_that_is_not_read_carries_no_current() {
    let context = context();
    let mut after_a_release = at_23_c();
    after_a_release.board.armature = Armature::Released;
    let timed = after_a_release.enter(Stage::TimedRelease, &context);
    assert_eq!(source_before(DigitalOut::CoilDrive, &timed), Some(false));
    let mut after_an_operation = at_23_c();
    after_an_operation.board.armature = Armature::Operated;
    let expected = Expected::new(Volt(2.3), 0.01);
    after_an_operation.plan.expect(Direction::Falling, expected);
    let fine = after_an_operation.enter(Stage::ReleaseFine(0), &context);
    assert_eq!(source_before(DigitalOut::RampMode, &fine), Some(false));
}
