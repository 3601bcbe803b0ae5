//! Consecutive ramps: the position of the supply when the next ramp begins.

use super::super::{Stage, fine};
use super::{PULLED, RESTING, at_23_c, context, watched};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::act::Act;
use crate::dut::em_relay::calibration::{Calibration, Overshoots};
use crate::dut::em_relay::measure::pace::Pace;
use crate::dut::em_relay::measure::ramp::Expected;
use crate::dut::em_relay::overshoot::{CoarseResults, OvershootModel};
use crate::dut::em_relay::points::DigitalOut;
use crate::dut::em_relay::reference_part::interim;

use crate::dut::em_relay::tests::reference_parts;
use crate::dut::em_relay::threshold::Direction;
use crate::gauge::budget::{Budget, Reading};
use crate::rig::sample::CountSample;
use std::sync::Arc;
use units::{Celsius, Span, Unit, Volt};

/// Least time from the mark before these acts to the first ARM among them.
fn until_armed(acts: &[Act]) -> Span {
    let (mut before, mut passed) = (Span(0), Span(0));
    for act in acts {
        match act {
            Act::Board(outputs) if outputs.contains(&(DigitalOut::Arm, true)) => break,
            Act::Wait(time) => passed += *time,
            Act::WaitSinceMark(time) | Act::RampSinceMark(time) => passed = passed.max(*time),
            Act::Mark => before += std::mem::take(&mut passed),
            Act::Board(_)
            | Act::Supply(_)
            | Act::Read(_)
            | Act::CoilMask(_)
            | Act::SelectRange(_)
            | Act::ConfirmRange { .. }
            | Act::ConvertSinceMark(_)
            | Act::Below { .. }
            | Act::Until { .. } => {}
        }
    }
    before + passed
}

#[test]
fn an_operate_ramp_waits_for_the_release_ramp() {
    for (sd_v, gate_ms) in [(0.008, 75.0), (0.025, 75.0), (0.06, 80.0)] {
        let context = context();
        let mut state = at_23_c();
        state
            .plan
            .expect(Direction::Falling, Expected::new(Volt(0.7), sd_v));
        state
            .plan
            .expect(Direction::Rising, Expected::new(Volt(6.7), 0.03));
        let way = state
            .plan
            .expected(Direction::Falling)
            .unwrap()
            .falling(context.scale());
        state.enter(Stage::ReleaseFine(0), &context);
        let event = watched(true, RESTING, gate_ms);
        fine::conclude(&context, &event, &mut state, (Direction::Falling, 0));
        let acts = state.enter(Stage::OperateFine(0), &context);
        let falls_ms = (way.span.0 - 0.045) / 1.5 * 1e3 - gate_ms;
        // Arming and approach take longer; the ramp waits for them.
        let armed_ms = until_armed(&acts).as_seconds() * 1e3;
        assert!(armed_ms >= falls_ms.min(24.0), "{armed_ms} of {falls_ms}");
        assert!(sd_v < 0.02 || falls_ms > 30.0 && armed_ms >= falls_ms);
    }
}

fn within(centre_v: f64, half_width_v: f64) -> Expected {
    Expected {
        centre: Volt(centre_v),
        half_width: Volt(half_width_v),
    }
}

#[test]
fn a_search_seals_after_the_release_ramp_ends() {
    let context = context();
    let mut state = at_23_c();
    state.plan.expect(Direction::Falling, within(1.9, 0.3));
    state.enter(Stage::ReleaseFine(0), &context);
    let missed = watched(true, RESTING, 10.0);
    let next = fine::conclude(&context, &missed, &mut state, (Direction::Falling, 0));
    assert_eq!(next, Some(Stage::Search(Direction::Falling)));
    let acts = state.enter(Stage::Search(Direction::Falling), &context);
    let driven = |act: &Act| matches!(act, Act::Board(outputs) if outputs.contains(&(DigitalOut::CoilDrive, true)));
    let at = acts.iter().position(driven).unwrap();
    // 0.7 V at 1.5 V/s, of which 10 ms had passed.
    assert!(until_armed(&acts[..at]) > Span::ms(440), "{acts:?}");
}

#[test]
fn a_release_ramp_waits_for_the_ramp_before() {
    let wait_ms = |rising: bool| {
        let context = context();
        let mut state = at_23_c();
        state.plan.expect(Direction::Falling, within(2.3, 0.09));
        state.plan.expect(Direction::Rising, within(7.8, 0.06));
        if rising {
            state.enter(Stage::OperateFine(0), &context);
            fine::conclude(
                &context,
                &watched(true, PULLED, 60.0),
                &mut state,
                (Direction::Rising, 0),
            );
        } else {
            state.enter(Stage::ReleaseFine(0), &context);
            fine::conclude(
                &context,
                &watched(true, RESTING, 60.0),
                &mut state,
                (Direction::Falling, 0),
            );
        }
        until_armed(&state.enter(Stage::ReleaseFine(0), &context)).as_seconds() * 1e3
    };
    // The fine output rises from 0 to 0.165 V at 1.5 V/s, or to 0.28 V from 0.2 V after a ramp with 74 ms left to run.
    let (falling, rising) = (wait_ms(false), wait_ms(true));
    assert!((105.0..115.0).contains(&falling), "{falling}");
    assert!((130.0..150.0).contains(&rising), "{rising}");
}

