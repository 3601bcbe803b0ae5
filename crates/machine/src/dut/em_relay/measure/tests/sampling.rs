//! Number of readings of coil and contacts that a recipe demands.

use super::super::{Ramp, Stage, Test};
use super::{at_23_c, context, good, scan};
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::contact::ContactDrop;
use crate::dut::em_relay::measure::board::Armature;
use crate::dut::em_relay::measure::{Context, coil};
use crate::dut::em_relay::overshoot::CoarseResults;
use crate::dut::em_relay::points::DigitalOut::{SourceOn, SourceReverse};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::recipe::Strategies;
use crate::dut::em_relay::sampling::Polarities;
use crate::dut::em_relay::{Parameter, Strategy};
use crate::gauge::budget::{Budget, Reading};
use crate::handling::tests::MockRig;
use crate::rig::sample::Sample;
use std::sync::Arc;
use units::{Unit, Volt};

fn with(change: impl Fn(&mut Strategies)) -> Context {
    let mut context = context();
    change(&mut Arc::make_mut(&mut context.relay).test.strategy);
    context
}

fn acts_of(stage: Stage, context: &Context) -> Vec<Act> {
    at_23_c().enter(stage, context)
}

fn directions(acts: &[Act]) -> Vec<bool> {
    let (mut reverse, mut read) = (false, Vec::new());
    for act in acts {
        match act {
            Act::Board(outputs) => {
                let turned = outputs.iter().find(|(point, _)| *point == SourceReverse);
                reverse = turned.map_or(reverse, |(_, on)| *on);
            }
            Act::Read(Read::Drop) => read.push(reverse),
            _ => {}
        }
    }
    read
}

#[test]
fn contacts_are_read_in_the_recipes_polarities() {
    let two = with(|it| it.contact.polarities = Polarities::PlusMinus);
    let four = with(|it| it.contact.polarities = Polarities::PlusMinusMinusPlus);
    for stage in [Stage::NcContact, Stage::TimedOperate] {
        assert_eq!(directions(&acts_of(stage, &two)), [false, true]);
        let acts = acts_of(stage, &four);
        assert_eq!(directions(&acts), [false, true, true, false]);
        let between = acts
            .iter()
            .rev()
            .skip_while(|act| **act != Act::Read(Read::Drop));
        let waits = between
            .filter(|act| matches!(act, Act::ConvertSinceMark(_)))
            .count();
        assert_eq!(waits, 4, "a conversion of its own for each");
    }
}

/// Returns the acts of a coarse release ramp on the closure of the operate ramp.
fn acts_of_ramps(context: &Context) -> Vec<Act> {
    let mut state = at_23_c();
    state.board.armature = Armature::Operated;
    state.record.own.operate = Some(Ramp::coarse_only(CoarseResults::NONE));
    state.enter(Stage::ReleaseCoarse, context)
}

#[test]
fn alternating_closures_are_read_once_each_in_opposite_directions() {
    let alternating = context();
    assert!(alternating.alternates());
    let rest = directions(&acts_of(Stage::NcContact, &alternating));
    assert_eq!(rest, [true], "NC at rest");
    let timed = directions(&acts_of(Stage::TimedOperate, &alternating));
    assert_eq!(timed, [false], "timed NO");
    let ramps = acts_of_ramps(&alternating);
    assert_eq!(directions(&ramps), [true], "NO of the ramps");
    let after = ramps.iter().skip_while(|it| **it != Act::Read(Read::Drop));
    let off = after.into_iter().find_map(|act| match act {
        Act::Board(outputs) => Some(outputs.contains(&(SourceOn, false))),
        Act::Supply(_) => Some(false),
        _ => None,
    });
    assert_eq!(off, Some(true), "the contact breaks without load");
    let coil = acts_of(Stage::Coil, &alternating);
    assert_eq!(directions(&coil).len(), 1, "the zero");
    let mut state = at_23_c();
    state.board.armature = Armature::Operated;
    state.record.own.operate = Some(Ramp::fine_only(Volt(7.9)));
    let after_fine = state.enter(Stage::ReleaseCoarse, &alternating);
    assert!(directions(&after_fine).is_empty(), "closed without source");
    let two = with(|it| it.contact.polarities = Polarities::PlusMinus);
    assert!(directions(&acts_of_ramps(&two)).is_empty());
    assert!(directions(&acts_of(Stage::Coil, &two)).is_empty());
}

