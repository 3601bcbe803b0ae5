//! Timed operation at exactly nominal voltage and timed release into the recipe's clamp, each with its
//! bounce; the closure it ends on is then read for its contact resistance.

use super::contact::{add_nc, drop_of, is_implausible, off, reversal, reversed};
use super::{Bench, Findings, OFF, Stage, board};
use crate::gauge::Parameter;
use crate::gauge::contact::resistance;
use crate::gauge::timing::{bounce_ms, counts, gate_ms};
use crate::gauge::verdict::Bin;
use crate::rig::point::DigitalIn;
use crate::rig::point::DigitalOut::{Arm, CoilDrive, EventNoBreak, RampMode, SelectNo, SourceOn};
use crate::station::act::{Act, Read, Readings};
use crate::station::supply::Supply;
use crate::units::{Span, Volt};

/// Slowest operation or release that is still waited for.
const LONGEST: Span = Span::ms(60);
/// The window closes 20 ms after the latch; gate 1 counts bounce until then.
const WINDOW_AFTER_LATCH: Span = Span::ms(21);
/// Start of the coarse release ramp above the highest threshold of the lot, volts.
const RELEASE_HEADROOM_V: f64 = 0.8;
/// Gate 1 is open whenever gate 0 is; their delays may differ by so many counts.
const GATE_SKEW: u32 = 4;
/// Bounce is over and the contact has been closed for the 5 ms that the source asks for.
const BOUNCE_OVER: Span = Span::ms(16);

pub(super) fn acts_operate(bench: &Bench, supply: &mut Supply) -> Vec<Act> {
    let mut acts = vec![
        board(&[
            (CoilDrive, false),
            (Arm, false),
            (RampMode, false),
            (SelectNo, true),
            (EventNoBreak, false),
        ]),
        Act::Mark,
        supply.step_to(Volt(bench.recipe.part.nominal_v)),
        Act::Read(Read::Gates),
        Act::WaitSinceMark(OFF),
        board(&[(Arm, true)]),
        board(&[(CoilDrive, true)]),
    ];
    acts.extend(event_and_drop(bench));
    acts.extend(reversed(bench));
    acts
}

pub(super) fn acts_release(bench: &Bench, supply: &mut Supply, findings: &Findings) -> Vec<Act> {
    let mut acts = Vec::new();
    let repeated = findings.attempts(Parameter::ReleaseTime) > 0;
    if repeated {
        acts.extend([
            board(&[
                (RampMode, false),
                (SelectNo, true),
                (EventNoBreak, false),
                (Arm, false),
            ]),
            supply.step_to(Volt(bench.recipe.part.nominal_v)),
            board(&[(CoilDrive, true)]),
            Act::Wait(Span::ms(40)),
        ]);
    }
    acts.extend([
        board(&[(SelectNo, false), (Arm, false)]),
        Act::Read(Read::Gates),
        board(&[(Arm, true)]),
        board(&[(CoilDrive, false)]),
    ]);
    // With the coil off the supply is free: the coarse ramp goes to where the release ramp begins.
    let test = &bench.recipe.test;
    let above = test.expected_release_v + 4.0 * test.expected_release_sd_v + RELEASE_HEADROOM_V;
    if Volt(above) < supply.coarse() {
        acts.push(supply.ramp_coarse(Volt(above)).0);
    }
    acts.extend(event_and_drop(bench));
    acts.extend(off());
    acts
}

/// The contact event, then the forward drop; the gates are read while the conversion runs. The source
/// drives the same way as the contact monitor, so that gate 1 does not take it for an open contact.
fn event_and_drop(bench: &Bench) -> [Act; 9] {
    [
        Act::Until {
            point: DigitalIn::Latch,
            within: LONGEST,
        },
        Act::Mark,
        Act::WaitSinceMark(BOUNCE_OVER),
        board(&[(SourceOn, true)]),
        Act::WaitSinceMark(WINDOW_AFTER_LATCH),
        Act::Read(Read::Gates),
        Act::Read(Read::Board),
        Act::ConvertSinceMark(BOUNCE_OVER + Span::ms(6) + bench.fresh(1)),
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
    let (Some(before), Some(after)) = (readings.gates.first(), readings.gates.get(1)) else {
        findings.void("gate counters not read");
        return;
    };
    let gate0 = counts(before[0].count, after[0].count);
    let gate1 = counts(before[1].count, after[1].count);
    let longest = (LONGEST + WINDOW_AFTER_LATCH).as_seconds() * bench.clock().hz;
    if f64::from(gate0.max(gate1)) > longest || gate1 + GATE_SKEW < gate0 {
        findings.void(format!(
            "gate counters implausible: {gate0} and {gate1} counts"
        ));
        return;
    }
    let samples: Vec<_> = readings.gates.iter().flatten().collect();
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
        findings.fail(
            "operate_time_ms high: NO does not make at nominal voltage",
            Bin::Time,
        );
        return None;
    }
    time_and_bounce(
        bench,
        readings,
        Parameter::OperateTime,
        Parameter::OperateBounce,
        findings,
    );
    match reversal(readings) {
        Ok(closure) => {
            let u = bench.reading_u_v() / 2f64.sqrt();
            if let Some(reading) =
                resistance(&[closure.drop()], bench.calibration.contact_mohm_per_v, u)
                && !is_implausible("NO contact", reading.value, findings)
            {
                findings.found(Parameter::ContactResistanceNo, reading, &readings.drops);
            }
        }
        Err(unread) => unread.tell("NO contact", findings),
    }
    None
}

pub(super) fn conclude_release(
    bench: &Bench,
    readings: &Readings,
    findings: &mut Findings,
) -> Option<Stage> {
    if readings.seen.first() != Some(&true) {
        findings.fail(
            "release_time_ms high: NC does not make after switch-off",
            Bin::Time,
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