#[test]
fn a_repeated_release_ramp_waits_for_the_missed_one() {
    let (context, mut state) = (context(), at_23_c());
    state.plan.expect(Direction::Rising, within(7.8, 0.18));
    state.enter(Stage::OperateFine(0), &context);
    let operated = watched(true, PULLED, 400.0);
    fine::conclude(&context, &operated, &mut state, (Direction::Rising, 0));
    state.plan.expect(Direction::Falling, within(2.3, 0.07));
    state.enter(Stage::ReleaseFine(0), &context);
    let premature = watched(true, RESTING, 10.0);
    let next = fine::conclude(&context, &premature, &mut state, (Direction::Falling, 0));
    assert_eq!(next, Some(Stage::ReleaseFine(1)));
    let acts = state.enter(Stage::ReleaseFine(1), &context);
    // The fine output falls from 0.60 V to 0.464 V at 1.5 V/s, in 91 ms; the margin is 4 ms.
    let armed_ms = until_armed(&acts).as_seconds() * 1e3;
    assert!((90.0..110.0).contains(&armed_ms), "{armed_ms}");
}

#[test]
fn a_repeat_keeps_the_first_fine_indication() {
    let (context, mut state) = (context(), at_23_c());
    state
        .plan
        .expect(Direction::Falling, Expected::new(Volt(2.3), 0.03));
    let mut indicated = || {
        state.enter(Stage::ReleaseFine(0), &context);
        let event = watched(true, RESTING, 60.0);
        fine::conclude(&context, &event, &mut state, (Direction::Falling, 0));
        state.record.ramp(Direction::Falling).unwrap().fine.unwrap()
    };
    assert_eq!(indicated(), indicated());
    let both: Vec<f64> = state
        .record
        .each(Parameter::ReleaseVoltage)
        .map(|it| it.value)
        .collect();
    assert!(both.len() == 2 && both[0] != both[1], "{both:?}");
}

#[test]
fn certificates_place_the_ramps_of_reference_parts() {
    let mut context = context();
    let learned = context.overshoot(Direction::Rising);
    let mut half_width = |coarse: OvershootModel| {
        context.teaching = reference_parts().into_iter().next();
        let overshoot = interim(coarse, 0.03);
        let overshoots = Overshoots {
            operate: overshoot,
            release: overshoot,
        };
        context.calibration = Arc::new(Calibration {
            overshoots: Some(overshoots),
            ..(*context.calibration).clone()
        });
        let found = Expected::certified(&context, Celsius(23.0), Direction::Rising).unwrap();
        assert!((found.centre.0 - 7.43).abs() < 1e-9, "{found:?}");
        found.half_width.0
    };
    let first = half_width(OvershootModel::guess(0.85, 1.0));
    let mut taught = learned.coarse;
    taught.learn(&shown(), Volt(7.9));
    let second = half_width(taught);
    assert!((0.05..0.08).contains(&first) && (0.02..0.03).contains(&second));
}

#[test]
fn parts_of_the_lot_have_no_certificate() {
    let found = Expected::certified(&context(), Celsius(23.0), Direction::Falling);
    assert_eq!(found, None);
}

#[test]
fn a_slow_armature_gets_longer_waits() {
    let of = |operate_ms: f64| {
        let mut state = at_23_c();
        let reading = Reading {
            value: operate_ms,
            unit: Unit::Millisecond,
            budget: Budget::default(),
        };
        state
            .record
            .found::<CountSample>(Parameter::OperateTime, reading, []);
        Pace::of(&state.record)
    };
    let (usual, slow) = (of(4.7), of(9.4));
    assert_eq!(
        usual.approaches().as_seconds() * 2.0,
        slow.approaches().as_seconds()
    );
    assert!((usual.run_up(1.5).0 - 0.060).abs() < 1e-3, "{usual:?}");
    assert!((slow.run_up(1.5).0 - 0.120).abs() < 2e-3, "{slow:?}");
    assert_eq!(of(1e9), of(20.0), "within reason");
    assert_eq!(
        Pace::of(&at_23_c().record),
        of(5.0),
        "one that has shown nothing"
    );
}

fn shown() -> CoarseResults {
    CoarseResults {
        indicated: Volt(8.75),
        operate: Volt(8.75),
        operate_ms: 4.7,
        release_ms: 2.9,
        coil_ohm: 400.0,
    }
}
