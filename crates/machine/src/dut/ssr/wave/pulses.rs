//! Finds how the output of an AC part has answered the pulses of a train: when and at which voltage it turned on, its
//! voltage at the start of later half cycles, and when it turned off.

use super::Channel;
use super::mains::Mains;
use super::turn::{Jump, jump, run_from};

/// The clamped channel follows the output up to this share of the clamp voltage.
const FOLLOWS: f64 = 0.93;
/// Least voltage of a sample that counts as mains and not as a conducting output, V.
const BLOCKED_V: f64 = 15.0;
/// Greatest number of samples in a fit.
const FITTED: usize = 2500;
/// Least difference between mains and conducting output at which the two can be told apart, V.
const APART_V: f64 = 1.5;
/// An edge nearer than this to a zero of the mains may lie on either side of it, s.
const AMBIGUOUS_S: f64 = 0.4e-3;
/// Time for which an output must block without a break before it counts as off, s.
const OFF_S: f64 = 1e-3;
/// Time for which an output must conduct without a break before it counts as on, s.
const CONDUCTS_S: f64 = 10e-6;
/// Time before and after a zero of the mains in which an output fires again, s.
const AGAIN_S: f64 = 0.8e-3;

/// Output voltage in one record: a divided channel for the whole range, a clamped one for small voltages.
#[derive(Debug, Clone, Copy)]
pub struct Output<'a> {
    /// The whole voltage, V.
    pub divided: Channel<'a>,
    /// The same, cut off at the clamp, V.
    pub clamped: Channel<'a>,
    /// Voltage of the clamp, V.
    pub clamp_v: f64,
    /// Largest voltage of an output that counts as conducting, V.
    pub on_v: f64,
}

/// One control pulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulse {
    /// Rising edge, s.
    pub rise_s: f64,
    /// Falling edge, s.
    pub fall_s: f64,
    /// End of the time in which the output may answer, s.
    pub end_s: f64,
}

/// Answer of an output to one pulse.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The pulse.
    pub pulse: Pulse,
    /// First zero of the mains after the rising edge, s.
    pub zero_s: f64,
    /// Voltage of the mains at the rising edge, V.
    pub edge_v: f64,
    /// Jump at the turn-on; `None` when the output blocks until `end_s`.
    pub on: Option<Jump>,
    /// Greatest voltage of the output at the start of each later half cycle, V.
    pub again_v: Vec<f64>,
    /// First zero of the mains after the falling edge, s.
    pub off_zero_s: f64,
    /// Zero of the mains at which the output has turned off, s; `None` when it conducts until `end_s`.
    pub off_s: Option<f64>,
}

impl Answer {
    /// Returns the time from the first zero of the mains after the rising edge to the turn-on, s; none for an edge too
    /// close to a zero. Near that zero, it is the time in which the nominal mains, with `slope` V/s at its zero,
    /// reaches the voltage before the turn-on: the mains varies from cycle to cycle, and its harmonics bend the zero.
    pub fn after_zero_s(&self, mains: &Mains, slope: f64) -> Option<f64> {
        let on = self.on?;
        let took_s = on.at_s - self.zero_s;
        let by_line_s = on.before / slope.copysign(on.slope);
        let is_near = took_s.abs() < AMBIGUOUS_S && by_line_s.abs() < AMBIGUOUS_S;
        let took_s = if is_near { by_line_s } else { took_s };
        is_clear(mains, self.pulse.rise_s).then_some(took_s)
    }

    /// Returns the time from the first zero of the mains after the falling edge to the zero at which the output turned
    /// off, s: a whole number of half periods. `None` for an edge too close to a zero.
    pub fn off_after_zero_s(&self, mains: &Mains) -> Option<f64> {
        let halves = ((self.off_s? - self.off_zero_s) / mains.half_s()).round();
        is_clear(mains, self.pulse.fall_s).then_some(halves * mains.half_s())
    }
}

fn is_clear(mains: &Mains, edge_s: f64) -> bool {
    let next_s = mains.zero_after(edge_s) - edge_s;
    next_s > AMBIGUOUS_S && mains.half_s() - next_s > AMBIGUOUS_S
}

