//! The acts of one trial: from rest or from a sealed armature to a level, and a look at the contacts.

use super::{REACH, Search, parameter};
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::measure::operate::dropped;
use crate::dut::em_relay::measure::operate_fine::APPROACH;
use crate::dut::em_relay::measure::pace::Pace;
use crate::dut::em_relay::measure::{Bench, Findings, INTERLOCK, OFF, board};
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
    bench: &Bench,
    supply: &mut Supply,
    findings: &mut Findings,
    direction: Direction,
) -> Vec<Act> {
    findings.armed = false;
    let Some(part) = findings.track else {
        return Vec::new();
    };
    let known = findings
        .search
        .filter(|search| search.direction == direction);
    let search = known.unwrap_or_else(|| {
        Search::new(bench, bench.strategy(parameter(direction)), direction, part)
    });
    findings.search = Some(search);
    let test = &bench.recipe.test;
    let near = Volt(test.expected_release_v + REACH * test.expected_release_sd_v);
    let mut acts = Vec::new();
    if search.begins_anew() {
        acts.extend(match direction {
            Direction::Rising => from_rest(supply, findings, search.at),
            Direction::Falling => from_sealed(bench, supply, findings, near),
        });
    }
    acts.extend([
        supply.step_to(search.at),
        Act::Wait(search.dwell(Pace::of(findings))),
        Act::Read(Read::Board),
        Act::Mark,
    ]);
    acts
}

/// Off until the armature is back and both ramps are down, then two steps towards `at`: a single one from zero picks up
/// some 30 mV below the threshold.
fn from_rest(supply: &mut Supply, findings: &mut Findings, at: Volt) -> Vec<Act> {
    let pace = Pace::of(findings);
    let mut acts = dropped(findings);
    let (coarse, takes) = supply.ramp_coarse(Volt(0.0));
    let still_ramping = std::mem::take(&mut findings.still_ramping);
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
    bench: &Bench,
    supply: &mut Supply,
    findings: &mut Findings,
    near: Volt,
) -> Vec<Act> {
    (findings.operated, findings.released) = (false, false);
    let still_ramping = std::mem::take(&mut findings.still_ramping);
    let mut acts = Vec::new();
    let (coarse, takes) = supply.ramp_coarse(Volt(0.0));
    if findings.operate.is_some() && findings.search.is_none_or(|search| search.trials == 0) {
        acts.extend([coarse, Act::Wait(takes)]);
    }
    acts.extend([
        // What still falls would seal at more than nominal.
        Act::Wait(still_ramping),
        supply.step_to(Volt(SEAL * bench.recipe.part.nominal_v)),
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
