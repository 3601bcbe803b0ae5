//! Timed operation at exactly nominal voltage and timed release into the recipe's clamp, each with its
//! bounce; the closure it ends on is then read for its contact resistance.

use super::coil::rest;
use super::contact::{SOURCE_SETTLES, add_nc, closure, drop_of, is_implausible, reversed};
use super::operate::dropped;
use super::{Bench, Findings, OFF, Stage, board};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::bins;
use crate::dut::em_relay::contact::resistance;
use crate::dut::em_relay::supply::Supply;
use crate::dut::em_relay::timing::{bounce_ms, counts, gate_ms};
use crate::instrument::act::{Act, Read, Readings};
use crate::rig::point::DigitalIn;
use crate::rig::point::DigitalOut::{
    Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::units::{Span, Volt};

/// Slowest operation or release that is still waited for.
const LONGEST: Span = Span::ms(60);
/// The window closes 20 ms after the latch; gate 1 counts bounce until then.
const WINDOW_AFTER_LATCH: Span = Span::ms(21);
/// Gate 1 is open whenever gate 0 is; their delays may differ by so many counts.
const GATE_SKEW: u32 = 4;
/// Bounce is over (6 ms is twice what the sheet class allows) and the contact has been closed for the 5 ms
/// that the source asks for.
const SOURCE_FLOWS: Span = Span::ms(11);

/// Counters are read after ARM, here unless the NC stage has done so: before ARM a window may still be open that an
/// early end has left.
pub(super) fn acts_operate(
    bench: &Bench,
    supply: &mut Supply,
    findings: &mut Findings,
) -> Vec<Act> {
    let mut acts = dropped(findings);
    let off = OFF.max(std::mem::take(&mut findings.still_ramping));
    acts.extend([board(&[
        (SourceOn, false),
        (SourceReverse, false),
        (RampMode, false),
        (SelectNo, true),
        (EventNoBreak, false),
        (Arm, true),
    ])]);
    if !std::mem::take(&mut findings.counted) {
        acts.extend([
            supply.step_to(Volt(bench.recipe.part.nominal_v)),
            Act::Read(Read::Gates),
        ]);
    }
    acts.extend([
        Act::RampSinceMark(off),
        board(&[(CoilDrive, true), (SourceOn, true)]),
    ]);
    acts.extend(until_made());
    acts.extend(drop_of_closure(bench));
    acts.extend(reversed(bench));
    acts
}

/// After a timed operation its counters are taken over: the latch keeps both gates shut until ARM.
pub(super) fn acts_release(
    bench: &Bench,
    supply: &mut Supply,
    findings: &mut Findings,
) -> Vec<Act> {
    let mut acts = Vec::new();
    if !findings.operated {
        acts.extend(dropped(findings));
        acts.extend([
            // Nobody reads this closure: no current is to leave its mark on the contact.
            board(&[(RampMode, false), (EventNoBreak, false), (SourceOn, false)]),
            supply.step_to(Volt(bench.recipe.part.nominal_v)),
            board(&[(CoilDrive, true), (SelectNo, true)]),
            Act::Wait(Span::ms(40)),
        ]);
    }
    let counted = std::mem::take(&mut findings.operated);
    acts.extend([board(&[
        (SourceOn, false),
        (SourceReverse, false),
        (SelectNo, false),
        (Arm, true),
    ])]);
    acts.extend((!counted).then_some(Act::Read(Read::Gates)));
    acts.push(board(&[(CoilDrive, false), (SourceOn, true)]));
    acts.extend(until_made());
    // With the coil off the supply is free, and until the window closes so is the bus.
    acts.extend(rest(bench, supply));
    acts.extend(drop_of_closure(bench));
    acts
}

// ARM rises in the same word as a selection: it clears window and latch, and no selection starts them.

/// The contact event; from its mark the bounce, the window and the source take their time.
fn until_made() -> [Act; 2] {
    [
        Act::Until {
            point: DigitalIn::Latch,
            within: LONGEST,
        },
        Act::Mark,
    ]
}

/// Gates once the window has closed, then the forward drop. The source has been asked for before the
/// contact made: the board lets it flow once the contact has been closed for 5 ms. It drives the same way
/// as the contact monitor, so that gate 1 does not take it for an open contact.
fn drop_of_closure(bench: &Bench) -> [Act; 6] {
    [
        Act::WaitSinceMark(WINDOW_AFTER_LATCH),
        Act::Read(Read::Gates),
        Act::Read(Read::Board),
        board(&[(Arm, false)]),
        Act::ConvertSinceMark(SOURCE_FLOWS + SOURCE_SETTLES + bench.fresh(1)),
        Act::Read(Read::Drop),
    ]
}

/// Both gates of a stage as time and bounce; `false` when the counters were not read twice.
fn time_and_bounce(
    bench: &Bench,
    readings: &Readings,
    time: Parameter,
    bounce: Parameter,
    findings: &mut Findings,
) {
    let [.., before, after] = readings.gates.as_slice() else {
        findings.void("gate counters not read");
        return;
    };
    let gate0 = counts(before[0].count, after[0].count);
    let gate1 = counts(before[1].count, after[1].count);
    let longest = (LONGEST + WINDOW_AFTER_LATCH).as_seconds() * bench.clock().hz;
    // No contact moves within a count: a counter that shows none has restarted since its gate.
    let still = gate0 == 0;
    if still || f64::from(gate0.max(gate1)) > longest || gate1 + GATE_SKEW < gate0 {
        findings.void(format!(
            "gate counters implausible: {gate0} and {gate1} counts"
        ));
        return;
    }
    let samples: Vec<_> = before.iter().chain(after).collect();
    let delay = bench.calibration.gate_delay_us;
    findings.found(
        time,
        gate_ms(gate0, delay[0], bench.clock()),
        samples.clone(),
    );
    findings.found(
        bounce,
        bounce_ms(gate0, gate1, delay, bench.clock()),
        samples,
    );
}

pub(super) fn conclude_operate(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
) -> Option<Stage> {
    if readings.seen.first() != Some(&true) {
        return not_made(readings, findings);
    }
    time_and_bounce(
        bench,
        readings,
        Parameter::OperateTime,
        Parameter::OperateBounce,
        findings,
    );
    findings.operated = true;
    match closure(bench, readings) {
        Ok(closure) => {
            let u = closure.u_v(bench.reading_u_v());
            if let Some(reading) =
                resistance(&[closure.drop], bench.calibration.contact_mohm_per_v, u)
                && !is_implausible("NO contact", reading.value, findings)
            {
                findings.found(Parameter::ContactResistanceNo, reading, &readings.drops);
            }
        }
        Err(unread) => unread.tell("NO contact", findings),
    }
    None
}

/// A relay that is late, or one whose contact does not move: that may lie at the coil, which is then measured
/// before the part is judged.
fn not_made(readings: &Readings, findings: &mut Findings) -> Option<Stage> {
    findings.unmoved = match readings.boards.last() {
        Some(board) if board.no_closed => {
            findings.fail("operate_time_ms high: NO makes too late", bins::TIME);
            None
        }
        Some(board) if board.nc_closed => {
            Some("contact stuck: NC does not open at nominal voltage")
        }
        Some(_) => Some("contact stuck: NO does not make at nominal voltage"),
        None => {
            findings.void("interface board not read");
            None
        }
    };
    findings.unmoved.map(|_| Stage::Coil)
}

pub(super) fn conclude_release(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
) -> Option<Stage> {
    if readings.seen.first() != Some(&true) {
        findings.fail(
            "release_time_ms high: NC does not make after switch-off",
            bins::TIME,
        );
        return None;
    }
    time_and_bounce(
        bench,
        readings,
        Parameter::ReleaseTime,
        Parameter::ReleaseBounce,
        findings,
    );
    (findings.released, findings.rested) = (true, true);
    let compliance = readings.boards.iter().any(|board| board.compliance);
    match (
        drop_of(readings.drops.first(), compliance),
        findings.drop_zero,
    ) {
        (Ok(drop), Some(zero)) => add_nc(bench, drop - zero, &readings.drops, findings),
        (Ok(_), None) => findings.void("NC drop without its zero"),
        (Err(unread), _) => unread.tell("NC contact", findings),
    }
    None
}
