//! Calibration against the references on the interface board: 5.000 V, 400 ohm, 50 mOhm, 1.000 ms.
//!
//! Runs with an empty nest and the probes up (drive and source need the probe-up chain). It gives the coil converter's
//! line, ohms per ratio on each current channel, milliohms per volt of drop, gate delays, gain and offset of the
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

/// Channels of the coil converter, of which a rig may lack the last two.
const SCANNED: [AnalogIn; 6] = [
    AnalogIn::CoilVoltageFine,
    AnalogIn::CoilCurrentFine,
    AnalogIn::CoilCurrent,
    AnalogIn::ReferenceVoltage,
    AnalogIn::SupplyVoltage,
    AnalogIn::CoilCurrentHigh,
];
/// Scans per level: they average the 2.8 mV of one reading to 0.8 mV.
const SCANS: usize = 12;
/// Scans along the fine ramp, and the share of a round of conversions between two of them: what is read is up to a round
/// old, and at this share the ages spread evenly over the ramp and do not tilt it.
const RAMP_SCANS: usize = 56;
const RAMP_ROUND: f64 = 0.6;
/// The higher level at the coil in the range of factor 1: within the range of the fine channels at 400 ohm.
const HIGH: Volt = Volt(5.7);
/// The lower level, and the distance from both ends of the fine ramp within which readings are excluded from the slope, as
/// shares of the higher level.
const LOW: f64 = 1.5 / 5.7;
const SLOPE_MARGIN: f64 = 0.3 / 5.7;
/// Share of the limits of a supply range that a level uses.
const USED: f64 = 0.9;
/// Full scale of the coil converter, and the highest voltage at a terminal that still counts.
const FULL: Volt = Volt(10.0);
const READABLE: Volt = Volt(9.5);
/// Relative difference of two levels that are as good as one.
const ALIKE: f64 = 0.1;
/// Largest difference between the supply and the coil voltage of the reference, relative: the next range is twice as high.
const SAME_SUPPLY: f64 = 0.1;
/// Longest time until the sources have fallen to zero and the relays of the range have switched.
const SWITCHES: Span = Span::ms(4000);
/// Drops read per polarity.
const DROPS: usize = 8;
/// Number of gate pulses: their sum errs by one count, their mean by 1/25.
const PULSES: u32 = 25;

/// Returns the inputs that [`acts`] scans; none on a rig that lacks a point of the kind.
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

/// Levels of the reference coil.
#[derive(Debug, Clone, Copy)]
struct Levels {
    low: Volt,
    high: Volt,
    /// Where the current channel of the recipe reads the reference coil best; none where that is `high`.
    current: Option<Volt>,
}

impl Levels {
    fn of(context: &Context) -> Self {
        let (scale, ohm) = (context.scale(), context.reference.coil_ohm);
        let range = context.range.as_ref();
        let limit = range.and_then(|range| range.max_current);
        let most_v = limit.map_or(f64::INFINITY, |it| USED * it.0 * ohm);
        let high = Volt(scale.of_range(HIGH).0.min(most_v));
        let channel = context.relay.test.coil_channels.current();
        let read_v = context
            .points
            .gain(channel)
            .map(|it| USED * FULL.0 / it * ohm);
        let current = range.zip(read_v).map(|(range, read_v)| {
            let within_v = most_v.min(USED * range.max.0);
            Volt(read_v.min(within_v))
        });
        Self {
            low: high * LOW,
            high,
            current: current.filter(|it| (it.0 / high.0 - 1.0).abs() > ALIKE),
        }
    }

    fn span(self) -> Volt {
        self.high - self.low
    }

    /// Returns the levels of the level output, in order.
    fn steps(self) -> impl Iterator<Item = Volt> {
        [Some(self.low), Some(self.high), self.current]
            .into_iter()
            .flatten()
    }
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
    scans(context, scanned, &mut acts);
    acts
}

