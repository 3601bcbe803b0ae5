//! The acts of all stages against the rules of the interface board, and how a test ends early.

use super::super::{Armature, Progress, Stage, Test, TestRecord, TestState, order};
use super::{at_23_c, context};
use crate::dut::em_relay::Finding;
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::card::STEPS;
use crate::dut::em_relay::measure::ramp::Expected;
use crate::dut::em_relay::points::{AnalogIn, AnalogOut, DigitalOut};
use crate::dut::em_relay::threshold::Direction;
use crate::dut::em_relay::{Parameter, parameter};
use crate::dut::procedure::TestProcedure;
use crate::dut::reason::{Code, Reason};
use crate::dut::recipe::KindRecipe;
use crate::dut::verdict::{Bin, Verdict};
use crate::gauge::budget::{Budget, Reading};
use crate::handling::tests::MockRig;
use crate::instrument::act::{Job, JobDone, RunnerState};
use crate::rig::point::Point;
use crate::rig::sample::Sample;
use texts::Message;
use units::{Span, Volt};

/// Each stage of a good part in order: its acts, and the state of the armature after them.
fn stages_of_a_good_part() -> Vec<(Stage, Vec<Act>, Armature)> {
    let context = context();
    let mut state = at_23_c();
    let expected = |volts| Expected::new(Volt(volts), 0.01);
    state.plan.expect(Direction::Rising, expected(7.88));
    state.plan.expect(Direction::Falling, expected(2.35));
    let stages = std::iter::once(Stage::Kelvin).chain(order(&context));
    let enter = |stage| {
        let acts = state.enter(stage, &context);
        let left = state.board.armature;
        if let Stage::TimedOperate | Stage::OperateCoarse | Stage::OperateFine(_) = stage {
            state.board.armature = Armature::Operated;
        }
        (stage, acts, left)
    };
    stages.map(enter).collect()
}

fn refused() -> Message {
    Message::detail("unread", "module answers ?AA")
}

#[test]
fn conditioning_operates_before_the_first_measurement() {
    let mut context = context();
    assert!(!order(&context).contains(&Stage::Conditioning));
    std::sync::Arc::make_mut(&mut context.relay)
        .test
        .conditioning_operations = 3;
    assert_eq!(order(&context)[0], Stage::Conditioning);
    let mut state = at_23_c();
    let acts = state.enter(Stage::Conditioning, &context);
    assert_eq!(state.board.armature, Armature::Released);
    let nominal = Volt(context.relay.part.nominal_v);
    assert!((state.board.supply.total() - nominal).abs() < Volt(1e-6));
    let driven: Vec<bool> = acts
        .iter()
        .filter_map(|act| match act {
            Act::Board(outputs) => outputs.iter().find(|(it, _)| *it == DigitalOut::CoilDrive),
            _ => None,
        })
        .map(|(_, on)| *on)
        .collect();
    assert_eq!(driven, [true, false].repeat(3));
    let live = |act: &Act| matches!(act, Act::Board(outputs) if outputs.contains(&(DigitalOut::SourceOn, true)));
    assert!(!acts.iter().any(live), "no contact load");
}

#[test]
fn the_card_follows_the_order_of_the_test() {
    let entered = stages_of_a_good_part().into_iter();
    let entered = entered.map(|(stage, ..)| stage.card_step().name());
    let mut firsts: Vec<&str> = Vec::new();
    for step in entered {
        if !firsts.contains(&step) {
            firsts.push(step);
        }
    }
    let steps = context().relay.card().steps.into_iter();
    let steps: Vec<&str> = steps.map(|it| it.name).collect();
    assert_eq!(steps, STEPS);
    assert_eq!(steps[2..steps.len() - 1], firsts);
}

fn all_acts() -> Vec<(Stage, Vec<Act>)> {
    let stages = stages_of_a_good_part().into_iter();
    stages.map(|(stage, acts, _)| (stage, acts)).collect()
}

