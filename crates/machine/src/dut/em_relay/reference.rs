//! Calibration against the references on the interface board: 5.000 V, 400 ohm, 50 mOhm, 1.000 ms.
//!
//! The calibration runs with an empty nest and the probes up (drive and source need the probe-up chain). It finds gain
//! and offset of the coil converter's inputs, ohms per ratio on each current channel, milliohms per volt of drop, gate
//! delays, gain and offset of the three supply outputs, and the slope of the fine ramp against the host's clock. The
//! slope of the coarse ramp stays nominal, because the overshoot contains its error.

mod check;
mod fault;
mod levels;
mod noise;
mod ohms;
mod slope;
mod taken;

use check::{check_gain, check_range, check_supply};
pub use fault::ReferenceFault;
use levels::Levels;
pub use noise::noise;
use ohms::Ohms;
use slope::slope;
use taken::{Level, Taken, current, level};

use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::calibration::{Calibration, InputLine, OutputLine};
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::points::AnalogOut::{SupplyCoarse, SupplyFine, SupplyLevel};
use crate::dut::em_relay::points::DigitalOut::{
    Arm, CoilDrive, KelvinTest, RampMode, ReferenceCoil, ReferenceContact, SourceOn, SourceReverse,
};
use crate::dut::em_relay::points::{AnalogIn, Points};
use crate::dut::em_relay::readings::{CoilScan, Readings};
use crate::dut::em_relay::recipe::CoilChannels;
use crate::dut::em_relay::timing::counts;
use crate::gauge::Factor;
use crate::gauge::budget::rectangular;
use crate::instrument::act;
use crate::instrument::readings::Readings as ByPoint;
use crate::rig::point::AnalogInput;
use crate::rig::sample::{Quality, Sample};
use crate::rig::wiring::Wiring;
use units::{Span, Volt};

/// Channels of the coil converter; a rig may lack the last two.
const SCANNED: [AnalogIn; 6] = [
    AnalogIn::CoilVoltageFine,
    AnalogIn::CoilCurrentFine,
    AnalogIn::CoilCurrent,
    AnalogIn::ReferenceVoltage,
    AnalogIn::SupplyVoltage,
    AnalogIn::CoilCurrentHigh,
];
/// Number of scans per level: their mean lowers the uncertainty of one reading, 2.8 mV, to 0.8 mV.
const SCANS: usize = 12;
/// Number of scans along the fine ramp.
const RAMP_SCANS: usize = 56;
/// Time between two scans along the fine ramp, as a share of a round of conversions, however long the replies take. A
/// reading is up to one round old. At this share the ages spread evenly over the ramp and do not bias its slope; in
/// scans at the pace of the rounds the age would drift along the ramp.
const RAMP_ROUND: f64 = 0.72;
/// Longest time until the sources have fallen to zero and the relays of the range have switched.
const SWITCHES: Span = Span::ms(4000);
/// Number of drops read per polarity.
const DROPS: usize = 8;
/// Number of gate pulses; the standard uncertainty of one count is at most half a count, that of their mean 1/10.
const PULSES: u32 = 25;

/// Returns the inputs that [`acts`] scans; empty on a rig that lacks a point of the relay test.
pub fn inputs(wiring: &Wiring) -> Vec<AnalogInput> {
    let points = Points::resolve(wiring).ok();
    let inputs = points.map(|points| {
        let inputs = SCANNED.iter().filter_map(|it| points.wired_analog(*it));
        inputs.collect()
    });
    inputs.unwrap_or_default()
}

/// Returns the channels that this rig scans.
fn scanned(points: &Points) -> Vec<AnalogIn> {
    let wired = |it: &AnalogIn| points.wired_analog(*it).is_some();
    SCANNED.into_iter().filter(wired).collect()
}

/// Returns the acts, in the order that [`conclude`] expects.
pub fn acts(context: &Context) -> Vec<act::Act> {
    let scanned = scanned(&context.points);
    let mut acts = at_zero(context, &scanned);
    acts.push(Act::Board(vec![(ReferenceCoil, true), (CoilDrive, true)]));
    acts.extend(levels(context, &scanned));
    acts.extend([
        Act::Supply(vec![(SupplyFine, Volt(0.0))]),
        all_off(),
        Act::Wait(Span::ms(5)),
    ]);
    contact(context, &mut acts);
    pulses(&mut acts);
    acts.extend([
        all_off(),
        Act::CoilMask(context.coil_channels().to_vec()),
        Act::Supply(vec![(SupplyLevel, Volt(context.relay.test.prebias_v))]),
        Act::Wait(Span::ms(2000)),
    ]);
    context.points.wired(acts, &scanned)
}

/// Takes all sources to zero, selects the range, and scans without drive.
fn at_zero(context: &Context, scanned: &[AnalogIn]) -> Vec<Act> {
    let mut acts = vec![
        Act::CoilMask(scanned.to_vec()),
        all_off(),
        Act::Supply(vec![
            (SupplyLevel, Volt(0.0)),
            (SupplyCoarse, Volt(0.0)),
            (SupplyFine, Volt(0.0)),
        ]),
    ];
    acts.extend(context.range_code().into_iter().flat_map(|code| {
        let within = SWITCHES;
        [Act::SelectRange(code), Act::ConfirmRange { code, within }]
    }));
    acts.push(Act::Wait(Span::ms(200) + context.fresh(scanned.len())));
    scans(context, (scanned, SCANS), &mut acts);
    acts
}

