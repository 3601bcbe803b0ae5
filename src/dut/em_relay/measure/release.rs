//! Release voltage: from a sealed armature the supply falls until NO breaks, coarse first, then fine.
//!
//! The armature is sealed at 0.95 of nominal: enough to saturate it, and not an operation at nominal
//! voltage, so the timed one stays the last of those.

use super::indication::{fine_reading, gate0};
use super::operate::{SETTLES, release_start};
use super::operate_fine::{REPEAT_SD_V, again};
use super::ramp::{self, Expected, Met};
use super::search::Search;
use super::{Context, INTERLOCK, Ramp, Stage, TestRecord, board};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::points::DigitalIn;
use crate::dut::em_relay::points::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::supply::Supply;
use crate::dut::em_relay::threshold::{Direction, indicated};
use crate::units::{Span, Volt};

/// Fraction of nominal at which the armature is sealed.
const SEAL: f64 = 0.95;
/// Within so many refreshes of its end the output may have stopped already: an event there is no estimate.
const LAST_REFRESHES: f64 = 1.5;
/// Operate, bounce and settling of the flux.
const SEAL_TIME: Span = Span::ms(25);
/// The flux of the seal has fallen to a few per cent of its step before a fine ramp begins; what the coarse ramp
/// has left of it, after [`SETTLES`], its lag has learned.
const FINE_SETTLES: Span = Span::ms(35);
/// Slowest break after the end of a ramp that is still taken for its event.
const LATE: Span = Span::ms(12);

/// Seals the armature, steps to where a falling ramp begins and arms it. An armature that is still operated from the stage
/// before is sealed from there, once the ramp that may still run has ended.
fn seal(context: &Context, supply: &mut Supply, record: &mut TestRecord, start: Volt) -> Vec<Act> {
    let operated = std::mem::take(&mut record.operated);
    record.released = false;
    let seal = supply.step_to(Volt(SEAL * context.relay.part.nominal_v));
    // No current: the contact that the ramp breaks was read before, if at all.
    let falling = [
        (SourceOn, false),
        (SourceReverse, false),
        (RampMode, true),
        (SelectNo, true),
        (EventNoBreak, true),
        (Arm, false),
    ];
    let mut acts = Vec::new();
    if operated {
        acts.extend([seal, board(&falling)]);
    } else {
        acts.extend([
            board(&[
                (CoilDrive, false),
                (SourceOn, false),
                (SourceReverse, false),
            ]),
            Act::Wait(INTERLOCK),
            board(&falling),
            seal,
            board(&[(CoilDrive, true)]),
            Act::Mark,
        ]);
    }
    let still_ramping = std::mem::take(&mut record.still_ramping);
    acts.extend([
        Act::RampSinceMark(SEAL_TIME.max(still_ramping)),
        supply.step_to(start),
        Act::Mark,
        board(&[(Arm, true)]),
    ]);
    record.ramp_start = Some(supply.total());
    acts
}

/// Flux and armature settle after the step; the counters are read meanwhile. ARM is a pulse: it may rise again as soon
/// as the contact has broken.
fn settled(within: Span) -> [Act; 3] {
    [
        Act::Read(Read::Gates),
        board(&[(Arm, false)]),
        Act::WaitSinceMark(within),
    ]
}

/// The drive goes off once NO has broken; from that event on the armature falls.
fn until_break(takes: Span) -> [Act; 4] {
    [
        Act::Until {
            point: DigitalIn::Latch,
            within: takes + LATE,
        },
        Act::Mark,
        board(&[(CoilDrive, false), (EventNoBreak, false)]),
        Act::Read(Read::Gate),
    ]
}

pub(super) fn acts_coarse(
    context: &Context,
    supply: &mut Supply,
    record: &mut TestRecord,
) -> Vec<Act> {
    let mut acts = Vec::new();
    if supply.coarse() != release_start(context) {
        let (ramp, takes) = supply.ramp_coarse(release_start(context));
        acts.extend([ramp, Act::Wait(takes)]);
    }
    let start = supply.coarse() + supply.fine();
    acts.extend(seal(context, supply, record, start));
    acts.extend(settled(SETTLES));
    let (ramp, takes) = supply.ramp_coarse(Volt(0.0));
    acts.push(ramp);
    acts.extend(until_break(takes));
    acts
}

