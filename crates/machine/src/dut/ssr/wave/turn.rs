//! Finds the instants at which the voltage of an output jumps from the curve of the mains to the drop.
//!
//! Before the jump the output follows the mains, whose curve is known from the whole record except for a shift from
//! cycle to cycle. Behind the jump the output stays at its drop. The search tries every split of the same window; the
//! split with the least sum of squares is the jump. The window and its parts are times, so that the result depends
//! neither on the rate of the samples nor on which of two channels shows them.

use super::Channel;
use super::mains::Mains;

/// Time before a jump, s: its samples show the shift of the mains.
const BEFORE_S: f64 = 120e-6;
/// Time behind a jump, s: its samples show the drop.
const BEHIND_S: f64 = 50e-6;
/// Least number of samples before a jump.
const FEWEST_BEFORE: usize = 12;
/// Least number of samples behind a jump.
const FEWEST_BEHIND: usize = 2;

/// A jump between two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Time in the middle of the two samples, s.
    pub at_s: f64,
    /// Value before the jump, at that time.
    pub before: f64,
    /// Rise of the mains per second at that time.
    pub slope: f64,
    /// Standard uncertainty of `before` from noise, without that of the instant.
    pub u: f64,
    /// Number of the first sample behind the jump.
    pub index: usize,
}

/// Returns the first of `count` samples in a row that `is_so` accepts, from `from` to before `to`; `None` without such
/// a row.
pub fn run_from(
    is_so: impl Fn(usize) -> bool,
    (from, to): (usize, usize),
    count: usize,
) -> Option<usize> {
    let mut run = 0;
    for index in from..to {
        run = if is_so(index) { run + 1 } else { 0 };
        if run == count {
            return Some(index + 1 - count);
        }
    }
    None
}

/// Returns the jump whose first sample behind it is one from `from` to `last`; at `last` the output conducts. `None`
/// without samples before the jump.
pub fn jump(
    channel: &Channel,
    value: impl Fn(usize) -> f64,
    mains: &Mains,
    (from, last): (usize, usize),
) -> Option<Jump> {
    let before = samples(channel, BEFORE_S).max(FEWEST_BEFORE);
    let behind = samples(channel, BEHIND_S).max(FEWEST_BEHIND);
    let begins = from.saturating_sub(before);
    let ends = (last + behind).min(channel.len());
    let at = |it: usize| (value(it), mains.at(channel.time(it)));
    let seen: Vec<(f64, f64)> = (begins..ends).map(at).collect();
    let shifts: Vec<f64> = seen.iter().map(|(volts, line)| volts - line).collect();
    // The drop has the sign of the mains.
    let drops: Vec<f64> = seen
        .iter()
        .map(|(volts, line)| volts * line.signum())
        .collect();
    let squares = |split: &usize| {
        let (shift, drop) = (Level::of(&shifts[..*split]), Level::of(&drops[*split..]));
        shift.squares + drop.squares
    };
    let splits = (from.max(begins + 2)..=last).map(|it| it - begins);
    let split = splits.min_by(|one, other| squares(one).total_cmp(&squares(other)))?;
    let shift = Level::of(&shifts[split.saturating_sub(before)..split]);
    let index = begins + split;
    let at_s = channel.time(index) - channel.step_s / 2.0;
    Some(Jump {
        at_s,
        before: mains.at(at_s) + shift.mean,
        slope: mains.slope(at_s),
        u: (shift.squares / (shift.count - 1.0)).sqrt() / shift.count.sqrt(),
        index,
    })
}

/// Returns the number of samples in a time, at least 1.
fn samples(channel: &Channel, time_s: f64) -> usize {
    (time_s / channel.step_s).round().max(1.0) as usize
}

/// Mean of values, the sum of squares around it, and their number.
struct Level {
    mean: f64,
    squares: f64,
    count: f64,
}

impl Level {
    fn of(values: &[f64]) -> Self {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count.max(1.0);
        let squares = values.iter().map(|it| (it - mean).powi(2)).sum();
        Self {
            mean,
            squares,
            count,
        }
    }
}

#[cfg(test)]
mod tests;
