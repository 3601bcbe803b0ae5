//! The acts of one trial: from rest or from a sealed armature to a level, and a look at the contacts.

use super::{REACH, Search, parameter};
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::measure::operate::dropped;
use crate::dut::em_relay::measure::operate_fine::APPROACH;
use crate::dut::em_relay::measure::pace::Pace;
use crate::dut::em_relay::measure::{Context, INTERLOCK, OFF, TestRecord, board};
use crate::dut::em_relay::points::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::dut::em_relay::supply::Supply;
use crate::dut::em_relay::threshold::Direction;
use crate::units::{Span, Volt};

/// Flux and armature from one level to the next while the armature is sealed.
const SEALS: Span = Span::ms(25);
/// Fraction of nominal at which the armature is sealed.
const SEAL: f64 = 0.95;

pub(in crate::dut::em_relay::measure) fn acts(
    context: &Context,
    supply: &mut Supply,
    record: &mut TestRecord,
    direction: Direction,
) -> Vec<Act> {
    record.armed = false;
    let Some(part) = record.track else {
        return Vec::new();
    };
    let known = record.search.filter(|search| search.direction == direction);
    let search = known.unwrap_or_else(|| {
        Search::new(
            context,
            context.strategy(parameter(direction)),
            direction,
            part,
        )
    });
    record.search = Some(search);
    let test = &context.relay.test;
    let near = Volt(test.expected_release_v + REACH * test.expected_release_sd_v);
    let mut acts = Vec::new();
    if search.begins_anew() {
        acts.extend(match direction {
            Direction::Rising => from_rest(supply, record, search.at),
            Direction::Falling => from_sealed(context, supply, record, near),
        });
    }
    acts.extend([
        supply.step_to(search.at),
        Act::Wait(search.dwell(Pace::of(record))),
        Act::Read(Read::Board),
        Act::Mark,
    ]);
    acts
}

/// Off until the armature is back and both ramps are down, then two steps towards `at`: a single one from zero picks up
/// some 30 mV below the threshold.
fn from_rest(supply: &mut Supply, record: &mut TestRecord, at: Volt) -> Vec<Act> {
    let pace = Pace::of(record);
    let mut acts = dropped(record);
    let (coarse, takes) = supply.ramp_coarse(Volt(0.0));
    let still_ramping = std::mem::take(&mut record.still_ramping);
    acts.extend([
        coarse,
        Act::Wait(takes),
        Act::RampSinceMark(OFF.max(pace.approaches()).max(still_ramping)),
        supply.step_to(at * APPROACH),
        board(&[
            (RampMode, false),
            (SelectNo, true),
            (EventNoBreak, false),
            (CoilDrive, true),
        ]),
        Act::Wait(pace.approaches()),
    ]);
    acts
}

/// Operated and sealed at 0.95 of nominal.
fn from_sealed(
    context: &Context,
    supply: &mut Supply,
    record: &mut TestRecord,
    near: Volt,
) -> Vec<Act> {
    (record.operated, record.released) = (false, false);
    let still_ramping = std::mem::take(&mut record.still_ramping);
    let mut acts = Vec::new();
    let (coarse, takes) = supply.ramp_coarse(Volt(0.0));
    if record.operate.is_some() && record.search.is_none_or(|search| search.trials == 0) {
        acts.extend([coarse, Act::Wait(takes)]);
    }
    acts.extend([
        // What still falls would seal at more than nominal.
        Act::Wait(still_ramping),
        supply.step_to(Volt(SEAL * context.relay.part.nominal_v)),
        board(&[
            (SourceOn, false),
            (SourceReverse, false),
            (RampMode, true),
            (SelectNo, true),
            (Arm, false),
            (CoilDrive, true),
        ]),
        Act::Wait(INTERLOCK + SEALS),
        // The flux of a sealed armature falls slowly: from the near end of the interval, not from above.
        supply.step_to(near),
        Act::Wait(SEALS),
    ]);
    acts
}
