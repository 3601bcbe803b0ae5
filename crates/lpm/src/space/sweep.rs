//! A moving box, as the broad phase sees it.

use super::cover::Cover;
use crate::vector::Vec3;

/// Slack of a place along the path, mm: far more than the rounding of slopes and products (at most 2e-9 mm within
/// 3e6 mm), and than the loss next to 0 when [`Area`](super::area::Area) subtracts half a square (at most 2e-6 mm).
pub(crate) const SLACK_MM: f64 = 1e-5;

/// Displacement along an axis below which the box counts as at rest there, mm; every moving box is widened by as much.
pub(crate) const SLOWEST_MM: f64 = 1e-9;

/// Fraction of the path per millimetre along each axis; infinite for an axis at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pace(pub(crate) [f32; 3]);

impl Pace {
    /// Computes the pace of a box that moves by `run`, mm.
    #[inline]
    pub(crate) fn of(run: Vec3) -> Pace {
        let of = |way: f64| {
            if way.abs() < SLOWEST_MM {
                f32::INFINITY
            } else {
                1.0 / way as f32
            }
        };
        Pace([of(run[0]), of(run[1]), of(run[2])])
    }

    /// Returns true when the pace is that of an axis along which the box moves.
    #[inline(always)]
    pub(super) fn is_moving(pace: f32) -> bool {
        pace.is_finite()
    }

    /// Returns the pace of the surroundings as seen from the box.
    #[inline]
    pub(crate) fn reversed(self) -> Pace {
        let [x, y, z] = self.0;
        Pace([-x, -y, -z])
    }
}

/// A box that is translated by `run`, mm.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sweep {
    /// The box at the start, margin included.
    pub(crate) start: Cover,
    pub(crate) run: Vec3,
    pub(crate) pace: Pace,
}

impl Sweep {
    #[inline]
    pub(crate) fn new(start: Cover, run: Vec3) -> Sweep {
        Sweep {
            start,
            run,
            pace: Pace::of(run),
        }
    }

    /// Returns the box around the path of this box up to the fraction `until`.
    #[inline]
    pub(crate) fn cover(&self, until: f64) -> Cover {
        let [x, y, z] = self.run;
        self.start.swept([x * until, y * until, z * until])
    }

    /// Returns the box around the part of the path between two fractions.
    #[inline]
    pub(crate) fn between(&self, from: f64, to: f64) -> Cover {
        let [x, y, z] = self.run;
        let place = |t: f64| self.start.swept_to([x * t, y * t, z * t]);
        place(from).around(place(to))
    }

    /// Returns true when the box moves along more than one axis; the box around its path is then much larger than the
    /// path.
    #[inline]
    pub(crate) fn is_slanted(&self) -> bool {
        let moving = |axis: usize| u32::from(self.run[axis].abs() >= SLOWEST_MM);
        moving(0) + moving(1) + moving(2) > 1
    }
}