impl Output<'_> {
    /// Returns the voltage of a sample, V: from the clamped channel while that follows, else from the divided one.
    pub fn at(&self, index: usize) -> f64 {
        let clamped = self.clamped.at(index);
        match clamped.abs() < FOLLOWS * self.clamp_v {
            true => clamped,
            false => self.divided.at(index),
        }
    }

    /// Fits the mains to the samples at which the output blocks; `None` when there are too few.
    pub fn mains(&self, nominal_hz: f64) -> Option<Mains> {
        let count = self.divided.len();
        let all = self.divided.pairs(0, count, count / FITTED);
        Mains::fit(all.filter(|(_, volts)| volts.abs() > BLOCKED_V), nominal_hz)
    }

    /// Returns the number of samples in which the mains passes through the range of a conducting output.
    fn passing(&self, mains: &Mains) -> usize {
        let slope = std::f64::consts::TAU * mains.hz * mains.amplitude();
        (2.0 * self.on_v / slope / self.divided.step_s).ceil() as usize
    }

    /// Finds the answer to a pulse.
    pub fn answer(&self, mains: &Mains, pulse: Pulse) -> Answer {
        let on = self.turn_on(mains, &pulse);
        let off_zero_s = mains.zero_after(pulse.fall_s);
        Answer {
            pulse,
            zero_s: mains.zero_after(pulse.rise_s),
            edge_v: mains.at(pulse.rise_s),
            on,
            again_v: on.map_or_else(Vec::new, |on| self.again(mains, &pulse, on.at_s)),
            off_zero_s,
            off_s: on.and_then(|_| self.turn_off(mains, &pulse)),
        }
    }

    /// Finds the first instant at which the output is low while the mains is not. A part that fires on the falling
    /// flank goes out at the zero and fires again after it; that second firing is not the turn-on.
    fn turn_on(&self, mains: &Mains, pulse: &Pulse) -> Option<Jump> {
        let channel = &self.divided;
        let (from, to) = (channel.index(pulse.rise_s), channel.index(pulse.end_s));
        let apart_v = self.on_v + APART_V;
        let conducts = |it: usize| {
            let is_low = self.at(it).abs() <= self.on_v;
            is_low && mains.at(channel.time(it)).abs() > apart_v
        };
        let first = run_from(conducts, (from, to), self.conducting_count())?;
        let back = 2 * self.passing(mains) + 5;
        let range = (first.saturating_sub(back).max(from), first);
        jump(channel, |it| self.at(it), mains, range)
    }

    /// Returns the number of samples in a row that must show the conducting output.
    fn conducting_count(&self) -> usize {
        let count = (CONDUCTS_S / self.divided.step_s).round() as usize + 1;
        count.max(2)
    }

    /// Returns the peak after each zero of the mains, from the turn-on to the falling edge. The true peak lies between
    /// two samples, on average half of the last rise above the greatest one: a snubber makes the output rise slower than
    /// the mains.
    fn again(&self, mains: &Mains, pulse: &Pulse, on_s: f64) -> Vec<f64> {
        let channel = &self.clamped;
        let mut peaks = Vec::new();
        let mut zero_s = mains.zero_after(on_s + mains.half_s() / 2.0);
        while zero_s + AGAIN_S < pulse.fall_s {
            let (from, to) = (
                channel.index(zero_s - AGAIN_S),
                channel.index(zero_s + AGAIN_S),
            );
            let size_v = |it: usize| self.at(it).abs();
            let peak = (from..to).max_by(|one, other| size_v(*one).total_cmp(&size_v(*other)));
            peaks.extend(peak.map(|it| {
                let peak_v = size_v(it);
                let rest_v = (peak_v - size_v(it.saturating_sub(1))).max(0.0) / 2.0;
                match peak_v > self.on_v / 2.0 {
                    true => peak_v + rest_v,
                    false => peak_v,
                }
            }));
            zero_s += mains.half_s();
        }
        peaks
    }

    /// Finds the zero of the mains after which the output blocks without a break: there the current ended.
    fn turn_off(&self, mains: &Mains, pulse: &Pulse) -> Option<f64> {
        let channel = &self.divided;
        let (from, to) = (channel.index(pulse.fall_s), channel.index(pulse.end_s));
        let count = (OFF_S / channel.step_s).ceil() as usize;
        let blocks = |it: usize| self.at(it).abs() > self.on_v;
        let begins = run_from(blocks, (from, to), count)?;
        let begins_s = channel.time(begins);
        Some(mains.zero_after(begins_s - mains.half_s() / 2.0))
    }
}
