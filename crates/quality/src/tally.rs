//! Mean, spread and histogram of values that arrive one at a time, in constant memory.
//!
//! [`Tally`] collects values in portions of 1,000 and merges their figures without loss. The first portion fixes the
//! classes of the histogram: about twelve over its range, and twelve more beyond each end. A value farther out counts
//! in the outermost class.

use super::ordered::{Histogram, Ordered};
use super::spread::Spread;

/// Number of values that are collected before they are merged into the figures.
const SHARD: usize = 1_000;
/// Approximate number of classes over the range of the first portion.
const CLASSES: usize = 12;

/// Figures and histogram of the values so far.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    merged: Spread,
    shard: Vec<f64>,
    classes: Option<Histogram>,
}

impl Tally {
    /// Adds a value; ignores a value that is not finite.
    pub fn add(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        self.shard.push(value);
        if self.shard.len() == SHARD {
            self.merge();
        }
    }

    /// Returns figures and histogram of all values; the histogram is `None` when all values are equal.
    pub fn finish(mut self) -> (Spread, Option<Histogram>) {
        self.merge();
        (self.merged, self.classes.map(trimmed))
    }

    fn merge(&mut self) {
        self.merged = self.merged.merged(Spread::of(&self.shard));
        if self.classes.is_none() {
            self.classes = Ordered::of(&self.shard).histogram(CLASSES).map(wider);
        }
        if let Some(classes) = &mut self.classes {
            for value in &self.shard {
                classes.add(*value);
            }
        }
        self.shard.clear();
    }
}

/// Returns an empty histogram with the classes of `it` and twelve more at each end.
fn wider(it: Histogram) -> Histogram {
    Histogram {
        from: it.from - CLASSES as f64 * it.width,
        width: it.width,
        counts: vec![0; it.counts.len() + 2 * CLASSES],
    }
}

/// Removes the empty classes at both ends of `it`.
fn trimmed(it: Histogram) -> Histogram {
    let first = it.counts.iter().position(|&n| n > 0).unwrap_or(0);
    let end = it
        .counts
        .iter()
        .rposition(|&n| n > 0)
        .map_or(0, |at| at + 1);
    Histogram {
        from: it.from + first as f64 * it.width,
        width: it.width,
        counts: it.counts[first..end].to_vec(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_tally_matches_the_moments_and_counts_every_value() {
        let values: Vec<f64> = (0..5_500)
            .map(|n| 7.0 + f64::from(n % 997) / 1000.0)
            .collect();
        let mut tally = Tally::default();
        values.iter().for_each(|it| tally.add(*it));
        tally.add(f64::NAN);
        tally.add(1e6);
        let (spread, histogram) = tally.finish();
        let whole = Spread::of(&[values, vec![1e6]].concat());
        assert_eq!((spread.n(), spread.max()), (5_501, Some(1e6)));
        assert!((spread.sd().unwrap() / whole.sd().unwrap() - 1.0).abs() < 1e-14);
        let histogram = histogram.unwrap();
        assert_eq!(histogram.counts.iter().sum::<u64>(), 5_501);
        assert_eq!((histogram.from, histogram.width), (7.0, 0.1));
    }

    #[test]
    fn equal_values_have_no_histogram() {
        let mut tally = Tally::default();
        (0..10).for_each(|_| tally.add(3.0));
        assert_eq!(tally.finish().1, None);
    }
}
