//! Drop of a conducting AC part at its rated current, in the loop. One record gives peak and rms, drift, DC offset,
//! distortion, and the difference of the half cycles.

use super::super::board::Position;
use super::super::given::Given;
use super::super::state::{Next, State};
use super::{STORED, close, leave, supply};
use crate::dut::Reason;
use crate::dut::ssr::Finding;
use crate::dut::ssr::ac_accuracy as accuracy;
use crate::dut::ssr::ac_plan::{AcPlan, DIVIDER, LOOP_OHM, LOOP_SHUNT_OHM};
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::program::{DIVIDED_CHANNEL, OUTPUT_CHANNEL, SHUNT_CHANNEL};
use crate::dut::ssr::references::{Doubt, References};
use crate::dut::ssr::wave::Channel;
use crate::dut::ssr::wave::distortion::Conducting;
use crate::dut::ssr::wave::drop_line::{self, DropLine};
use crate::dut::ssr::wave::mains::Mains;
use crate::dut::ssr::wave::{jumps_u, split, warming};
use crate::instrument::act::Act;
use crate::instrument::query::Waveform;
use std::f64::consts::{PI, SQRT_2};
use units::{Span, Unit};

/// Least share of the peak current at which a sample counts for the fit of the drop.
const LEAST: f64 = 0.3;
/// Times after the begin of the current between which the drift counts, s.
const DRIFT_S: [f64; 2] = [0.01, 0.2];
/// Share of its range up to which the channel of the drop follows the output.
const FOLLOWED: f64 = 0.93;
/// Share of the peak of the rated current below which the output waits for its voltage.
const WAITS: f64 = 0.02;
/// Least share of the peak of the current that both polarities reach in a whole wave.
const HALF: f64 = 0.2;

/// Returns the acts that record the part in the loop.
pub fn acts(state: &mut State, plan: &Plan, ac: &AcPlan, points: &Points) -> Vec<Act> {
    let scales = ac.looped();
    let mut acts = close(state, Position::Loop, ac, points);
    acts.extend([
        Act::Query(vec![
            points.source(Device::SmuIn, 0.0, &plan.input),
            points.capture_all(plan, &scales),
        ]),
        Act::Query(vec![points.level(Device::SmuIn, plan.control_v)]),
        Act::Wait(Span::seconds(scales.record_s) + STORED),
    ]);
    acts.extend(leave(state, points));
    let mut queries = points.record(&scales, &[DIVIDED_CHANNEL, OUTPUT_CHANNEL, SHUNT_CHANNEL]);
    queries.push(points.off(Device::SmuIn));
    acts.push(Act::Query(queries));
    acts
}

/// The channels of a record in the loop.
#[derive(Clone, Copy)]
pub struct Drops<'a> {
    /// Voltage of the output over its whole range, V.
    whole: Channel<'a>,
    /// Voltage of the output in the finer channel for the drop, V. Where the output waits for its voltage, this channel
    /// cuts it off.
    volts: Channel<'a>,
    /// Current of the loop, A.
    ampere: Channel<'a>,
    /// The fitted sine of the current.
    pub current: Mains,
    /// The fitted sine of the source, V.
    source: Mains,
    rated_peak_a: f64,
    referenced: Option<Doubt>,
}

/// Figures of a conducting output, read from the record of a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnState {
    /// Drop at the peak of the rated current, V: mean of both polarities.
    pub peak_v: f64,
    /// Drop at the rated current, rms, V.
    pub rms_v: f64,
    /// What the heat of an incomplete first half cycle changes of the peak and of the rms drop, V.
    pub first_v: [f64; 2],
    /// Rise of the peak drop from the early to the late time, V.
    pub drift_v: f64,
    /// Mean of the voltage, V, and its standard uncertainty from the samples.
    pub offset_v: (f64, f64),
    /// Difference of the output voltage from a sine, rms, V.
    pub distortion: Distorted,
    /// Difference of the charges of both half cycles over their sum, and its standard uncertainty from the samples.
    pub unequal: (f64, f64),
    /// Number of whole periods from which `offset_v` and `unequal` are computed.
    pub periods: f64,
    /// Mean absolute value of the current, A.
    pub mean_a: f64,
    /// Slope resistance of the output, ohm.
    pub ohm: f64,
    /// Standard uncertainty of the drop of one period from noise, V.
    pub noise_v: f64,
    /// Noise of the references that have corrected both channels; `None` without them.
    pub referenced: Option<Doubt>,
}

