//! Conclusions on a moving armature: ramps, timed operation and release.

use super::super::{Ramp, Stage, coil, operate, operate_fine, release, timing};
use super::{PULLED, RESTING, assert_ends, at_23_c, bench, drop_of, ended, gates, scan, watched};
use crate::dut::em_relay::bins;
use crate::dut::em_relay::lag::{LagLaw, Shown};
use crate::dut::em_relay::measure::ramp::Expected;
use crate::dut::em_relay::measure::{Bench, Findings};
use crate::dut::em_relay::supply::Supply;
use crate::dut::em_relay::threshold::Direction;
use crate::dut::em_relay::{Parameter, Strategy};
use crate::dut::verdict::Bin;
use crate::instrument::act::{Act, BoardInputs, Readings};
use crate::rig::point::DigitalOut;
use crate::rig::sample::Quality;
use crate::units::Volt;
use std::sync::Arc;

fn ramp_from(start: f64, span: f64) -> Findings {
    let mut findings = at_23_c();
    findings.ramp_start = Some(Volt(start));
    findings.ramp_span = Some(Volt(span));
    findings.expected_operate = Some(Expected::new(Volt(7.9), 0.02));
    findings.expected_release = findings.expected_operate;
    findings
}

#[test]
fn the_coarse_ramp_places_the_fine_one_by_its_learned_lag() {
    let mut findings = ramp_from(5.0, 6.0);
    let readings = watched(true, PULLED, 40.0);
    let next = operate::conclude_coarse(&bench(), &readings, &mut findings);
    assert_eq!((next, ended(&findings)), (None, None));
    let seen = 5.0 + 0.05 + 96.0 * 0.04;
    let coarse = findings.operate.unwrap().coarse.indicated;
    assert!((coarse.0 - seen).abs() < 1e-9);
    let expected = findings.expected_operate.unwrap();
    assert!((expected.centre.0 - (seen - 0.85)).abs() < 1e-9);
}

#[test]
fn a_coarse_ramp_without_a_make_is_a_high_threshold_unless_the_contact_made_unseen() {
    for (board, bin, word) in [
        (RESTING, bins::VOLTAGE, "above the coarse ramp"),
        (PULLED, Bin::RETEST, "outside the window"),
    ] {
        let mut findings = ramp_from(5.0, 6.0);
        let silent = watched(false, board, 0.0);
        let next = operate::conclude_coarse(&bench(), &silent, &mut findings);
        assert_eq!(next, None);
        assert_ends(&findings, bin, word);
    }
}

#[test]
fn a_contact_that_does_not_move_at_nominal_voltage_is_stuck_unless_the_coil_is_the_cause() {
    let between = BoardInputs {
        nc_closed: false,
        ..RESTING
    };
    for (board, word) in [(RESTING, "NC does not open"), (between, "NO does not make")] {
        for (ampere, bin, word) in [
            (0.0125, bins::CONTACT, word),
            (0.0, bins::COIL, "coil open"),
        ] {
            let mut findings = at_23_c();
            let unmoved = watched(false, board, 0.0);
            let next = timing::conclude_operate(&bench(), &unmoved, &mut findings);
            assert_eq!((next, ended(&findings)), (Some(Stage::Coil), None));
            let readings = Readings {
                coil: vec![scan(5.0, ampere)],
                ..Readings::default()
            };
            coil::conclude(&bench(), &readings, &mut findings);
            assert_ends(&findings, bin, word);
        }
    }
    let mut findings = at_23_c();
    timing::conclude_operate(&bench(), &Readings::default(), &mut findings);
    assert_ends(&findings, Bin::RETEST, "not read");
}

#[test]
fn a_fine_ramp_that_meets_its_event_gives_the_threshold() {
    let mut findings = ramp_from(7.8, 0.2);
    findings.operate = Some(Ramp {
        coarse: findings.shown(Volt(8.8), Direction::Rising),
        fine: None,
    });
    let readings = watched(true, PULLED, 40.0);
    let next = operate_fine::conclude(&bench(), &readings, &mut findings, 0);
    assert_eq!((next, ended(&findings)), (None, None));
    let result = findings.result(Parameter::OperateVoltage).unwrap();
    assert!((result.value - 7.91).abs() < 1e-9 && result.expanded() < 0.02);
    let mut findings = ramp_from(2.5, 0.2);
    let readings = watched(true, RESTING, 60.0);
    let next = release::conclude_fine(&bench(), &readings, &mut findings, 0);
    assert_eq!((next, ended(&findings)), (None, None));
    let result = findings.result(Parameter::ReleaseVoltage).unwrap();
    assert!((result.value - 2.36).abs() < 1e-9 && result.expanded() < 0.02);
}

