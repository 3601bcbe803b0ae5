//! Finds the instants at which the voltage of an output jumps from the curve of the mains to the drop.

use super::Channel;
use super::least_squares::Sums;

/// Greatest number of samples before a jump for the straight line, and of samples after it for the level.
const SIDE: usize = 12;
const BEHIND: usize = 5;

/// A jump between two samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Time in the middle of the two samples, s.
    pub at_s: f64,
    /// Value of the straight line through the samples before, at that time.
    pub before: f64,
    /// Rise per second of that line.
    pub slope: f64,
    /// Standard uncertainty of `before` from noise, without that of the instant.
    pub u: f64,
    /// Number of the first sample behind the jump.
    pub index: usize,
}

impl Jump {
    /// Returns the jump for a curve whose rise before it is known. Then `before` is the mean of the samples, carried to
    /// the jump by that rise. This halves the uncertainty, because the samples need not show the rise as well.
    pub fn along(self, slope: f64, step_s: f64) -> Self {
        let from_middle_s = SIDE as f64 / 2.0 * step_s;
        Self {
            before: self.before + (slope - self.slope) * from_middle_s,
            slope,
            u: self.u / 2.0,
            ..self
        }
    }
}

/// Returns the first sample from `from` to before `to` with which `count` samples in a row within `level` of 0 begin.
pub fn quiet_from(
    value: impl Fn(usize) -> f64,
    (from, to): (usize, usize),
    level: f64,
    count: usize,
) -> Option<usize> {
    let mut run = 0;
    for index in from..to {
        run = match value(index).abs() <= level {
            true => run + 1,
            false => 0,
        };
        if run == count {
            return Some(index + 1 - count);
        }
    }
    None
}

/// Returns the jump between `from` and `to`: the split for which a straight line through the samples right before it
/// and a level through those right after it leave the least sum of squares.
pub fn jump(
    channel: &Channel,
    value: impl Fn(usize) -> f64,
    (from, to): (usize, usize),
) -> Option<Jump> {
    let first = from.max(SIDE);
    let last = to.min(channel.len().checked_sub(BEHIND)?);
    let splits = (first..last).filter_map(|index| {
        let line = line_before(channel, &value, index)?;
        let behind = (index..index + BEHIND).map(&value);
        let level = behind.clone().sum::<f64>() / BEHIND as f64;
        let spread: f64 = behind.map(|it| (it - level).powi(2)).sum();
        let squares = line.1.powi(2) * (SIDE - 2) as f64 + spread;
        Some((squares, index, line))
    });
    let (_, index, (line, residual)) = splits.min_by(|one, other| one.0.total_cmp(&other.0))?;
    let at_s = channel.time(index) - channel.step_s / 2.0;
    let before = line[0] - line[1] * channel.step_s / 2.0;
    // At its end, a line through n points is known to twice the standard deviation of their mean.
    let u = 2.0 * residual / (SIDE as f64).sqrt();
    Some(Jump {
        at_s,
        before,
        slope: line[1],
        u,
        index,
    })
}

/// Returns the straight line of the samples before `index`: its value at the time of `index`, its rise per second, and
/// the standard deviation of the samples around it.
fn line_before(
    channel: &Channel,
    value: &impl Fn(usize) -> f64,
    index: usize,
) -> Option<([f64; 2], f64)> {
    let mut sums = Sums::<2>::default();
    for sample in index - SIDE..index {
        let since_s = (sample as f64 - index as f64) * channel.step_s;
        sums.add([1.0, since_s], value(sample));
    }
    let solution = sums.solve()?;
    Some((solution.of, solution.residual))
}
