//! A box on its way: what the broad phase asks with.

use super::silhouettes::Cover;
use crate::lpm::vector::Vec3;

/// A box that is translated: `low..high` at the start (margin included), then by `displacement`, mm.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sweep {
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
    pub(crate) displacement: Vec3,
}

/// Slack of a place along the way, mm: the rounding of times and products below, at most 2e-9 mm
/// within 3e6 mm, many times over.
const SLACK_MM: f64 = 1e-6;

impl Sweep {
    /// The box around the way up to the fraction `until`.
    #[inline]
    pub(crate) fn covered(&self, until: f64) -> (Vec3, Vec3) {
        let mut covered = (self.low, self.high);
        for axis in 0..3 {
            let way = self.displacement[axis] * until;
            covered.0[axis] += way.min(0.0);
            covered.1[axis] += way.max(0.0);
        }
        covered
    }

    /// The box around the way up to the fraction `until`, in single precision.
    #[inline]
    pub(crate) fn cover(&self, until: f64) -> Cover {
        Cover::of(self.covered(until))
    }

    /// Part of the move during which `axis` overlaps `low..high`; only for an axis that moves.
    #[inline]
    pub(crate) fn during(&self, axis: usize, low: f64, high: f64) -> (f64, f64) {
        self.during_by(axis, 1.0 / self.displacement[axis], low, high)
    }

    /// The same with the reciprocal of the displacement on `axis`.
    #[inline]
    pub(crate) fn during_by(&self, axis: usize, pace: f64, low: f64, high: f64) -> (f64, f64) {
        let (behind, ahead) = (
            low - self.high[axis] - SLACK_MM,
            high - self.low[axis] + SLACK_MM,
        );
        let (one, two) = (behind * pace, ahead * pace);
        (one.min(two), one.max(two))
    }

    /// What is covered on `axis` between two fractions of the move.
    #[inline]
    pub(crate) fn between(&self, axis: usize, first: f64, last: f64) -> (f64, f64) {
        let rate = self.displacement[axis];
        let (one, two) = (rate * first, rate * last);
        (
            self.low[axis] + one.min(two) - SLACK_MM,
            self.high[axis] + one.max(two) + SLACK_MM,
        )
    }

    /// Not before this fraction of the way does the box meet `cover`.
    pub(crate) fn first_over(&self, cover: &Cover) -> f64 {
        let moving = (0..3).filter(|axis| self.displacement[*axis].abs() > 1e-9);
        moving.fold(0.0, |first, axis| {
            let (low, high) = (f64::from(cover.low[axis]), f64::from(cover.high[axis]));
            self.during(axis, low, high).0.max(first)
        })
    }
}