/// Scans the reference coil at each level, then along the fine ramp and at its end.
fn levels(context: &Context, scanned: &[AnalogIn]) -> Vec<Act> {
    let levels = Levels::of(context);
    let mut acts = Vec::new();
    let steps = levels
        .steps()
        .map(|(level, n)| (vec![(SupplyLevel, level)], n));
    let coarse = vec![(SupplyLevel, levels.low), (SupplyCoarse, levels.span())];
    for (step, n) in steps.chain([(coarse, SCANS)]) {
        acts.extend([
            Act::Supply(step),
            Act::Wait(Span::ms(60) + context.fresh(scanned.len())),
        ]);
        scans(context, (scanned, n), &mut acts);
    }
    acts.extend([
        Act::Supply(vec![(SupplyCoarse, Volt(0.0))]),
        Act::Wait(Span::ms(100)),
        Act::Supply(vec![(SupplyFine, levels.span())]),
        Act::Wait(Span::ms(100) + context.fresh(scanned.len())),
    ]);
    let period = RAMP_ROUND * context.round(scanned.len()).as_seconds();
    for _ in 0..RAMP_SCANS {
        acts.extend([
            Act::Mark,
            Act::Read(Read::Coil),
            Act::WaitSinceMark(Span::seconds(period)),
        ]);
    }
    acts.push(Act::Wait(Span::ms(1500)));
    scans(context, (scanned, SCANS), &mut acts);
    acts
}

fn all_off() -> Act {
    let off = [
        CoilDrive,
        SourceOn,
        SourceReverse,
        ReferenceCoil,
        ReferenceContact,
        Arm,
        RampMode,
        KelvinTest,
    ];
    Act::Board(off.map(|output| (output, false)).to_vec())
}

fn scans(context: &Context, (scanned, n): (&[AnalogIn], usize), acts: &mut Vec<Act>) {
    let round = context.round(scanned.len());
    for _ in 0..n {
        acts.extend([Act::Read(Read::Coil), Act::Wait(round)]);
    }
}

fn contact(context: &Context, acts: &mut Vec<Act>) {
    acts.extend([
        Act::Board(vec![(ReferenceContact, true)]),
        Act::Wait(Span::ms(10)),
    ]);
    for reverse in [false, true] {
        acts.extend([
            Act::Board(vec![(SourceReverse, reverse)]),
            Act::Board(vec![(SourceOn, true)]),
            Act::Wait(Span::ms(8) + context.fresh(1)),
        ]);
        for _ in 0..DROPS {
            acts.extend([Act::Read(Read::Drop), Act::Wait(context.round(1))]);
        }
        acts.extend([Act::Board(vec![(SourceOn, false)]), Act::Wait(Span::ms(3))]);
    }
    acts.push(Act::Board(vec![(SourceReverse, false)]));
}

fn pulses(acts: &mut Vec<Act>) {
    let pulse = [
        Act::Board(vec![(Arm, true)]),
        Act::Wait(Span::ms(2)),
        Act::Board(vec![(Arm, false)]),
    ];
    // The first pulse only closes a window that an earlier test may have left open.
    acts.extend(pulse.clone());
    acts.push(Act::Read(Read::Gates));
    for _ in 0..PULSES {
        acts.extend(pulse.clone());
    }
    acts.push(Act::Read(Read::Gates));
}