#[test]
fn each_stage_returns_the_state_of_the_board() {
    let left = stages_of_a_good_part().into_iter();
    let left: Vec<_> = left.map(|(stage, _, armature)| (stage, armature)).collect();
    let expected = [
        (Stage::Kelvin, Armature::Unknown),
        (Stage::NcContact, Armature::ReadyForTiming),
        (Stage::TimedOperate, Armature::Unknown),
        (Stage::TimedRelease, Armature::Rested),
        (Stage::Coil, Armature::ReadyForRamp),
        (Stage::OperateCoarse, Armature::Unknown),
        (Stage::ReleaseCoarse, Armature::Released),
        (Stage::OperateFine(0), Armature::Unknown),
        (Stage::ReleaseFine(0), Armature::Released),
        (Stage::Off, Armature::Rested),
    ];
    assert_eq!(left, expected);
}

#[test]
fn an_aborted_stage_leaves_the_board_unknown() {
    let mut test = Test::begin(context(), MockRig::at_rest().now);
    test.state.board.armature = Armature::Released;
    test.abandon(refused());
    assert_eq!(test.state.board.armature, Armature::Unknown);
}

#[test]
#[should_panic(expected = "a fine ramp without an expectation")]
fn no_fine_ramp_is_sent_without_an_expectation() {
    at_23_c().enter(Stage::OperateFine(0), &context());
}

#[test]
fn a_test_leaves_source_arm_and_drive_off() {
    let all: Vec<Act> = all_acts().into_iter().flat_map(|(_, acts)| acts).collect();
    for point in [
        DigitalOut::SourceOn,
        DigitalOut::SourceReverse,
        DigitalOut::CoilDrive,
        DigitalOut::Arm,
    ] {
        let mut writes = all.iter().filter_map(|act| match act {
            Act::Board(outputs) => outputs.iter().find(|(known, _)| *known == point),
            _ => None,
        });
        assert_eq!(writes.next_back(), Some(&(point, false)));
    }
}

/// Total wait after a board write, up to the next act that reads.
fn waits_after(acts: &[Act]) -> Span {
    let mut waited = Span(0);
    for act in acts {
        match act {
            Act::Wait(span)
            | Act::WaitSinceMark(span)
            | Act::RampSinceMark(span)
            | Act::ConvertSinceMark(span) => waited += *span,
            Act::Mark
            | Act::Board(_)
            | Act::Supply(_)
            | Act::CoilMask(_)
            | Act::SelectRange(_)
            | Act::ConfirmRange { .. } => {}
            Act::Read(Read::Drop | Read::Coil) | Act::Below { .. } | Act::Until { .. } => break,
            Act::Read(_) => {}
        }
    }
    waited
}

#[test]
fn switching_waits_until_the_source_is_off() {
    let watched = [
        DigitalOut::CoilDrive,
        DigitalOut::SelectNo,
        DigitalOut::SourceReverse,
    ];
    let (mut live, mut seen) = (false, 0);
    for (stage, acts) in all_acts() {
        for (at, act) in acts.iter().enumerate() {
            let Act::Board(outputs) = act else { continue };
            let changes = outputs.iter().any(|(point, _)| watched.contains(point));
            if changes && live && stage != Stage::TimedRelease && stage != Stage::Off {
                assert!(waits_after(&acts[at..]) >= Span::ms(2), "{stage:?}");
                seen += 1;
            }
            if let Some((_, on)) = outputs.iter().find(|(it, _)| *it == DigitalOut::SourceOn) {
                live = *on;
            }
        }
    }
    assert!(seen > 2, "{seen}");
}

#[test]
fn timing_keeps_2_ms_from_a_live_source() {
    // At least one transaction, 3 ms at the highest baud rate, lies between the write that switches the source off and
    // the one that switches the drive off: source and selection have switched by then.
    let (_, acts) = all_acts()
        .into_iter()
        .find(|(stage, _)| *stage == Stage::TimedRelease)
        .unwrap();
    let boards: Vec<&Vec<(DigitalOut, bool)>> = acts
        .iter()
        .filter_map(|act| match act {
            Act::Board(outputs) => Some(outputs),
            _ => None,
        })
        .collect();
    assert!(boards[0].contains(&(DigitalOut::SourceOn, false)));
    assert!(boards[0].contains(&(DigitalOut::Arm, true)));
    assert!(boards[1].contains(&(DigitalOut::CoilDrive, false)));
    assert!(
        !boards[0]
            .iter()
            .any(|(point, _)| *point == DigitalOut::CoilDrive)
    );
}