#[test]
fn without_coarse_ramps_each_closure_is_read_in_both_directions() {
    for strategy in [Strategy::Pulse, Strategy::Bisection] {
        let searched = with(|it| it.release_voltage_v = strategy);
        assert!(!searched.alternates());
        let timed = directions(&acts_of(Stage::TimedOperate, &searched));
        assert_eq!(timed, [false, true]);
    }
}

#[test]
fn more_coil_scans_reduce_the_uncertainty() {
    let four = with(|it| it.coil.scans = 4);
    let scans = |context: &Context| {
        let acts = acts_of(Stage::Coil, context);
        acts.iter()
            .filter(|act| **act == Act::Read(Read::Coil))
            .count()
    };
    assert_eq!([scans(&context()), scans(&four)], [1, 4]);
    let reading = |times: usize| {
        let mut state = at_23_c();
        let readings = Readings {
            coil: vec![scan(5.0, 0.0125); times],
            track: vec![good(23.0, 1.0)],
            ..Readings::default()
        };
        coil::conclude(&four, &readings, &mut state);
        state.record.result(Parameter::CoilResistance).unwrap()
    };
    let u = |reading: &Reading| reading.budget.0[0].u;
    assert!((u(&reading(1)) / u(&reading(4)) - 2.0).abs() < 1e-9);
}

/// A test at its end, after `closures` closures of NO and NC.
fn after(context: Context, closures: usize, mohm: f64) -> Test {
    let per_v = context.calibration.contact_mohm_per_v.value;
    let mut test = Test::begin(context, MockRig::at_rest().now);
    test.stages.clear();
    let mut found = |parameter, value, unit| {
        let budget = Budget::default().with("test", 0.05);
        let reading = Reading {
            value,
            unit,
            budget,
        };
        test.state.record.found::<Sample>(parameter, reading, []);
    };
    found(Parameter::ContactResistanceNo, mohm, Unit::Milliohm);
    found(Parameter::ContactResistanceNc, mohm, Unit::Milliohm);
    for _ in 0..closures {
        found(Parameter::OperateTime, 4.7, Unit::Millisecond);
    }
    let drops = vec![ContactDrop::single(Volt(mohm / per_v), false, 0.003); closures + 1];
    (test.state.plan.no, test.state.plan.nc) = (drops.clone(), drops);
    test
}

#[test]
fn closures_repeat_up_to_the_recipes_number() {
    let pair = [Stage::TimedOperate, Stage::TimedRelease];
    for (closures, had, more) in [(1, 1, false), (3, 1, true), (3, 2, true), (3, 3, false)] {
        let mut test = after(with(|it| it.contact.closures = closures), had, 18.0);
        test.add_closure();
        let expected: &[Stage] = if more { &pair } else { &[] };
        assert_eq!(test.stages, expected, "{had} of {closures}");
    }
}

#[test]
fn an_early_stop_repeats_only_marginal_contacts() {
    let early = || {
        with(|it| {
            it.contact.closures = 8;
            it.contact.stops_early = true;
        })
    };
    for (mohm, more) in [(18.0, false), (90.0, true), (180.0, false)] {
        let mut test = after(early(), 1, mohm);
        test.add_closure();
        assert_eq!(!test.stages.is_empty(), more, "{mohm} mOhm");
    }
}

#[test]
fn a_further_closure_begins_with_the_source_off() {
    let first = acts_of(Stage::TimedOperate, &context());
    let words = first.iter().filter_map(|act| match act {
        Act::Board(outputs) => Some(outputs),
        _ => None,
    });
    let armed = words
        .into_iter()
        .find(|word| word.contains(&(crate::dut::em_relay::points::DigitalOut::Arm, true)))
        .unwrap();
    assert!(armed.contains(&(SourceOn, false)) && armed.contains(&(SourceReverse, false)));
}
