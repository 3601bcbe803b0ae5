//! Calibration against the references on the interface board: 5.000 V, 400 ohm, 50 mOhm, 1.000 ms.
//!
//! Runs with an empty nest and the probes up (drive and source need the probe-up chain). It gives the coil converter's
//! line, ohms per ratio on both current channels, milliohms per volt of drop, gate delays, gain and offset of the
//! three supply outputs, and the slope of the fine ramp against the host's clock. The slope of the coarse ramp stays
//! nominal: it only places the fine ramp.

mod fault;

pub use fault::ReferenceFault;

use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::calibration::{Calibration, InputLine, OutputLine};
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::points::AnalogOut::{SupplyCoarse, SupplyFine, SupplyLevel};
use crate::dut::em_relay::points::DigitalOut::{
    Arm, CoilDrive, KelvinTest, RampMode, ReferenceCoil, ReferenceContact, SourceOn, SourceReverse,
};
use crate::dut::em_relay::points::{AnalogIn, Points};
use crate::dut::em_relay::promise::noise;
use crate::dut::em_relay::readings::{CoilScan, Readings};
use crate::dut::em_relay::timing::counts;
use crate::gauge::Factor;
use crate::gauge::budget::rectangular;
use crate::gauge::evidence::Residuals;
use crate::instrument::act;
use crate::instrument::readings::Readings as ByPoint;
use crate::rig::point::AnalogInput;
use crate::rig::sample::{Quality, Sample};
use crate::rig::wiring::Wiring;
use units::{Span, Volt};

/// Channels of the coil converter.
pub const SCANNED: [AnalogIn; CHANNELS] = [
    AnalogIn::CoilVoltageFine,
    AnalogIn::CoilCurrentFine,
    AnalogIn::CoilCurrent,
    AnalogIn::ReferenceVoltage,
];
const CHANNELS: usize = 4;
/// Scans per level: they average the 2.8 mV of one reading to 0.8 mV.
const SCANS: usize = 12;
/// Scans along the fine ramp.
const RAMP_SCANS: usize = 44;
/// Levels at the coil, volts: both within the range of the fine channels at 400 ohm.
const LOW_V: f64 = 1.5;
const HIGH_V: f64 = 5.7;
/// Distance from both ends of the fine ramp within which readings are excluded from the slope, volts.
const SLOPE_MARGIN_V: f64 = 0.3;
/// Drops read per polarity.
const DROPS: usize = 8;
/// Number of gate pulses: their sum errs by one count, their mean by 1/25.
const PULSES: u32 = 25;

/// Returns the inputs that [`acts`] scans; none on a rig that lacks a point of the kind.
pub fn inputs(wiring: &Wiring) -> Vec<AnalogInput> {
    let points = Points::resolve(wiring).ok();
    let inputs = points.map(|points| SCANNED.map(|it| points.analog(it)).to_vec());
    inputs.unwrap_or_default()
}