/// Difference of the output voltage from its fundamental, and what its budget needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distorted {
    /// Rms of the difference of the cold part at the rated current from a sine, V.
    pub rms_v: f64,
    /// Voltage up to which the output waits in each half cycle, V.
    pub fires_v: f64,
    /// Mean square of the voltage while the output waits, over whole periods, V².
    pub waits_v2: f64,
    /// Standard uncertainty of the mean square of the voltage from the samples, V².
    pub u_v2: f64,
}

impl OnState {
    /// Returns the change of the rms drop for a relative change of the current with this amplitude, V: the derivative of
    /// [`DropLine::rms`].
    fn of_current_v(&self, peak_a: f64) -> f64 {
        let rise_v = self.ohm * peak_a;
        let threshold_v = self.peak_v - rise_v;
        (threshold_v * rise_v * 2.0 / PI + rise_v * rise_v / 2.0) / self.rms_v
    }
}

impl<'a> Drops<'a> {
    /// Takes the channels of a record, corrected by references where there are any; `None` when the current is no sine,
    /// or flows in one polarity only.
    pub fn of(
        ac: &AcPlan,
        references: Option<References>,
        [whole, volts, shunt]: [&'a Waveform; 3],
    ) -> Option<Self> {
        let whole_gain = references.map_or(1.0, |it| it.divided_gain);
        let whole = Channel::of(whole, DIVIDER / whole_gain, 0.0)?;
        let (gain, zero_v) = references.map_or((1.0, 0.0), |it| (it.gain, it.zero_v));
        let volts = Channel::of(volts, 1.0 / gain, zero_v / gain)?;
        let (shunt_gain, shunt_zero_v) =
            references.map_or((1.0, 0.0), |it| (it.shunt_gain(), it.shunt_zero_v));
        let per_volt = 1.0 / LOOP_SHUNT_OHM / shunt_gain;
        let ampere = Channel::of(shunt, per_volt, shunt_zero_v * per_volt)?;
        let from = ampere.index(2.0 * ac.half_s());
        let current = Mains::fit(ampere.pairs(from, ampere.len(), 4), ac.mains_hz)?;
        let is_whole = volts.is_beside(&ampere)
            && volts.is_beside(&whole)
            && current.offset.abs() < HALF * current.amplitude();
        if !is_whole {
            return None;
        }
        let source = (from..ampere.len()).step_by(4).map(|it| {
            let load_v = LOOP_OHM * ampere.at(it);
            (ampere.time(it), whole.at(it) + load_v)
        });
        Some(Self {
            source: Mains::fit(source, ac.mains_hz)?.centred(),
            whole,
            volts,
            ampere,
            current,
            rated_peak_a: SQRT_2 * ac.rated_a,
            referenced: references.map(|it| it.doubt),
        })
    }

    /// Fits the straight line of drop against current for one polarity between two times.
    fn line(&self, sign: f64, (from_s, to_s): (f64, f64)) -> Option<DropLine> {
        let (from, to) = (self.volts.index(from_s), self.volts.index(to_s));
        let least_a = LEAST * self.current.amplitude();
        let samples = (from..to).map(|it| (sign * self.ampere.at(it), sign * self.volts.at(it)));
        drop_line::fit(samples, least_a)
    }

    /// Returns the drop at the rated peak current, V: the mean of both polarities, which cancels an offset of the
    /// channel.
    fn peak_v(&self, between_s: (f64, f64)) -> Option<f64> {
        let (plus, minus) = (self.line(1.0, between_s)?, self.line(-1.0, between_s)?);
        let peak_a = self.rated_peak_a;
        Some(f64::midpoint(plus.at(peak_a), minus.at(peak_a)))
    }

    /// Returns the rms drop at the rated current over both polarities, V.
    fn rms_v(&self, between_s: (f64, f64)) -> Option<f64> {
        let (plus, minus) = (self.line(1.0, between_s)?, self.line(-1.0, between_s)?);
        let rms = |line: &DropLine| line.rms(self.rated_peak_a);
        Some(f64::midpoint(rms(&plus).powi(2), rms(&minus).powi(2)).sqrt())
    }

    /// Returns the drop without current, V: the mean of both polarities.
    fn threshold_v(&self, between_s: (f64, f64)) -> Option<f64> {
        let (plus, minus) = (self.line(1.0, between_s)?, self.line(-1.0, between_s)?);
        Some(f64::midpoint(plus.threshold_v, minus.threshold_v))
    }

    /// Returns whole periods, at least two, that end before the end of the record and begin after the first period.
    fn whole(&self) -> Option<(f64, f64)> {
        let last_s = self.volts.time(self.volts.len().checked_sub(1)?);
        let begins_s = self.current.zero_after(1.0 / self.current.hz);
        let periods = ((last_s - begins_s) * self.current.hz).floor();
        (periods >= 2.0).then(|| (begins_s, begins_s + periods / self.current.hz))
    }

    /// Returns the figures of the conducting output; `None` when there are too few samples. The channel of the drop
    /// follows the voltage up to `most_v`.
    pub fn read(&self, most_v: f64) -> Option<OnState> {
        let whole = self.whole()?;
        let matched = self.matched(whole, most_v)?;
        let (plus, minus) = (self.line(1.0, whole)?, self.line(-1.0, whole)?);
        let (peaks, each_rms) = (self.periods(Self::peak_v)?, self.periods(Self::rms_v)?);
        let (peak, rms) = (warming::course(&peaks)?, warming::course(&each_rms)?);
        let lead_s = self.lead_s()?;
        let peak_v = |at_s: f64| peak.at((at_s - lead_s) * self.current.hz);
        let samples = self.volts.index(whole.0)..self.volts.index(whole.1);
        let clipped = samples.clone().map(|it| self.clipped(it, most_v));
        let clipped: Vec<f64> = clipped.collect();
        let ampere: Vec<f64> = samples.map(|it| self.ampere.at(it)).collect();
        let (unequal, mean_a) = self.unequal(whole);
        let (peak_a, periods) = (self.rated_peak_a, (whole.1 - whole.0) * self.current.hz);
        let lead = lead_s * self.current.hz;
        let warm = Conducting {
            threshold_v: f64::midpoint(plus.threshold_v, minus.threshold_v),
            ohm: f64::midpoint(plus.ohm, minus.ohm),
            fires_v: matched.fires_v(whole),
            load_ohm: LOOP_OHM,
        };
        let cold = Conducting {
            threshold_v: warming::course(&self.periods(Self::threshold_v)?)?.at(-lead),
            ..warm
        };
        Some(OnState {
            peak_v: peak_v(0.0),
            rms_v: rms.at(-lead),
            first_v: [peak, rms].map(|it| it.at(-lead) - it.at(0.0)),
            drift_v: peak_v(DRIFT_S[1]) - peak_v(DRIFT_S[0]),
            offset_v: (self.mean_v(whole, most_v), jumps_u(&clipped)),
            distortion: matched.distortion(whole, most_v, [&cold, &warm])?,
            unequal: (unequal, jumps_u(&ampere) / mean_a),
            periods,
            mean_a,
            ohm: warm.ohm,
            noise_v: plus.u_at(peak_a).hypot(minus.u_at(peak_a)) / 2.0 * periods.sqrt(),
            referenced: self.referenced,
        })
    }

    /// Returns the mean voltage over whole periods, V; the interval at either end counts with its share.
    ///
    /// The channel cuts off the two polarities at voltages whose sizes differ by its offset. This function cuts off
    /// both at `most_v`, which is below either, so that the peaks of both polarities, at which the output waits,
    /// cancel.
    fn mean_v(&self, (from_s, to_s): (f64, f64), most_v: f64) -> f64 {
        let (from, to) = (self.volts.index(from_s), self.volts.index(to_s));
        let at = |it: usize| self.clipped(it, most_v);
        let inner: f64 = (from..to).map(at).sum();
        let before = (self.volts.time(from) - from_s) / self.volts.step_s;
        let behind = 1.0 - (self.volts.time(to) - to_s) / self.volts.step_s;
        // Sums the trapezoids between the samples, and a part of the interval at either end.
        let sum = inner + (before - 0.5) * at(from) + (behind - 0.5) * at(to.saturating_sub(1));
        sum * self.volts.step_s / (to_s - from_s)
    }

    fn clipped(&self, index: usize, most_v: f64) -> f64 {
        self.volts.at(index).clamp(-most_v, most_v)
    }

    /// Returns the difference of the charges of both polarities over their sum, and the mean absolute value of the
    /// current, A. While the mains grows, the polarity that comes second has the greater charge; the result is
    /// therefore the mean of two windows, half a period apart.
    fn unequal(&self, (from_s, to_s): (f64, f64)) -> (f64, f64) {
        let (half_s, period_s) = (self.current.half_s(), 1.0 / self.current.hz);
        let [one, other] = [0.0, half_s].map(|later_s| {
            let (from_s, to_s) = (from_s + later_s, to_s - period_s + later_s);
            let (from, to) = (self.ampere.index(from_s), self.ampere.index(to_s));
            let all = (from..to).map(|it| self.ampere.at(it));
            let (sum, size) = all.fold((0.0, 0.0), |(sum, size), it| (sum + it, size + it.abs()));
            (sum / size, size / (to - from) as f64)
        });
        let unequal = f64::midpoint(one.0, other.0).abs();
        (unequal, f64::midpoint(one.1, other.1))
    }

    /// Returns the difference of the voltage at the output from a sine, over whole periods. It reads the finer channel
    /// where that follows the output, because noise counts as distortion.
    ///
    /// The record shows a warm part at a source that is no sine and has another amplitude than the rated current needs.
    /// The model of the output shows what both change.
    fn distortion(
        &self,
        (from_s, to_s): (f64, f64),
        most_v: f64,
        [cold, warm]: [&Conducting; 2],
    ) -> Option<Distorted> {
        let (from, to) = (self.volts.index(from_s), self.volts.index(to_s));
        let samples = (from..to).map(|it| (self.volts.time(it), self.at(it, most_v)));
        let fitted = split::phasor(samples.clone(), self.current.hz)?;
        let [sine, cosine] = fitted.of;
        let squares: f64 = samples
            .clone()
            .map(|(time_s, volts)| {
                let (sin, cos) = (std::f64::consts::TAU * self.current.hz * time_s).sin_cos();
                (volts - fitted.mean - sine * sin - cosine * cos).powi(2)
            })
            .sum();
        let count = (to - from) as f64;
        let each_v2: Vec<f64> = samples.map(|(_, volts)| volts * volts).collect();
        let waits = (from..to).filter(|it| self.ampere.at(*it).abs() < WAITS * self.rated_peak_a);
        let waits_v2 = waits.map(|it| self.at(it, most_v).powi(2)).sum::<f64>() / count;
        let zero_s = self.source.zero_after(from_s);
        let seen = |turns: f64| self.source.at(zero_s + turns / self.source.hz);
        let changed_v = cold.distortion_v(cold.sine(self.rated_peak_a)) - warm.distortion_v(seen);
        Some(Distorted {
            rms_v: (squares / count).sqrt() + changed_v,
            fires_v: warm.fires_v,
            waits_v2,
            u_v2: jumps_u(&each_v2),
        })
    }

    /// Returns the voltage at which the output fires in each half cycle, V: the mean over half cycles of the greatest
    /// sample, and of the mains half an interval later.
    fn fires_v(&self, (from_s, to_s): (f64, f64)) -> f64 {
        let half_s = self.source.half_s();
        let zero_s = self.source.zero_after(from_s);
        let count = ((to_s - zero_s) / half_s).floor().max(1.0);
        let greatest = (0..count as u32).map(|it| {
            let begins_s = zero_s + f64::from(it) * half_s;
            let (from, to) = (
                self.whole.index(begins_s),
                self.whole.index(begins_s + half_s / 2.0),
            );
            (from..to).fold(0.0, |most, it| f64::max(most, self.whole.at(it).abs()))
        });
        let later_v = self.source.slope(zero_s).abs() * self.whole.step_s / 2.0;
        greatest.sum::<f64>() / count + later_v
    }

    /// Returns the record with the coarser channel of the output free of its offset, which the finer one shows.
    fn matched(&self, (from_s, to_s): (f64, f64), most_v: f64) -> Option<Self> {
        let both = (self.volts.index(from_s)..self.volts.index(to_s))
            .filter(|it| self.volts.at(*it).abs() < most_v);
        let apart = both.map(|it| self.whole.at(it) - self.volts.at(it));
        let (sum, count) = apart.fold((0.0, 0_u32), |(sum, count), it| (sum + it, count + 1));
        (count > 0).then(|| Self {
            whole: self.whole.less(sum / f64::from(count)),
            ..*self
        })
    }

    /// Returns the voltage of the output, V: from the channel of the drop below `most_v`, above it from the coarser
    /// channel.
    fn at(&self, index: usize, most_v: f64) -> f64 {
        let volts = self.volts.at(index);
        match volts.abs() < most_v {
            true => volts,
            false => self.whole.at(index),
        }
    }

    /// Returns the zero of the current from which on the output conducts half cycles, s. After the control edge a
    /// zero-cross part waits up to half a period, in which no current warms it. A first piece of less than half of a
    /// half cycle, such as that of a part that fires right before a zero, does not count.
    fn begins_s(&self) -> Option<f64> {
        let least_a = LEAST * self.current.amplitude();
        let flows = (0..self.ampere.len()).find(|it| self.ampere.at(*it).abs() >= least_a)?;
        Some(
            self.current
                .zero_after(self.ampere.time(flows) - self.current.half_s() / 2.0),
        )
    }

    /// Returns how long the current has warmed the part before [`Self::begins_s`], s; below 0 when its first half cycle
    /// is not whole. A piece of a half cycle counts in proportion to its charge.
    fn lead_s(&self) -> Option<f64> {
        let period_s = 1.0 / self.current.hz;
        let to = self.ampere.index(self.begins_s()? + period_s);
        let size = (0..to).map(|it| self.ampere.at(it).abs());
        let mean_a = self.current.amplitude() * 2.0 / PI;
        Some(size.sum::<f64>() * self.ampere.step_s / mean_a - period_s)
    }

    /// Returns a value of each period from the begin of the current on; `of` computes the value between two instants,
    /// s.
    fn periods(&self, of: impl Fn(&Self, (f64, f64)) -> Option<f64>) -> Option<Vec<f64>> {
        let period_s = 1.0 / self.current.hz;
        let begins_s = self.begins_s()?;
        let last_s = self.volts.time(self.volts.len().checked_sub(1)?);
        let count = ((last_s - begins_s) / period_s).floor().max(0.0) as usize;
        let each = (0..count).map(|it| {
            let from_s = begins_s + it as f64 * period_s;
            of(self, (from_s, from_s + period_s))
        });
        each.collect()
    }
}

/// Concludes the loop.
pub fn conclude(
    state: &mut State,
    plan: &Plan,
    ac: &AcPlan,
    given: &Given,
) -> Result<Next, Reason> {
    let [whole, volts, shunt] = given.waveforms()?;
    // In a loop that opens, a good part seems to miss half cycles.
    supply::proven(ac, &ac.looped(), [&whole, &shunt])?;
    let drops = Drops::of(ac, state.references, [&whole, &volts, &shunt]);
    let Some(on) = drops
        .as_ref()
        .and_then(|it| it.read(FOLLOWED * 4.0 * ac.drop_scale_v))
    else {
        state.record.stop(Finding::HalfWave);
        return Ok(Next::Planned);
    };
    if on.peak_v >= FOLLOWED * 4.0 * ac.drop_scale_v {
        if plan.bounds(Parameter::Drop) {
            state.record.stop(Finding::PeakDropTooHigh);
        }
        return Ok(Next::Planned);
    }
    let peak_a = SQRT_2 * ac.rated_a;
    let [first_v, first_rms_v] = on.first_v;
    let budget = |drop, first_v| {
        let budget = accuracy::line_drop(plan, ac, &on, drop);
        budget.with_random_bounds("first half cycle", first_v)
    };
    let of_peak = (on.peak_v, on.ohm * peak_a);
    let of_rms = (on.rms_v, on.of_current_v(peak_a));
    let offset = accuracy::line_offset(ac, &on);
    let offset_mv = on.offset_v.0 * 1e3;
    use Parameter as P;
    use Unit::{Millivolt, Percent, Volt};
    state.found([
        (P::Drop, on.peak_v, Volt, budget(of_peak, first_v)),
        (P::DropRms, on.rms_v, Volt, budget(of_rms, first_rms_v)),
        (P::DcOffset, offset_mv, Millivolt, offset),
        (
            P::Distortion,
            on.distortion.rms_v * 1e3,
            Millivolt,
            accuracy::distortion(plan, ac, &on),
        ),
        (
            P::HalfWave,
            on.unequal.0 * 100.0,
            Percent,
            accuracy::unequal(ac, &on),
        ),
        (
            P::Drift,
            on.drift_v * 1e3,
            Millivolt,
            accuracy::line_drift(ac, &on),
        ),
    ]);
    Ok(Next::Planned)
}
