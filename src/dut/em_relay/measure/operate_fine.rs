//! Operate voltage on the fine ramp, around the estimate of the coarse one.
//!
//! Between both the relay drops. The approach has two steps (0.93 of the start, then the start) because
//! a step from zero picks up some 30 mV below the quasi-static threshold: the armature swings over.

use super::indication::fine_reading;
use super::operate::{LATE, dropped};
use super::pace::Pace;
use super::ramp::{self, Expected, Met};
use super::search::{AFTER_SEARCH, Search};
use super::{Context, OFF, Ramp, Stage, TestRecord, board};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::points::DigitalIn;
use crate::dut::em_relay::points::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::supply::Supply;
use crate::dut::em_relay::threshold::Direction;
use crate::units::{Span, Volt};

/// First step of the approach, as a fraction of the start of the fine ramp.
pub(super) const APPROACH: f64 = 0.93;
/// Scatter of a repeated fine ramp around the first, volts.
pub(super) const REPEAT_SD_V: f64 = 0.008;

pub(super) fn acts(context: &Context, supply: &mut Supply, record: &mut TestRecord) -> Vec<Act> {
    let repeated = record
        .operate
        .and_then(|ramp| ramp.fine)
        .map(|fine| Expected::new(fine, REPEAT_SD_V));
    let Some(expected) = repeated.or(record.expected_operate) else {
        return Vec::new();
    };
    record.expected_operate = Some(expected);
    let pace = Pace::of(record);
    let placed = expected.rising(pace.run_up(context.calibration.fine_v_per_s.value));
    let falls = falling(record);
    let mut acts = dropped(record);
    acts.extend(make_room(context, supply, falls, placed.start));
    acts.extend([
        supply.step_to(placed.start * APPROACH),
        // At the first step the supply may still fall.
        Act::WaitSinceMark(OFF.max(Span(falls.0.saturating_sub(pace.approaches().0)))),
        board(&[
            (SourceOn, false),
            (SourceReverse, false),
            (RampMode, true),
            (SelectNo, true),
            (EventNoBreak, false),
            (CoilDrive, true),
        ]),
        Act::Wait(pace.approaches()),
        supply.step_to(placed.start),
        Act::Mark,
        board(&[(Arm, true)]),
    ]);
    record.ramp_start = Some(supply.total());
    record.ramp_span = Some(placed.span);
    acts.extend([
        supply.step_to(placed.start + ramp::JUMP),
        Act::Read(Read::Gates),
        Act::WaitSinceMark(pace.settles()),
    ]);
    let (ramp, takes) = supply.ramp_fine(supply.fine() + placed.span - ramp::JUMP);
    record.ramp_takes = takes;
    acts.extend([
        ramp,
        Act::Until {
            point: DigitalIn::Latch,
            within: takes + LATE,
        },
        Act::Mark,
        Act::Read(Read::Gate),
    ]);
    acts
}

/// How long after the mark a ramp still falls that nobody has waited for; one that rises is turned round.
fn falling(record: &mut TestRecord) -> Span {
    let left = std::mem::take(&mut record.still_ramping);
    if record.released { left } else { Span(0) }
}

/// Takes the ramps back when they stand higher than the approach needs, or the fine one stands at all: further down
/// than where it `falls` to already.
fn make_room(context: &Context, supply: &mut Supply, falls: Span, start: Volt) -> Vec<Act> {
    let mut acts = Vec::new();
    let mut wait = Span(0);
    if supply.fine() > Volt(0.02) {
        let (fine, takes) = supply.ramp_fine(Volt(0.0));
        acts.push(fine);
        wait = falls + takes;
    }
    let room = (start.0 * APPROACH - 0.3).clamp(0.0, context.relay.test.coarse_span_v);
    if supply.coarse().0 > room + 0.05 {
        let (coarse, takes) = supply.ramp_coarse(Volt(room));
        acts.push(coarse);
        wait = wait.max(takes);
    }
    if wait > Span(0) {
        acts.push(Act::Wait(wait));
    }
    acts
}

pub(super) fn conclude(
    context: &Context,
    readings: &Readings,
    record: &mut TestRecord,
    attempt: u8,
) -> Option<Stage> {
    let (seen, gate) = match ramp::meet(context, readings, record, Direction::Rising, attempt)? {
        Met::At(seen, gate) => (seen, gate),
        Met::Again => return Some(again(context, record, Direction::Rising, attempt)),
    };
    record.operated = true;
    let part = record.track?;
    if record.operate.is_none_or(|ramp| ramp.fine.is_none()) {
        record.forget(Parameter::OperateVoltage);
    }
    match &mut record.operate {
        Some(ramp) => ramp.fine = Some(seen),
        None => record.operate = Some(Ramp::fine_only(seen)),
    }
    let ramps = record.operate?;
    let reading = fine_reading(context, (ramps, gate), part, Direction::Rising);
    let samples: Vec<_> = readings.gates.iter().flatten().collect();
    record.found(Parameter::OperateVoltage, reading, samples);
    None
}

/// After a first miss the neighbour is tried; after a second, or when that is wide, the threshold is searched by halves.
pub(super) fn again(
    context: &Context,
    record: &mut TestRecord,
    direction: Direction,
    attempt: u8,
) -> Stage {
    let wide = record.expected(direction).is_some_and(|it| it.is_wide());
    if attempt + 1 == AFTER_SEARCH || attempt + 1 < AFTER_SEARCH && wide {
        record.search = Some(Search::placing(context, record, direction));
        return Stage::Search(direction);
    }
    match direction {
        Direction::Rising => Stage::OperateFine(attempt + 1),
        Direction::Falling => Stage::ReleaseFine(attempt + 1),
    }
}
