//! Values in ascending order: exact quantiles and the histogram.
//!
//! A quantile is interpolated between the two sorted values around the place `(n - 1) p` (type 7 of Hyndman and Fan,
//! "inclusive" in spreadsheets), so p = 0, 1/2 and 1 give minimum, median and maximum.

use serde::Serialize;
use utoipa::ToSchema;

/// Finite values in ascending order.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Ordered(Vec<f64>);

/// Histogram: number of values in each of several classes of equal width.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Histogram {
    /// Lower edge of the first class.
    pub from: f64,
    /// Width of every class: 1, 2 or 5 times a power of ten.
    pub width: f64,
    /// Number of values per class; a value on an edge belongs to the class above it.
    pub counts: Vec<u64>,
}

impl Histogram {
    /// Returns the index of the class of a value, or of the nearest class for a value outside all classes.
    pub fn class(&self, value: f64) -> usize {
        let class = ((value - self.from) / self.width).floor().max(0.0) as usize;
        class.min(self.counts.len() - 1)
    }

    /// Counts a value in its class.
    pub(super) fn add(&mut self, value: f64) {
        let class = self.class(value);
        self.counts[class] += 1;
    }
}

impl Ordered {
    /// Sorts a copy of the finite values; leaves out the others.
    pub fn of(values: &[f64]) -> Self {
        let mut values: Vec<f64> = values.iter().copied().filter(|it| it.is_finite()).collect();
        values.sort_unstable_by(f64::total_cmp);
        Self(values)
    }

    /// Returns the number of values.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Returns true when there are no values.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns the value below which the fraction `p` (0 to 1) of the values lies; `None` when there are no values, or
    /// when `p` is outside 0 to 1.
    pub fn quantile(&self, p: f64) -> Option<f64> {
        let last = self.0.len().checked_sub(1)?;
        if !(0.0..=1.0).contains(&p) {
            return None;
        }
        let place = p * last as f64;
        let below = place.floor();
        let low = *self.0.get(below as usize)?;
        let high = *self.0.get((below as usize + 1).min(last))?;
        Some(low + (place - below) * (high - low))
    }

    /// Returns a histogram of all values with about `classes` classes, whose edges are round numbers; `None` when all
    /// values are equal.
    pub fn histogram(&self, classes: usize) -> Option<Histogram> {
        let (&low, &high) = (self.0.first()?, self.0.last()?);
        let width = round_step((high - low) / classes.max(1) as f64)?;
        let from = (low / width).floor() * width;
        let last = ((high - from) / width).floor() as usize;
        let mut histogram = Histogram {
            from,
            width,
            counts: vec![0; last + 1],
        };
        for value in &self.0 {
            histogram.add(*value);
        }
        Some(histogram)
    }
}

/// Returns the least number that is 1, 2 or 5 times a power of ten and at least `step`; `None` unless `step` is above
/// zero.
pub fn round_step(step: f64) -> Option<f64> {
    if !(step.is_finite() && step > 0.0) {
        return None;
    }
    let power = 10_f64.powf(step.log10().floor());
    let round = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|it| it * power)
        .find(|it| *it >= step * (1.0 - 1e-12));
    Some(round.unwrap_or(10.0 * power))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn quantiles_lie_between_order_statistics() {
        let it = Ordered::of(&[40.0, 10.0, 30.0, 20.0]);
        let found = [0.0, 0.25, 0.5, 1.0].map(|p| it.quantile(p).unwrap());
        assert_eq!(found, [10.0, 17.5, 25.0, 40.0]);
        assert_eq!(
            (it.quantile(1.1), Ordered::of(&[]).quantile(0.5)),
            (None, None)
        );
    }

    #[test]
    fn a_histogram_counts_every_value_once_in_round_classes() {
        let values: Vec<f64> = (0..100).map(|n| 7.0 + f64::from(n) / 100.0).collect();
        let it = Ordered::of(&values).histogram(10).unwrap();
        assert_eq!((it.from, it.width, it.counts.len()), (7.0, 0.1, 10));
        assert_eq!(it.counts.iter().sum::<u64>(), 100);
        assert_eq!(Ordered::of(&[1.0, 1.0]).histogram(10), None);
    }

    #[test]
    fn a_value_that_is_not_finite_is_ignored() {
        assert_eq!(Ordered::of(&[f64::NAN, 2.0]).len(), 1);
        assert!(Ordered::of(&[]).is_empty());
    }
}
