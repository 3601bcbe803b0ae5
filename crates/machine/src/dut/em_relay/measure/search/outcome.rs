//! Consequences of a trial: another trial, a value, a proof, or ramps.

use super::{AFTER_SEARCH, Next, Search, parameter};
use crate::dut::em_relay::Finding;
use crate::dut::em_relay::coil::{relative_per_kelvin, to_reference};
use crate::dut::em_relay::measure::board::Armature;
use crate::dut::em_relay::measure::ramp::Expected;
use crate::dut::em_relay::measure::state::TestState;
use crate::dut::em_relay::measure::{Context, Stage};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::threshold::Direction;
use crate::gauge::Judgement;
use crate::gauge::budget::{Budget, Reading, resolution};
use crate::rig::sample::CountSample;
use units::{Unit, Volt};

/// Least standard deviation assumed for a threshold that a search by levels has found, for a 12 V coil.
const LEAST_SD: Volt = Volt(0.010);

pub(in crate::dut::em_relay::measure) fn conclude(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
    direction: Direction,
) -> Option<Stage> {
    let Some(seen) = readings.boards.last() else {
        state.record.stop(Finding::BoardNotRead);
        return None;
    };
    let mut search = Search::under_way(context, &state.plan, &state.record, direction);
    let rising = direction == Direction::Rising;
    let next = search.after(seen.no_closed == rising);
    if rising && seen.no_closed {
        state.board.armature = Armature::Operated;
    }
    if let Next::Try(level) = next {
        search.at = level;
        state.plan.search = Some(search);
        return Some(Stage::Search(direction));
    }
    state.plan.search = None;
    if context.strategy(parameter(direction)).ramps() {
        return placed(context, state, direction, next);
    }
    match next {
        Next::Found(volts, step) => {
            found(context, state, direction, (volts, step), &readings.gates)
        }
        Next::Proven => {
            let judgement = (parameter(direction), Judgement::Pass);
            state.record.own.proven.push(judgement);
        }
        Next::Ramp if rising => return Some(Stage::OperateCoarse),
        Next::Ramp => return Some(Stage::ReleaseCoarse),
        Next::Try(_) => {}
    }
    None
}

/// Places the fine ramp around the threshold that the search has found.
fn placed(
    context: &Context,
    state: &mut TestState,
    direction: Direction,
    next: Next,
) -> Option<Stage> {
    let Next::Found(volts, step) = next else {
        state
            .record
            .stop(Finding::SearchWithoutThreshold(direction));
        return None;
    };
    let expected = near(context, direction, volts, step);
    state.plan.expect(direction, expected);
    Some(match direction {
        Direction::Rising => Stage::OperateFine(AFTER_SEARCH),
        Direction::Falling => Stage::ReleaseFine(AFTER_SEARCH),
    })
}

/// Returns the interval in which a fine ramp will indicate a threshold found by levels.
fn near(context: &Context, direction: Direction, volts: Volt, step: Volt) -> Expected {
    Expected::new(
        volts + Volt(context.overshoot(direction).fine_v.value),
        step.abs().0.max(context.scale().of_coil(LEAST_SD).0),
    )
}

fn found(
    context: &Context,
    state: &mut TestState,
    direction: Direction,
    (volts, step): (Volt, Volt),
    samples: &[[CountSample; 2]],
) {
    let Some(part) = state.record.own.track else {
        return;
    };
    let expected = near(context, direction, volts, step);
    state.plan.expect(direction, expected);
    let value = volts.0 * to_reference(part, context.reference_temperature());
    let level = context.calibration.level;
    let temperature = context.part_k().times(value * relative_per_kelvin(part));
    let budget = Budget::default()
        .with("level", (value * level.gain.u).hypot(level.offset_v.u))
        .with("probe contact", value * context.contact_share())
        .with("strategy", resolution(step.0))
        .with_random("repeatability", context.operation_v())
        .with_estimated("coil temperature", temperature);
    let reading = Reading {
        value,
        unit: Unit::Volt,
        budget,
    };
    let samples = samples.iter().flatten();
    state.record.found(parameter(direction), reading, samples);
}
