//! Release voltage: from a sealed armature the supply falls until NO breaks, coarse first, then fine.
//!
//! The armature is sealed at 0.95 of nominal: enough to saturate it, and not an operation at nominal
//! voltage, so the timed one stays the last of those.

use super::indication::{fine_reading, gate0};
use super::operate::{SETTLES, release_start};
use super::operate_fine::{REPEAT_SD_V, again};
use super::ramp::{self, Expected, Met};
use super::search::Search;
use super::{Bench, Findings, INTERLOCK, Ramp, Stage, board};
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
fn seal(bench: &Bench, supply: &mut Supply, findings: &mut Findings, start: Volt) -> Vec<Act> {
    let operated = std::mem::take(&mut findings.operated);
    findings.released = false;
    let seal = supply.step_to(Volt(SEAL * bench.recipe.part.nominal_v));
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
    let still_ramping = std::mem::take(&mut findings.still_ramping);
    acts.extend([
        Act::RampSinceMark(SEAL_TIME.max(still_ramping)),
        supply.step_to(start),
        Act::Mark,
        board(&[(Arm, true)]),
    ]);
    findings.ramp_start = Some(supply.total());
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

pub(super) fn acts_coarse(bench: &Bench, supply: &mut Supply, findings: &mut Findings) -> Vec<Act> {
    let mut acts = Vec::new();
    if supply.coarse() != release_start(bench) {
        let (ramp, takes) = supply.ramp_coarse(release_start(bench));
        acts.extend([ramp, Act::Wait(takes)]);
    }
    let start = supply.coarse() + supply.fine();
    acts.extend(seal(bench, supply, findings, start));
    acts.extend(settled(SETTLES));
    let (ramp, takes) = supply.ramp_coarse(Volt(0.0));
    acts.push(ramp);
    acts.extend(until_break(takes));
    acts
}

pub(super) fn conclude_coarse(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
) -> Option<Stage> {
    let (start, test) = (findings.ramp_start?, &bench.recipe.test);
    let coarse_v_per_s = bench.calibration.coarse_v_per_s.value;
    let seen = readings.seen.first() == Some(&true);
    let floor_v = coarse_v_per_s * LAST_REFRESHES * bench.accuracy.ao_refresh_ms * 1e-3;
    let gate =
        gate0(bench, readings).filter(|gate| seen && coarse_v_per_s * gate.0 < start.0 - floor_v);
    findings.released = true;
    let Some(gate) = gate else {
        // Below its floor the coarse ramp tells nothing: the threshold is far from the lot's.
        let expected = Expected::new(Volt(test.expected_release_v), test.expected_release_sd_v);
        findings.expected_release = Some(expected);
        findings.search = Some(Search::placing(bench, findings, Direction::Falling));
        return Some(Stage::Search(Direction::Falling));
    };
    let coarse = indicated(start, coarse_v_per_s, gate, Direction::Falling);
    let (seen, lag) = (
        findings.shown(coarse, Direction::Falling),
        bench.release_lag(),
    );
    findings.release = Some(Ramp {
        coarse: seen,
        fine: None,
    });
    let told = (seen, lag, Direction::Falling);
    ramp::after_coarse(bench, readings, findings, told).then_some(Stage::ReleaseFine(0))
}

pub(super) fn acts_fine(bench: &Bench, supply: &mut Supply, findings: &mut Findings) -> Vec<Act> {
    let repeated = findings
        .release
        .and_then(|ramp| ramp.fine)
        .map(|fine| Expected::new(fine, REPEAT_SD_V));
    let Some(expected) = repeated.or(findings.expected_release) else {
        return Vec::new();
    };
    findings.expected_release = Some(expected);
    let placed = expected.falling();
    let way = placed.span - ramp::JUMP;
    let mut acts = Vec::new();
    if supply.fine() < way {
        let (fine, takes) = supply.ramp_fine(way);
        // A ramp that rises goes on, one that falls turns round.
        let rises = if findings.operated {
            findings.still_ramping
        } else {
            Span(0)
        };
        findings.still_ramping = rises + takes;
        acts.push(fine);
    }
    let least = supply.coarse() + supply.fine() + ramp::JUMP;
    let start = placed.start.0.max(least.0);
    acts.extend(seal(bench, supply, findings, Volt(start)));
    findings.ramp_span = Some(placed.span);
    acts.push(supply.step_to(Volt(start) - ramp::JUMP));
    acts.extend(settled(FINE_SETTLES));
    let (ramp, takes) = supply.ramp_fine(supply.fine() - way);
    findings.ramp_takes = takes;
    acts.push(ramp);
    acts.extend(until_break(takes));
    acts
}

pub(super) fn conclude_fine(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
    attempt: u8,
) -> Option<Stage> {
    findings.released = true;
    let (seen, gate) = match ramp::meet(bench, readings, findings, Direction::Falling, attempt)? {
        Met::At(seen, gate) => (seen, gate),
        Met::Again => return Some(again(bench, findings, Direction::Falling, attempt)),
    };
    let part = findings.track?;
    if findings.release.is_none_or(|ramp| ramp.fine.is_none()) {
        findings.forget(Parameter::ReleaseVoltage);
    }
    match &mut findings.release {
        Some(ramp) => ramp.fine = Some(seen),
        None => findings.release = Some(Ramp::fine_only(seen)),
    }
    let ramps = findings.release?;
    let reading = fine_reading(bench, (ramps, gate), part, Direction::Falling);
    let samples: Vec<_> = readings.gates.iter().flatten().collect();
    findings.found(Parameter::ReleaseVoltage, reading, samples);
    None
}