#[test]
fn counters_are_read_between_events() {
    let (mut one, mut both) = (false, false);
    for (stage, acts) in all_acts() {
        for act in acts {
            match act {
                Act::Read(Read::Gates) => (one, both) = (true, true),
                Act::Read(Read::Gate) => one = true,
                Act::Until { .. } => {
                    let timed = matches!(stage, Stage::TimedOperate | Stage::TimedRelease);
                    assert!(if timed { both } else { one }, "{stage:?}");
                    (one, both) = (false, false);
                }
                _ => {}
            }
        }
    }
}

#[test]
fn no_stage_of_a_part_changes_the_channel_mask() {
    for (stage, acts) in all_acts() {
        let masks = acts.iter().any(|act| matches!(act, Act::CoilMask(_)));
        assert!(!masks, "{stage:?} would write an EEPROM");
    }
}

#[test]
fn every_commanded_voltage_is_within_its_output() {
    for (stage, acts) in all_acts() {
        for act in acts {
            if let Act::Supply(outputs) = act {
                for (point, volts) in outputs {
                    let can = (0.0..=15.0).contains(&volts.0);
                    assert!(can, "{stage:?}: {point} {volts}");
                }
            }
        }
    }
}

fn board() -> Job {
    let inputs = MockRig::unread().points.board.inputs.clone();
    Job::Read(inputs.into_iter().map(Point::Input).collect())
}

/// Steps a test through good replies up to `job`, then fails that job.
fn fails_at(job: &Job) -> Test {
    let mut mock = MockRig::at_rest();
    mock.track(23.0);
    let mut test = Test::begin(context(), mock.now);
    let mut done = None;
    for _ in 0..200 {
        match test.step(mock.now, done.take().as_ref(), &mock.image) {
            Progress::Running(RunnerState::Job(requested)) => {
                mock.after(4);
                let trouble = (requested == *job).then(refused);
                done = Some(JobDone::new(mock.now, trouble));
            }
            Progress::Running(RunnerState::Wait(until)) => {
                mock.now = until;
                mock.scan();
            }
            Progress::Running(other) => panic!("{other:?}"),
            Progress::Judged => return test,
        }
    }
    panic!("the test does not end");
}

#[test]
fn a_rig_in_trouble_has_proven_no_part_bad() {
    let mut test = fails_at(&Job::Restarts);
    let mut record = TestRecord::default();
    record.stop(Finding::NoDoesNotMake);
    test.state.record = record.clone();
    assert_eq!(test.verdict().name(), "fail");
    record.trouble(refused());
    record.trouble(Message::detail("unread", "and again"));
    test.state.record = record;
    assert_eq!(
        test.verdict(),
        Verdict::Void(vec![Reason::rig_trouble(refused())])
    );
}

#[test]
fn an_early_end_rewrites_board_and_level() {
    let context = context();
    let writes = |ends: fn(&mut TestRecord)| {
        let mut state = TestState::new(&context);
        let prebias = Volt(context.relay.test.prebias_v);
        state.board.supply.step_to(prebias);
        ends(&mut state.record);
        let acts = state.enter(Stage::Off, &context);
        let level = |act: &&Act| matches!(act, Act::Supply(to) if to.iter().any(|(it, _)| *it == AnalogOut::SupplyLevel));
        let kelvin = |act: &Act| match act {
            Act::Board(to) => to
                .iter()
                .find(|(it, _)| *it == DigitalOut::KelvinTest)
                .copied(),
            _ => None,
        };
        let kelvin: Vec<bool> = acts.iter().filter_map(kelvin).map(|(_, on)| on).collect();
        (kelvin, acts.iter().filter(level).count())
    };
    assert_eq!(
        writes(|_| {}),
        (vec![true], 1),
        "both unchanged, so not sent"
    );
    let ended = writes(|it| it.stop(Finding::BoardNotRead));
    assert_eq!(ended, (vec![false, true], 2), "each one changed twice");
}