/// Scans the reference coil at each level, then along the fine ramp and at its end.
fn levels(context: &Context, scanned: &[AnalogIn]) -> Vec<Act> {
    let levels = Levels::of(context);
    let mut acts = Vec::new();
    let steps = levels.steps().map(|level| vec![(SupplyLevel, level)]);
    let coarse = vec![(SupplyLevel, levels.low), (SupplyCoarse, levels.span())];
    for step in steps.chain([coarse]) {
        acts.extend([
            Act::Supply(step),
            Act::Wait(Span::ms(60) + context.fresh(scanned.len())),
        ]);
        scans(context, scanned, &mut acts);
    }
    acts.extend([
        Act::Supply(vec![(SupplyCoarse, Volt(0.0))]),
        Act::Wait(Span::ms(100)),
        Act::Supply(vec![(SupplyFine, levels.span())]),
        Act::Wait(Span::ms(100) + context.fresh(scanned.len())),
    ]);
    let wait = Act::Wait(Span::seconds(
        RAMP_ROUND * context.round(scanned.len()).as_seconds(),
    ));
    for _ in 0..RAMP_SCANS {
        acts.extend([Act::Read(Read::Coil), wait.clone()]);
    }
    acts.push(Act::Wait(Span::ms(1500)));
    scans(context, scanned, &mut acts);
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

fn scans(context: &Context, scanned: &[AnalogIn], acts: &mut Vec<Act>) {
    let round = context.round(scanned.len());
    for _ in 0..SCANS {
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
    // The first pulse closes a window that an earlier test may have left open.
    acts.extend(pulse.clone());
    acts.push(Act::Read(Read::Gates));
    for _ in 0..PULSES {
        acts.extend(pulse.clone());
    }
    acts.push(Act::Read(Read::Gates));
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

/// Terminal volts at one level: coil voltage and reference.
struct Level {
    voltage_v: f64,
    reference_v: f64,
}

fn level(scans: &[CoilScan]) -> Result<Level, ReferenceFault> {
    Ok(Level {
        voltage_v: mean(scans, |scan| &scan.voltage_fine, "coil voltage")?,
        reference_v: mean(scans, |scan| &scan.reference, "reference voltage")?,
    })
}

/// Returns the mean of a current channel at its terminal.
fn current(scans: &[CoilScan], channels: CoilChannels) -> Result<f64, ReferenceFault> {
    match channels {
        CoilChannels::Fine => mean(scans, |scan| &scan.current_fine, "coil current (fine)"),
        CoilChannels::CoarseCurrent => {
            mean(scans, |scan| &scan.current_wide, "coil current (wide)")
        }
        CoilChannels::HighCurrent => mean(scans, |scan| &scan.current_high, "coil current (high)"),
    }
}

/// Scans of a calibration by what they were taken at.
struct Taken<'a> {
    zero: &'a [CoilScan],
    /// Levels of the level output, in the order of [`Levels::steps`].
    steps: Vec<(Volt, &'a [CoilScan])>,
    coarse: &'a [CoilScan],
    ramp: &'a [CoilScan],
    fine: &'a [CoilScan],
}

impl<'a> Taken<'a> {
    /// Sorts all scans; fails when some are missing.
    fn of(levels: Levels, readings: &'a Readings) -> Result<Self, ReferenceFault> {
        let steps: Vec<Volt> = levels.steps().collect();
        let expected = (steps.len() + 3) * SCANS + RAMP_SCANS;
        let found = readings.coil.len();
        let complete = readings.drops.len() == 2 * DROPS && readings.gates.len() == 2;
        if found != expected || !complete {
            return Err(ReferenceFault::Scans { found, expected });
        }
        let (zero, rest) = readings.coil.split_at(SCANS);
        let (levels, rest) = rest.split_at(steps.len() * SCANS);
        let (coarse, rest) = rest.split_at(SCANS);
        let (ramp, fine) = rest.split_at(RAMP_SCANS);
        Ok(Self {
            zero,
            steps: steps.into_iter().zip(levels.chunks(SCANS)).collect(),
            coarse,
            ramp,
            fine,
        })
    }
}

/// Computes the factors from the readings of [`acts`]. `made_at_us`: microseconds since 1970 UTC.
///
/// # Errors
/// Names the range, the channel or the reference that does not read as it must.
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
        probe_contact_ohm: 0.0,
    })
}