#[test]
fn a_fine_ramp_that_misses_is_placed_anew_five_times_at_most() {
    let miss = |readings: &Readings| {
        let mut findings = ramp_from(7.8, 0.2);
        for attempt in 0..4 {
            let next = operate_fine::conclude(&bench(), readings, &mut findings, attempt);
            let searched = Some(Stage::Search(Direction::Rising));
            let again = Some(Stage::OperateFine(attempt + 1));
            assert_eq!(next, if attempt == 1 { searched } else { again });
            assert_eq!(ended(&findings), None);
        }
        let centre = findings.expected_operate.unwrap().centre;
        let last = operate_fine::conclude(&bench(), readings, &mut findings, 4);
        assert_eq!(last, None);
        assert_ends(&findings, Bin::RETEST, "not found in 5 fine ramps");
        centre
    };
    assert!(miss(&watched(false, RESTING, 30.0)) > Volt(7.9), "later");
    assert!(miss(&watched(false, PULLED, 30.0)) < Volt(7.9), "earlier");
}

#[test]
fn an_event_before_the_searched_interval_is_that_of_the_step_and_looked_for_lower() {
    let mut findings = ramp_from(7.8, 0.2);
    let readings = watched(true, PULLED, 2.0);
    let next = operate_fine::conclude(&bench(), &readings, &mut findings, 0);
    assert_eq!(next, Some(Stage::OperateFine(1)));
    assert_eq!(findings.attempts(Parameter::OperateVoltage), 0);
    let centre = findings.expected_operate.unwrap().centre;
    assert!(centre < Volt(7.9), "{centre}");
}

#[test]
fn a_release_that_came_too_early_is_looked_for_higher() {
    for (board, higher) in [(RESTING, true), (PULLED, false)] {
        let mut findings = ramp_from(8.0, 0.2);
        let readings = watched(false, board, 30.0);
        let next = release::conclude_fine(&bench(), &readings, &mut findings, 0);
        assert_eq!(next, Some(Stage::ReleaseFine(1)));
        let centre = findings.expected_release.unwrap().centre;
        assert_eq!(centre > Volt(7.9), higher, "{centre}");
    }
}

#[test]
fn an_event_after_the_ramp_has_stopped_is_looked_for_around_its_end() {
    let mut findings = ramp_from(7.8, 0.1);
    let readings = watched(true, PULLED, 80.0);
    let next = operate_fine::conclude(&bench(), &readings, &mut findings, 0);
    assert_eq!(next, Some(Stage::OperateFine(1)));
    let expected = findings.expected_operate.unwrap();
    assert!((expected.centre.0 - 7.9).abs() < 1e-9);
    assert_eq!(findings.attempts(Parameter::OperateVoltage), 0);
}

#[test]
fn a_coarse_release_without_a_break_is_searched_by_halves() {
    for readings in [
        watched(false, PULLED, 0.0),
        // The ramp has ended long before: the time is no voltage.
        watched(true, RESTING, 60.0),
        // It ends after 41.1 ms, and its last step may have been made.
        watched(true, RESTING, 40.6),
    ] {
        let mut findings = ramp_from(4.0, 4.0);
        let next = release::conclude_coarse(&bench(), &readings, &mut findings);
        assert_eq!(next, Some(Stage::Search(Direction::Falling)));
        assert_eq!(findings.release, None);
    }
    let mut findings = ramp_from(4.0, 4.0);
    let readings = watched(true, RESTING, 25.0);
    release::conclude_coarse(&bench(), &readings, &mut findings);
    let coarse = findings.release.unwrap().coarse.indicated;
    assert!((coarse.0 - (4.0 - 0.05 - 2.4)).abs() < 1e-9);
    let expected = findings.expected_release.unwrap();
    assert!((expected.centre.0 - (coarse.0 + 1.05)).abs() < 1e-9);
    let start = expected.falling().start;
    assert!(start > expected.centre);
}

