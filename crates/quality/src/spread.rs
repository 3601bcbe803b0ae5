//! Mean, variance and lag-1 autocorrelation, in two passes over the values and in double-double precision.
//!
//! The textbook formula, sum of squares minus square of the sum, loses all digits when the spread is small beside the
//! mean. Here the first pass finds the mean and the second sums the deviations from it, both as `Double`; the error
//! that remains comes from storing decimal data in binary.
//!
//! Two sets of values are merged by `M2 = M2a + M2b + d^2 na nb / (na + nb)`, with `d` the difference of their means
//! (Chan, Golub and LeVeque 1983), in the same arithmetic.

use super::double::Double;

/// Number of independent partial sums: one addition in double-double precision takes as long as four that the processor
/// overlaps.
const SIDE_BY_SIDE: usize = 4;

/// Returns the sum of the terms 0 to `n` - 1.
fn total(n: usize, term: impl Fn(usize) -> Double) -> Double {
    let mut sums = [Double::default(); SIDE_BY_SIDE];
    let whole = n - n % SIDE_BY_SIDE;
    for first in (0..whole).step_by(SIDE_BY_SIDE) {
        for (beside, sum) in sums.iter_mut().enumerate() {
            *sum = sum.plus(term(first + beside));
        }
    }
    let rest = (whole..n).map(term);
    rest.chain(sums).fold(Double::default(), Double::plus)
}

/// Number, mean and squared deviations of a set of values. A value that is not finite makes every figure `None`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spread {
    n: u64,
    mean: Double,
    squares: Double,
    range: Option<(f64, f64)>,
}

impl Spread {
    /// Computes number, mean and squared deviations of `values`.
    pub fn of(values: &[f64]) -> Self {
        if values.is_empty() {
            return Self::default();
        }
        let sum = total(values.len(), |n| Double::new(values[n]));
        let mean = sum.over(values.len() as f64);
        let squares = total(values.len(), |n| {
            let deviation = Double::new(values[n]).minus(mean);
            deviation.times(deviation)
        });
        let range = values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &it| {
                (low.min(it), high.max(it))
            });
        Self {
            n: values.len() as u64,
            mean,
            squares,
            range: Some(range),
        }
    }

    /// Returns the spread of the values of both sets together.
    pub fn merged(self, other: Self) -> Self {
        let (Some((low, high)), Some((other_low, other_high))) = (self.range, other.range) else {
            return if self.n == 0 { other } else { self };
        };
        let (a, b) = (self.n as f64, other.n as f64);
        let apart = other.mean.minus(self.mean);
        let mean = self.mean.plus(apart.times(Double::new(b)).over(a + b));
        let between = apart
            .times(apart)
            .times(Double::new(a))
            .times(Double::new(b))
            .over(a + b);
        Self {
            n: self.n + other.n,
            mean,
            squares: self.squares.plus(other.squares).plus(between),
            range: Some((low.min(other_low), high.max(other_high))),
        }
    }

    /// Returns the number of values.
    pub fn n(&self) -> u64 {
        self.n
    }
    /// Returns the mean; `None` without values.
    pub fn mean(&self) -> Option<f64> {
        finite(self.range.map(|_| self.mean.value()))
    }
    /// Returns the standard deviation with n - 1; `None` with fewer than two values.
    pub fn sd(&self) -> Option<f64> {
        let degrees = self.n.checked_sub(1).filter(|&it| it > 0)?;
        let variance = finite(Some(self.squares.over(degrees as f64).value()))?;
        Some(variance.max(0.0).sqrt())
    }
    /// Returns the least value.
    pub fn min(&self) -> Option<f64> {
        finite(self.range.map(|(low, _)| low))
    }
    /// Returns the greatest value.
    pub fn max(&self) -> Option<f64> {
        finite(self.range.map(|(_, high)| high))
    }
}

/// Returns the lag-1 autocorrelation of `values` in their order; `all` is the spread of the same values. Returns `None`
/// with fewer than two values, and when all are equal.
pub fn lag1_about(all: &Spread, values: &[f64]) -> Option<f64> {
    let squares = all.squares.value();
    let deviation = |value: f64| Double::new(value).minus(all.mean);
    let pairs = values.len().saturating_sub(1);
    let products = total(pairs, |n| {
        deviation(values[n]).times(deviation(values[n + 1]))
    });
    (squares > 0.0)
        .then(|| products.value() / squares)
        .filter(|it| it.is_finite())
}

/// Returns the mean absolute difference of neighbours; `None` with fewer than two values.
pub fn mean_moving_range(values: &[f64]) -> Option<f64> {
    let pairs = values.len().checked_sub(1).filter(|&it| it > 0)?;
    let sum = total(pairs, |n| Double::new((values[n + 1] - values[n]).abs()));
    finite(Some(sum.over(pairs as f64).value()))
}

/// Returns the middle value, or the mean of the two middle ones; `None` without values.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut values = values.to_vec();
    let middle = values.len() / 2;
    if values.is_empty() {
        return None;
    }
    let even = values.len().is_multiple_of(2);
    let (below, &mut upper, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    if !even {
        return finite(Some(upper));
    }
    let lower = below.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    finite(Some(lower + (upper - lower) / 2.0))
}

fn finite(number: Option<f64>) -> Option<f64> {
    number.filter(|it| it.is_finite())
}

#[cfg(test)]
#[path = "spread_tests.rs"]
mod tests;