/// Computes the line of the coil converter from the reference voltage and the scans without drive.
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

/// Fails when the board is in another range than the one selected: nothing was driven then.
fn check_range(context: &Context, readings: &Readings) -> Result<(), ReferenceFault> {
    let read_back = readings.boards.last().and_then(|board| board.range);
    match context.range_mismatch(read_back) {
        Some(mismatch) => Err(ReferenceFault::Range(mismatch)),
        None => Ok(()),
    }
}

/// Fails when the supply, which reads alike in every range, is another voltage than the coil channel says.
fn check_supply(
    context: &Context,
    scans: &[CoilScan],
    (input, coil): (&InputLine, Volt),
) -> Result<(), ReferenceFault> {
    let Some(gain) = context.points.gain(AnalogIn::SupplyVoltage) else {
        return Ok(());
    };
    let terminal_v = mean(scans, |scan| &scan.supply, "supply voltage")?;
    let supply = input.correct(Volt(terminal_v)) / gain;
    let off = (supply.0 / coil.0 - 1.0).abs();
    if off.is_nan() || off > SAME_SUPPLY {
        return Err(ReferenceFault::Supply {
            supply_v: supply.0,
            coil_v: coil.0,
        });
    }
    Ok(())
}

/// What the factors of the current channels follow from.
struct Ohms<'a> {
    context: &'a Context,
    taken: &'a Taken<'a>,
    input: &'a InputLine,
    level: &'a OutputLine,
    voltage_gain: f64,
}

impl Ohms<'_> {
    /// Returns ohms per ratio of a current channel, read at the highest level within its range.
    fn factor(&self, channels: CoilChannels) -> Result<Factor, ReferenceFault> {
        let (context, known) = (self.context, &self.context.reference);
        let per_volt = context.points.gain(channels.current()).unwrap_or(0.0) / known.coil_ohm;
        let steps = self.taken.steps.iter().copied();
        let within = steps.filter(|(at, _)| at.0 * per_volt <= READABLE.0);
        let Some((at, scans)) = within.max_by(|a, b| a.0.0.total_cmp(&b.0.0)) else {
            return Err(ReferenceFault::NotRead {
                name: channels.current().name(),
            });
        };
        let offset_v = self.input.offset_v.value;
        let u_read = context.reading_u_v() / (SCANS as f64).sqrt();
        let (voltage_v, u_voltage_v) = self.voltage(at, scans, u_read)?;
        let current_v = current(scans, channels)? - offset_v;
        let u = (u_voltage_v / voltage_v).hypot(u_read / current_v);
        let value = known.coil_ohm * (current_v / voltage_v);
        Ok(Factor::new(
            value,
            value * u.hypot(rectangular(known.coil_tolerance_pct / 100.0)),
        ))
    }

    /// Returns the coil voltage of a level at its terminal, free of offset, and its uncertainty. Beyond the range of its
    /// channel it is that of the level output, whose line the other levels give.
    fn voltage(
        &self,
        at: Volt,
        scans: &[CoilScan],
        u_read: f64,
    ) -> Result<(f64, f64), ReferenceFault> {
        if at.0 * self.voltage_gain <= READABLE.0 {
            let voltage_v = mean(scans, |scan| &scan.voltage_fine, "coil voltage")?;
            return Ok((voltage_v - self.input.offset_v.value, u_read));
        }
        let levels = Levels::of(self.context);
        let further = (at - levels.low).0 / levels.span().0;
        let gain = self.voltage_gain * self.input.gain.value;
        let voltage_v = self.level.delivers(at).0 * gain;
        Ok((voltage_v, 2f64.sqrt() * u_read * further))
    }
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
    (levels, scans): (Levels, &[CoilScan]),
    line: &InputLine,
    voltage_gain: f64,
) -> Result<Factor, ReferenceFault> {
    let margin = levels.high * SLOPE_MARGIN;
    let counted = (levels.low + margin).0..(levels.high - margin).0;
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
        .filter(|(_, volts)| counted.contains(volts))
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