#[test]
fn a_coarse_release_of_a_coil_of_few_volts_is_told_down_to_the_last_step_of_its_ramp() {
    let mut findings = ramp_from(4.0, 4.0);
    release::conclude_coarse(&bench(), &watched(true, RESTING, 40.0), &mut findings);
    let coarse = findings.release.unwrap().coarse.indicated;
    assert!((coarse.0 - 0.11).abs() < 1e-9);
}

/// A timed stage: gate 0 and 1 in counts of 20 us, drops of both polarities.
fn timed(seen: bool, counts: [u32; 2]) -> Readings {
    Readings {
        seen: vec![seen],
        boards: vec![PULLED],
        gates: vec![gates([100, 200]), gates([100 + counts[0], 200 + counts[1]])],
        drops: [0.9, -0.9].map(|v| drop_of(Quality::Good, v)).to_vec(),
        ..Readings::default()
    }
}

#[test]
fn a_timed_operation_gives_time_bounce_and_the_contact_it_ends_on() {
    let mut findings = at_23_c();
    timing::conclude_operate(&bench(), &timed(true, [236, 252]), &mut findings);
    assert_eq!(ended(&findings), None);
    for (parameter, value) in [
        (Parameter::OperateTime, 4.72),
        (Parameter::OperateBounce, 0.32),
        (Parameter::ContactResistanceNo, 18.0),
    ] {
        let found = findings.result(parameter).unwrap().value;
        assert!((found - value).abs() < 1e-9, "{parameter}: {found}");
        assert!(findings.evidence(parameter).count() > 0, "{parameter}");
    }
}

#[test]
fn a_timed_release_adds_its_closure_to_the_nc_contact() {
    let mut findings = at_23_c();
    findings.drop_zero = Some(Volt(0.1));
    findings.nc_drops = vec![Volt(1.2)];
    timing::conclude_release(&bench(), &timed(true, [145, 150]), &mut findings);
    assert_eq!(ended(&findings), None);
    let time = findings.result(Parameter::ReleaseTime).unwrap().value;
    assert!((time - 2.9).abs() < 1e-9);
    let nc = findings.result(Parameter::ContactResistanceNc).unwrap();
    assert!((nc.value - 20.0).abs() < 1e-9, "mean of 24 and 16");
}

#[test]
fn a_contact_that_never_makes_fails_by_time_and_an_unread_counter_is_void() {
    type Conclude =
        fn(&crate::dut::em_relay::measure::Bench, &Readings, &mut Findings) -> Option<Stage>;
    let stages: [(Conclude, &str); 2] = [
        (timing::conclude_operate, "operate_time_ms"),
        (timing::conclude_release, "release_time_ms"),
    ];
    for (conclude, word) in stages {
        let mut findings = at_23_c();
        conclude(&bench(), &timed(false, [3000, 3000]), &mut findings);
        assert_ends(&findings, bins::TIME, word);
        let mut findings = at_23_c();
        let mut unread = timed(true, [236, 252]);
        unread.gates.truncate(1);
        conclude(&bench(), &unread, &mut findings);
        assert_ends(&findings, Bin::RETEST, "gate counters");
        let mut findings = at_23_c();
        conclude(&bench(), &timed(true, [0, 0]), &mut findings);
        assert_ends(&findings, Bin::RETEST, "0 and 0 counts");
    }
}

#[test]
fn a_closure_with_the_source_in_compliance_fails_by_contact() {
    let mut readings = timed(true, [236, 252]);
    readings.boards[0].compliance = true;
    readings.drops[0] = drop_of(Quality::OverRange, 0.0);
    let mut findings = at_23_c();
    timing::conclude_operate(&bench(), &readings, &mut findings);
    assert_ends(&findings, bins::CONTACT, "NO contact");
    let mut findings = at_23_c();
    findings.drop_zero = Some(Volt(0.0));
    timing::conclude_release(&bench(), &readings, &mut findings);
    assert_ends(&findings, bins::CONTACT, "NC contact");
}