/// Computes the factors from the readings of [`acts`]. `made_at_us`: microseconds since 1970 UTC.
///
/// # Errors
/// Fails with the range, the channel or the reference whose reading is wrong.
pub fn conclude(
    context: &Context,
    readings: &ByPoint,
    made_at_us: i64,
    valid_us: i64,
) -> Result<Calibration, ReferenceFault> {
    let readings = &Readings::of(readings, &context.points, None);
    check_range(context, readings)?;
    let levels = Levels::of(context);
    let taken = Taken::of(levels, readings)?;
    let (low, high) = (level(taken.steps[0].1)?, level(taken.steps[1].1)?);
    let (coarse, fine) = (level(taken.coarse)?, level(taken.fine)?);
    let input = coil_input(
        context,
        level(taken.zero)?,
        [&low, &high, &coarse, &fine],
        taken.zero,
    )?;
    check_gain(context, &input)?;
    let voltage_gain = context.points.gain(AnalogIn::CoilVoltageFine);
    let voltage_gain = voltage_gain.unwrap_or(f64::NAN);
    let volts = |level: &Level| input.correct(Volt(level.voltage_v)) / voltage_gain;
    check_supply(context, taken.steps[1].1, (&input, volts(&high)))?;
    let u_read = context.reading_u_v() / (SCANS as f64).sqrt();
    let span = levels.span().0;
    let gain = |to: &Level| {
        let u = 2f64.sqrt() * u_read / voltage_gain / span;
        Factor::new((volts(to) - volts(&low)).0 / span, u.hypot(input.gain.u))
    };
    let output = |to: &Level, offset_v| OutputLine {
        gain: gain(to),
        offset_v,
    };
    let level_gain = gain(&high);
    let level_offset_v = Factor::new(
        volts(&low).0 - level_gain.value * levels.low.0,
        u_read / voltage_gain,
    );
    let level = output(&high, level_offset_v);
    let ohms = Ohms {
        context,
        taken: &taken,
        input: &input,
        level: &level,
        voltage_gain,
    };
    Ok(Calibration {
        made_at_us,
        due_at_us: made_at_us + valid_us,
        simulated: false,
        nominal_v: context.relay.part.nominal_v,
        range_factor: context.scale().range(),
        coarse: output(&coarse, Factor::new(0.0, 0.0)),
        fine: output(&fine, Factor::new(0.0, 0.0)),
        coarse_v_per_s: Factor::new(
            context.nominal_v_per_s[0],
            context.nominal_v_per_s[0] * rectangular(context.accuracy.ao_slope_pct / 100.0),
        ),
        fine_v_per_s: slope(context, (levels, taken.ramp), &input, voltage_gain)?,
        ohm_fine: ohms.factor(CoilChannels::Fine)?,
        ohm_wide: ohms.factor(CoilChannels::CoarseCurrent)?,
        ohm_high: match context.points.gain(AnalogIn::CoilCurrentHigh) {
            Some(_) => Some(ohms.factor(CoilChannels::HighCurrent)?),
            None => None,
        },
        contact_mohm_per_v: contact_factor(context, &readings.drops)?,
        gate_delay_us: [
            gate_delay(context, readings, 0)?,
            gate_delay(context, readings, 1)?,
        ],
        level,
        coil_input: input,
        overshoots: None,
        temperature: None,
        probe_contact_ohm: 0.0,
        broken: Vec::new(),
    })
}

/// Computes gain and offset of the coil converter's inputs from the reference voltage and the scans without drive.
fn coil_input(
    context: &Context,
    zero: Level,
    driven: [&Level; 4],
    scans: &[CoilScan],
) -> Result<InputLine, ReferenceFault> {
    let u_read = context.reading_u_v() / (SCANS as f64).sqrt();
    let fine_v = current(scans, CoilChannels::Fine)?;
    let wide_v = current(scans, CoilChannels::CoarseCurrent)?;
    let offset = (zero.voltage_v + fine_v + wide_v) / 3.0;
    let driven_v: f64 = driven.iter().map(|it| it.reference_v).sum();
    let reference = (zero.reference_v + driven_v) / 5.0;
    let known = &context.reference;
    Ok(InputLine {
        gain: Factor::new(
            (reference - offset) / known.voltage_v,
            rectangular(known.voltage_tolerance_pct / 100.0).hypot(u_read / known.voltage_v),
        ),
        offset_v: Factor::new(offset, u_read / 3f64.sqrt()),
    })
}

fn contact_factor(context: &Context, drops: &[Sample]) -> Result<Factor, ReferenceFault> {
    let mean = |samples: &[Sample]| -> Result<f64, ReferenceFault> {
        let bad = samples
            .iter()
            .find(|s| s.quality != Quality::Good || !s.terminal_volts.is_finite());
        if let Some(bad) = bad {
            return Err(ReferenceFault::reads("drop of the reference contact", bad));
        }
        Ok(samples
            .iter()
            .map(|sample| sample.terminal_volts)
            .sum::<f64>()
            / samples.len() as f64)
    };
    let drop = (mean(&drops[..DROPS])? - mean(&drops[DROPS..])?) / 2.0;
    let expected = context.reference.contact_mohm * 1e-3 * 50.0;
    if !(0.8 * expected..1.2 * expected).contains(&drop) {
        return Err(ReferenceFault::Drop {
            volts: drop,
            expected_v: expected,
        });
    }
    let value = context.reference.contact_mohm / drop;
    let u_drop = context.reading_u_v() / ((2 * DROPS) as f64).sqrt() / drop;
    Ok(Factor::new(
        value,
        value * u_drop.hypot(rectangular(context.reference.contact_tolerance_pct / 100.0)),
    ))
}

fn gate_delay(
    context: &Context,
    readings: &Readings,
    gate: usize,
) -> Result<Factor, ReferenceFault> {
    let (Some(before), Some(after)) = (readings.gates.first(), readings.gates.last()) else {
        return Err(ReferenceFault::GatesNotRead);
    };
    let total = f64::from(counts(before[gate].count, after[gate].count));
    let each_us = total / f64::from(PULSES) / context.reference.counter_clock_hz * 1e6;
    let delay = each_us - context.reference.gate_pulse_ms * 1e3;
    if delay.abs() > 5.0 * context.accuracy.gate_delay_us {
        return Err(ReferenceFault::Pulse { gate, each_us });
    }
    let count_us = 1e6 / context.reference.counter_clock_hz / 6f64.sqrt();
    Ok(Factor::new(delay, count_us / f64::from(PULSES).sqrt()))
}

#[cfg(test)]
mod tests;