#[test]
fn refused_replies_and_restarted_modules_void_the_part() {
    // No Kelvin bit is set, so the test goes from the pins straight to off.
    let test = fails_at(&board());
    let why = Verdict::Void(vec![Reason::rig_trouble(refused())]);
    assert_eq!(test.verdict(), why);
    assert_eq!(test.verdict().bin(), Bin::RETEST);
    let restarted = fails_at(&Job::Restarts);
    assert_eq!(restarted.verdict().name(), "void");
    assert_eq!(restarted.stage, Stage::Off);
}

#[test]
fn the_first_cause_of_an_early_end_stays() {
    let mut record = TestRecord::default();
    record.stop(Finding::CoilOpen);
    record.stop(Finding::CoilCurrentRemains);
    let mut test = Test::begin(context(), MockRig::at_rest().now);
    test.state.record = record;
    let reason = Finding::CoilOpen.into();
    assert_eq!(test.verdict(), Verdict::Fail(vec![reason]));
}

fn measured(values: &[(Parameter, f64)]) -> Test {
    let mut test = Test::begin(context(), MockRig::at_rest().now);
    for (parameter, value) in values {
        let reading = Reading {
            value: *value,
            unit: parameter.facts().definition.unit,
            budget: Budget::default().with("test", 0.005),
        };
        test.state.record.found::<Sample>(*parameter, reading, []);
    }
    test
}

const GOOD: [(Parameter, f64); 9] = [
    (Parameter::CoilResistance, 400.0),
    (Parameter::OperateVoltage, 7.88),
    (Parameter::ReleaseVoltage, 2.35),
    (Parameter::OperateTime, 4.7),
    (Parameter::ReleaseTime, 2.9),
    (Parameter::OperateBounce, 0.6),
    (Parameter::ReleaseBounce, 0.8),
    (Parameter::ContactResistanceNo, 18.0),
    (Parameter::ContactResistanceNc, 22.0),
];

#[test]
fn a_part_needs_all_nine_results_to_pass() {
    assert_eq!(GOOD.len(), parameter::Parameter::ALL.len());
    assert_eq!(measured(&GOOD).verdict(), Verdict::Pass);
    for missing in 0..GOOD.len() {
        let mut values = GOOD.to_vec();
        let (parameter, _) = values.remove(missing);
        let verdict = measured(&values).verdict();
        let why = Reason::of(Code::NotMeasured(parameter.into()));
        assert_eq!(verdict, Verdict::Void(vec![why]));
    }
}

#[test]
fn only_results_inside_the_guard_band_repeat_once() {
    let slow = |value: f64| {
        let mut values = GOOD;
        values[1].1 = value;
        let mut test = measured(&values);
        test.stages.clear();
        test.add_slow_repeats();
        test.add_slow_repeats();
        test.stages.into_iter().collect::<Vec<_>>()
    };
    assert_eq!(slow(8.9), []);
    assert_eq!(slow(9.1), []);
    assert_eq!(slow(8.995), [Stage::OperateFine(0); 3]);
}

#[test]
fn another_supply_range_prevents_every_drive() {
    let mut context = context();
    let wiring = crate::handling::tests::wiring();
    let mut ranges = wiring.supply_ranges.iter();
    context.range = ranges.find(|range| range.code == 1).cloned();
    let drive = context.points.output(DigitalOut::CoilDrive);
    let mut mock = MockRig::at_rest();
    mock.track(23.0);
    let mut test = Test::begin(context, mock.now);
    let mut done = None;
    loop {
        match test.step(mock.now, done.take().as_ref(), &mock.image) {
            Progress::Running(RunnerState::Job(requested)) => {
                let drives = |outputs: &[_]| outputs.contains(&(drive, true));
                assert!(!matches!(&requested, Job::Set(outputs) if drives(outputs)));
                mock.after(4);
                done = Some(JobDone::new(mock.now, None));
            }
            Progress::Running(RunnerState::Wait(until)) => {
                mock.now = until;
                mock.scan();
            }
            Progress::Running(other) => panic!("{other:?}"),
            Progress::Judged => break,
        }
        mock.volts(AnalogIn::CoilCurrentFine, 0.0);
    }
    let mismatch = test.range_mismatch().unwrap();
    assert_eq!(mismatch.to_string(), "x0_75, not x1_5");
    assert_eq!(test.verdict().bin(), Bin::RETEST);
}