/// The default bench on the strategy `ramp`, with a law taught by parts of which each millisecond of operate time
/// showed 96 mV more.
fn on_the_ramp() -> Bench {
    let mut law = LagLaw::guess(0.85);
    for at in 0..40 {
        let turn = |by: f64| (f64::from(at) * by).fract() - 0.5;
        let late_ms = 0.8 * turn(0.618);
        let lag = Volt(0.85 + 0.096 * late_ms);
        let indicated = Volt(8.87 + 0.9 * turn(0.382_7));
        let shown = Shown {
            indicated,
            operate: indicated,
            operate_ms: 4.7 + late_ms,
            release_ms: 2.9 + 0.4 * turn(0.271),
            coil_ohm: 400.0 + 20.0 * turn(0.724),
        };
        law.learn(&shown, shown.indicated - lag);
    }
    let mut bench = bench();
    let strategy = &mut Arc::make_mut(&mut bench.recipe).test.strategy;
    strategy.operate_voltage_v = Strategy::Ramp;
    let lags = Arc::make_mut(&mut bench.calibration).lags.as_mut().unwrap();
    lags.operate.coarse = law;
    bench
}

/// A coarse ramp after so many counts of operate time.
fn coarse_after(bench: &Bench, counts: u32) -> (Findings, Option<Stage>) {
    let mut findings = ramp_from(5.0, 6.0);
    findings.drop_zero = Some(Volt(0.0));
    timing::conclude_operate(bench, &timed(true, [counts, counts]), &mut findings);
    timing::conclude_release(bench, &timed(true, [145, 150]), &mut findings);
    let readings = Readings {
        coil: vec![scan(5.0, 0.0125)],
        ..Readings::default()
    };
    coil::conclude(bench, &readings, &mut findings);
    let next = operate::conclude_coarse(bench, &watched(true, PULLED, 40.0), &mut findings);
    (findings, next)
}

#[test]
fn a_coarse_value_is_corrected_by_the_operate_time_of_the_same_part() {
    let bench = on_the_ramp();
    for (counts, slower_ms) in [(235, 0.0), (245, 0.2)] {
        let (findings, next) = coarse_after(&bench, counts);
        assert_eq!((next, ended(&findings)), (None, None));
        let corrected = findings.result(Parameter::OperateVoltage).unwrap();
        let expected = 8.89 - (0.85 + 0.096 * slower_ms);
        let off = corrected.value - expected;
        assert!(off.abs() < 2e-3, "{off} V");
        assert!(corrected.expanded() < 0.03, "{corrected:?}");
    }
}

#[test]
fn a_part_unlike_those_that_taught_the_law_is_measured_by_the_fine_ramp() {
    let (findings, next) = coarse_after(&on_the_ramp(), 420);
    assert_eq!(
        (next, ended(&findings)),
        (Some(Stage::OperateFine(0)), None)
    );
    assert_eq!(findings.attempts(Parameter::OperateVoltage), 0);
    let expected = findings.expected_operate.unwrap();
    assert!(expected.half_width > Volt(0.01), "{expected:?}");
}

/// What the source was told last before an output is switched on.
fn source_before(switched: DigitalOut, acts: &[Act]) -> Option<bool> {
    let words = acts.iter().filter_map(|act| match act {
        Act::Board(word) => Some(word),
        _ => None,
    });
    let mut told = None;
    for word in words {
        let source = word.iter().find(|it| it.0 == DigitalOut::SourceOn);
        told = source.map(|it| it.1).or(told);
        if word.contains(&(switched, true)) {
            return told;
        }
    }
    panic!("{switched:?} is never switched on");
}

#[test]
fn a_closure_that_nobody_reads_carries_no_current() {
    let bench = bench();
    let mut supply = Supply::new(&bench.calibration);
    let mut after_a_release = at_23_c();
    after_a_release.released = true;
    let timed = timing::acts_release(&bench, &mut supply, &mut after_a_release);
    assert_eq!(source_before(DigitalOut::CoilDrive, &timed), Some(false));
    let mut after_an_operation = at_23_c();
    after_an_operation.operated = true;
    after_an_operation.expected_release = Some(Expected::new(Volt(2.3), 0.01));
    let fine = release::acts_fine(&bench, &mut supply, &mut after_an_operation);
    assert_eq!(source_before(DigitalOut::RampMode, &fine), Some(false));
}