/// Returns the acts, in the order that [`conclude`] expects.
pub fn acts(context: &Context) -> Vec<act::Act> {
    let mut acts = vec![
        Act::CoilMask(&SCANNED),
        all_off(),
        Act::Supply(vec![
            (SupplyLevel, Volt(0.0)),
            (SupplyCoarse, Volt(0.0)),
            (SupplyFine, Volt(0.0)),
        ]),
        Act::Wait(Span::ms(200) + context.fresh(CHANNELS)),
    ];
    scans(context, SCANS, &mut acts);
    acts.push(Act::Board(vec![(ReferenceCoil, true), (CoilDrive, true)]));
    let span = Volt(HIGH_V - LOW_V);
    for step in [
        vec![(SupplyLevel, Volt(LOW_V))],
        vec![(SupplyLevel, Volt(HIGH_V))],
        vec![(SupplyLevel, Volt(LOW_V)), (SupplyCoarse, span)],
    ] {
        acts.extend([
            Act::Supply(step),
            Act::Wait(Span::ms(60) + context.fresh(CHANNELS)),
        ]);
        scans(context, SCANS, &mut acts);
    }
    acts.extend([
        Act::Supply(vec![(SupplyCoarse, Volt(0.0))]),
        Act::Wait(Span::ms(100)),
        Act::Supply(vec![(SupplyFine, span)]),
        Act::Wait(Span::ms(100) + context.fresh(CHANNELS)),
    ]);
    scans(context, RAMP_SCANS, &mut acts);
    acts.push(Act::Wait(Span::ms(1500)));
    scans(context, SCANS, &mut acts);
    acts.extend([
        Act::Supply(vec![(SupplyFine, Volt(0.0))]),
        all_off(),
        Act::Wait(Span::ms(5)),
    ]);
    contact(context, &mut acts);
    pulses(&mut acts);
    acts.extend([
        all_off(),
        Act::CoilMask(context.coil_channels()),
        Act::Supply(vec![(SupplyLevel, Volt(context.relay.test.prebias_v))]),
        Act::Wait(Span::ms(2000)),
    ]);
    context.points.wired(acts, &SCANNED)
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

fn scans(context: &Context, n: usize, acts: &mut Vec<Act>) {
    for _ in 0..n {
        acts.extend([Act::Read(Read::Coil), Act::Wait(context.round(CHANNELS))]);
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
    // The first pulse closes a window that an earlier test may have left open.
    acts.extend(pulse.clone());
    acts.push(Act::Read(Read::Gates));
    for _ in 0..PULSES {
        acts.extend(pulse.clone());
    }
    acts.push(Act::Read(Read::Gates));
}

/// Returns the residuals of all conversions of a constant voltage, against the promised noise.
pub fn noise(context: &Context, readings: &ByPoint, noise_lsb: f64) -> Vec<Residuals> {
    let readings = Readings::of(readings, &context.points, None);
    let levels = [0, SCANS, 2 * SCANS, 3 * SCANS, 4 * SCANS + RAMP_SCANS];
    let scans = levels.into_iter();
    let scans = scans.filter_map(|from| readings.coil.get(from..from + SCANS));
    let drops = readings.drops.chunks(DROPS);
    let drops = drops.filter_map(|drops| noise::of_constant(drops.iter(), noise_lsb));
    scans
        .flat_map(|scans| noise::of_scans(scans, noise_lsb))
        .chain(drops)
        .collect()
}

/// Returns the mean of one channel over scans; fails when a scan lacks it.
fn mean(
    scans: &[CoilScan],
    channel: fn(&CoilScan) -> &Option<Sample>,
    name: &'static str,
) -> Result<f64, ReferenceFault> {
    let mut sum = 0.0;
    for scan in scans {
        match channel(scan) {
            Some(sample)
                if sample.quality == Quality::Good && sample.terminal_volts.is_finite() =>
            {
                sum += sample.terminal_volts;
            }
            Some(sample) => {
                return Err(ReferenceFault::reads(name, sample));
            }
            None => return Err(ReferenceFault::NotEnabled { name }),
        }
    }
    if scans.is_empty() {
        Err(ReferenceFault::NotRead { name })
    } else {
        Ok(sum / scans.len() as f64)
    }
}

/// Terminal volts at one level: voltage, fine current, wide current and reference.
struct Level {
    voltage_v: f64,
    fine_v: f64,
    wide_v: f64,
    reference_v: f64,
}

fn level(scans: &[CoilScan]) -> Result<Level, ReferenceFault> {
    Ok(Level {
        voltage_v: mean(scans, |scan| &scan.voltage_fine, "coil voltage")?,
        fine_v: mean(scans, |scan| &scan.current_fine, "coil current (fine)")?,
        wide_v: mean(scans, |scan| &scan.current_wide, "coil current (wide)")?,
        reference_v: mean(scans, |scan| &scan.reference, "reference voltage")?,
    })
}

/// Computes the factors from the readings of [`acts`]. `made_at_us`: microseconds since 1970 UTC.
pub fn conclude(
    context: &Context,
    readings: &ByPoint,
    made_at_us: i64,
    valid_us: i64,
    voltage_gain: f64,
) -> Result<Calibration, ReferenceFault> {
    let readings = &Readings::of(readings, &context.points, None);
    let expected = 4 * SCANS + RAMP_SCANS + SCANS;
    if readings.coil.len() != expected
        || readings.drops.len() != 2 * DROPS
        || readings.gates.len() != 2
    {
        return Err(ReferenceFault::Scans {
            found: readings.coil.len(),
            expected,
        });
    }
    let part = |from: usize, n: usize| &readings.coil[from..from + n];
    let zero = level(part(0, SCANS))?;
    let low = level(part(SCANS, SCANS))?;
    let high = level(part(2 * SCANS, SCANS))?;
    let coarse = level(part(3 * SCANS, SCANS))?;
    let fine = level(part(4 * SCANS + RAMP_SCANS, SCANS))?;
    let u_read = context.reading_u_v() / (SCANS as f64).sqrt();

    let offset = (zero.voltage_v + zero.fine_v + zero.wide_v) / 3.0;
    let reference = [&zero, &low, &high, &coarse, &fine]
        .iter()
        .map(|l| l.reference_v)
        .sum::<f64>()
        / 5.0;
    let known = &context.reference;
    let coil_input = InputLine {
        gain: Factor::new(
            (reference - offset) / known.voltage_v,
            (rectangular(known.voltage_tolerance_pct / 100.0)).hypot(u_read / known.voltage_v),
        ),
        offset_v: Factor::new(offset, u_read / 3f64.sqrt()),
    };
    check_gain(context, &coil_input)?;

    let volts = |terminal: f64| coil_input.correct(Volt(terminal)).0 / voltage_gain;
    let ohm = |current: fn(&Level) -> f64| {
        let ratio = (current(&high) - offset) / (high.voltage_v - offset);
        let u = (u_read / (high.voltage_v - offset)).hypot(u_read / (current(&high) - offset));
        let value = known.coil_ohm * ratio;
        Factor::new(
            value,
            value * u.hypot(rectangular(known.coil_tolerance_pct / 100.0)),
        )
    };
    let span = HIGH_V - LOW_V;
    let gain = |to: &Level| {
        let u = 2f64.sqrt() * u_read / voltage_gain / span;
        Factor::new(
            (volts(to.voltage_v) - volts(low.voltage_v)) / span,
            u.hypot(coil_input.gain.u),
        )
    };
    let level_gain = gain(&high);
    let output = |gain: Factor| OutputLine {
        gain,
        offset_v: Factor::new(0.0, 0.0),
    };
    Ok(Calibration {
        made_at_us,
        due_at_us: made_at_us + valid_us,
        simulated: false,
        nominal_v: context.relay.part.nominal_v,
        level: OutputLine {
            gain: level_gain,
            offset_v: Factor::new(
                volts(low.voltage_v) - level_gain.value * LOW_V,
                u_read / voltage_gain,
            ),
        },
        coarse: output(gain(&coarse)),
        fine: output(gain(&fine)),
        coarse_v_per_s: Factor::new(
            context.nominal_v_per_s[0],
            context.nominal_v_per_s[0] * rectangular(context.accuracy.ao_slope_pct / 100.0),
        ),
        fine_v_per_s: slope(
            context,
            part(4 * SCANS, RAMP_SCANS),
            &coil_input,
            voltage_gain,
        )?,
        ohm_fine: ohm(|level| level.fine_v),
        ohm_wide: ohm(|level| level.wide_v),
        contact_mohm_per_v: contact_factor(context, &readings.drops)?,
        gate_delay_us: [
            gate_delay(context, readings, 0)?,
            gate_delay(context, readings, 1)?,
        ],
        coil_input,
        overshoots: None,
        probe_contact_ohm: 0.0,
        broken: Vec::new(),
    })
}

/// Fails when the gain error exceeds 1.5 times the accuracy of the maker: calibration does not correct a defect.
fn check_gain(context: &Context, line: &InputLine) -> Result<(), ReferenceFault> {
    let promised = context.accuracy.ai_gain_pct / 100.0;
    let found = line.gain.value - 1.0;
    if found.abs() > 1.5 * promised + 2.0 * line.gain.u {
        return Err(ReferenceFault::Gain {
            off_pct: found * 100.0,
            promised_pct: promised * 100.0,
        });
    }
    Ok(())
}

/// Returns the slope of the fine ramp by least squares against the arrival of the replies; their constant delay after
/// the conversion does not tilt the line.
fn slope(
    context: &Context,
    scans: &[CoilScan],
    line: &InputLine,
    voltage_gain: f64,
) -> Result<Factor, ReferenceFault> {
    let points: Vec<(f64, f64)> = scans
        .iter()
        .filter_map(|scan| scan.voltage_fine.as_ref())
        .filter(|sample| sample.quality == Quality::Good)
        .map(|sample| {
            (
                sample.origin.at.0 as f64 / 1e6,
                line.correct(Volt(sample.terminal_volts)).0 / voltage_gain,
            )
        })
        .filter(|(_, volts)| (LOW_V + SLOPE_MARGIN_V..HIGH_V - SLOPE_MARGIN_V).contains(volts))
        .collect();
    if points.len() < 10 {
        let readings = points.len();
        return Err(ReferenceFault::FewOnRamp { readings });
    }
    let n = points.len() as f64;
    let (mt, mv) = (
        points.iter().map(|p| p.0).sum::<f64>() / n,
        points.iter().map(|p| p.1).sum::<f64>() / n,
    );
    let stt = points.iter().map(|p| (p.0 - mt).powi(2)).sum::<f64>();
    let stv = points.iter().map(|p| (p.0 - mt) * (p.1 - mv)).sum::<f64>();
    let value = stv / stt;
    let rest = points
        .iter()
        .map(|p| (p.1 - mv - value * (p.0 - mt)).powi(2))
        .sum::<f64>()
        / (n - 2.0);
    let u = (rest / stt).sqrt().hypot(value * line.gain.u);
    let nominal = context.nominal_v_per_s[1];
    if !value.is_finite() || (value / nominal - 1.0).abs() > 0.02 {
        return Err(ReferenceFault::Slope {
            v_per_s: value,
            nominal_v_per_s: nominal,
        });
    }
    Ok(Factor::new(value, u))
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
