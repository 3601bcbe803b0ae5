//! What a trial leads to: another one, a value, a proof, or ramps after all.

use super::{AFTER_SEARCH, Next, parameter};
use crate::dut::em_relay::Finding;
use crate::dut::em_relay::coil::{relative_per_kelvin, to_reference};
use crate::dut::em_relay::measure::ramp::Expected;
use crate::dut::em_relay::measure::{Context, Stage, TestRecord};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::threshold::Direction;
use crate::gauge::Judgement;
use crate::gauge::budget::{Budget, Reading, resolution};
use crate::rig::sample::CountSample;
use crate::units::{Span, Volt};

pub(in crate::dut::em_relay::measure) fn conclude(
    context: &Context,
    readings: &Readings,
    record: &mut TestRecord,
    direction: Direction,
) -> Option<Stage> {
    let (Some(seen), Some(mut search)) = (readings.boards.last(), record.search) else {
        record.stop(Finding::BoardNotRead);
        return None;
    };
    let rising = direction == Direction::Rising;
    let next = search.after(seen.no_closed == rising);
    record.operated = rising && seen.no_closed;
    record.still_ramping = Span(0);
    if let Next::Try(level) = next {
        search.at = level;
        record.search = Some(search);
        return Some(Stage::Search(direction));
    }
    record.search = None;
    if context.strategy(parameter(direction)).ramps() {
        return placed(context, record, direction, next);
    }
    match next {
        Next::Found(volts, step) => found(context, record, direction, volts, step, &readings.gates),
        Next::Proven => {
            let judgement = (parameter(direction), Judgement::Pass);
            record.proven.push(judgement);
        }
        Next::Ramp if rising => return Some(Stage::OperateCoarse),
        Next::Ramp => return Some(Stage::ReleaseCoarse),
        Next::Try(_) => {}
    }
    None
}

/// The fine ramp goes where a search in its service has found the threshold.
fn placed(
    context: &Context,
    record: &mut TestRecord,
    direction: Direction,
    next: Next,
) -> Option<Stage> {
    let Next::Found(volts, step) = next else {
        record.stop(Finding::SearchWithoutThreshold(direction));
        return None;
    };
    *record.expected(direction) = Some(near(context, direction, volts, step));
    Some(match direction {
        Direction::Rising => Stage::OperateFine(AFTER_SEARCH),
        Direction::Falling => Stage::ReleaseFine(AFTER_SEARCH),
    })
}

/// Where a fine ramp will show a threshold that levels have found.
fn near(context: &Context, direction: Direction, volts: Volt, step: Volt) -> Expected {
    let lag = match direction {
        Direction::Rising => context.operate_lag(),
        Direction::Falling => context.release_lag(),
    };
    Expected::new(volts + Volt(lag.fine_v.value), step.0.abs().max(0.010))
}

fn found(
    context: &Context,
    record: &mut TestRecord,
    direction: Direction,
    volts: Volt,
    step: Volt,
    samples: &[[CountSample; 2]],
) {
    let Some(part) = record.track else { return };
    *record.expected(direction) = Some(near(context, direction, volts, step));
    let value = volts.0 * to_reference(part, context.reference_temperature());
    let (level, kelvin) = (
        context.calibration.level,
        context.accuracy.part_minus_track_k,
    );
    let budget = Budget::default()
        .with("level", (value * level.gain.u).hypot(level.offset_v.u))
        .with(
            "coil temperature",
            value * kelvin * relative_per_kelvin(part),
        )
        .with("probe contact", value * context.contact_share())
        .with("strategy", resolution(step.0))
        .with_random("repeatability", context.operation_v());
    let reading = Reading { value, budget };
    record.found(parameter(direction), reading, samples.iter().flatten());
}