pub(super) fn conclude_coarse(
    context: &Context,
    readings: &Readings,
    record: &mut TestRecord,
) -> Option<Stage> {
    let (start, test) = (record.ramp_start?, &context.relay.test);
    let coarse_v_per_s = context.calibration.coarse_v_per_s.value;
    let seen = readings.seen.first() == Some(&true);
    let floor_v = coarse_v_per_s * LAST_REFRESHES * context.accuracy.ao_refresh_ms * 1e-3;
    let gate =
        gate0(context, readings).filter(|gate| seen && coarse_v_per_s * gate.0 < start.0 - floor_v);
    record.released = true;
    let Some(gate) = gate else {
        // Below its floor the coarse ramp tells nothing: the threshold is far from the lot's.
        let expected = Expected::new(Volt(test.expected_release_v), test.expected_release_sd_v);
        record.expected_release = Some(expected);
        record.search = Some(Search::placing(context, record, Direction::Falling));
        return Some(Stage::Search(Direction::Falling));
    };
    let coarse = indicated(start, coarse_v_per_s, gate, Direction::Falling);
    let (seen, lag) = (
        record.shown(coarse, Direction::Falling),
        context.release_lag(),
    );
    record.release = Some(Ramp {
        coarse: seen,
        fine: None,
    });
    let told = (seen, lag, Direction::Falling);
    ramp::after_coarse(context, readings, record, told).then_some(Stage::ReleaseFine(0))
}

pub(super) fn acts_fine(
    context: &Context,
    supply: &mut Supply,
    record: &mut TestRecord,
) -> Vec<Act> {
    let repeated = record
        .release
        .and_then(|ramp| ramp.fine)
        .map(|fine| Expected::new(fine, REPEAT_SD_V));
    let Some(expected) = repeated.or(record.expected_release) else {
        return Vec::new();
    };
    record.expected_release = Some(expected);
    let placed = expected.falling();
    let way = placed.span - ramp::JUMP;
    let mut acts = Vec::new();
    if supply.fine() < way {
        let (fine, takes) = supply.ramp_fine(way);
        // A ramp that rises goes on, one that falls turns round.
        let rises = if record.operated {
            record.still_ramping
        } else {
            Span(0)
        };
        record.still_ramping = rises + takes;
        acts.push(fine);
    }
    let least = supply.coarse() + supply.fine() + ramp::JUMP;
    let start = placed.start.0.max(least.0);
    acts.extend(seal(context, supply, record, Volt(start)));
    record.ramp_span = Some(placed.span);
    acts.push(supply.step_to(Volt(start) - ramp::JUMP));
    acts.extend(settled(FINE_SETTLES));
    let (ramp, takes) = supply.ramp_fine(supply.fine() - way);
    record.ramp_takes = takes;
    acts.push(ramp);
    acts.extend(until_break(takes));
    acts
}

pub(super) fn conclude_fine(
    context: &Context,
    readings: &Readings,
    record: &mut TestRecord,
    attempt: u8,
) -> Option<Stage> {
    record.released = true;
    let (seen, gate) = match ramp::meet(context, readings, record, Direction::Falling, attempt)? {
        Met::At(seen, gate) => (seen, gate),
        Met::Again => return Some(again(context, record, Direction::Falling, attempt)),
    };
    let part = record.track?;
    if record.release.is_none_or(|ramp| ramp.fine.is_none()) {
        record.forget(Parameter::ReleaseVoltage);
    }
    match &mut record.release {
        Some(ramp) => ramp.fine = Some(seen),
        None => record.release = Some(Ramp::fine_only(seen)),
    }
    let ramps = record.release?;
    let reading = fine_reading(context, (ramps, gate), part, Direction::Falling);
    let samples: Vec<_> = readings.gates.iter().flatten().collect();
    record.found(Parameter::ReleaseVoltage, reading, samples);
    None
}
