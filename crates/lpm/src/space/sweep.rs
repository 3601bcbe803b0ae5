//! A box on its way: what the broad phase asks with.

use super::cover::Cover;
use crate::vector::Vec3;

/// Slack of a place along the way, mm: the rounding of slopes and products, at most 2e-9 mm within 3e6 mm, and
/// what [`Area`](super::area::Area) loses next to 0 by taking half a square off, at most 2e-6 mm, many times over.
pub(crate) const SLACK_MM: f64 = 1e-5;

/// Ways shorter than this on an axis, mm, are counted as rest; every box on a way is widened by it.
pub(crate) const SLOWEST_MM: f64 = 1e-9;

/// How long a box takes for a millimetre of each axis, as a fraction of its way; infinite at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pace(pub(crate) [f32; 3]);

impl Pace {
    /// Of a box that is moved by `run`, mm.
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

    /// Of the rest of the world, as the box sees it.
    #[inline]
    pub(crate) fn reversed(self) -> Pace {
        let [x, y, z] = self.0;
        Pace([-x, -y, -z])
    }
}

/// A box that is translated by `run`, mm.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sweep {
    /// At the start, margin included.
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

    /// Around the way up to the fraction `until`.
    #[inline]
    pub(crate) fn cover(&self, until: f64) -> Cover {
        let [x, y, z] = self.run;
        self.start.swept([x * until, y * until, z * until])
    }

    /// The axis along which the way is longest.
    #[inline]
    pub(crate) fn axis(&self) -> usize {
        let [x, y, z] = [self.run[0].abs(), self.run[1].abs(), self.run[2].abs()];
        if z >= x && z >= y {
            2
        } else {
            usize::from(y > x)
        }
    }

    /// Whether the way runs along more than one axis: then its box holds much that is not on the way.
    #[inline]
    pub(crate) fn is_slanted(&self) -> bool {
        let moving = |axis: usize| u32::from(self.run[axis].abs() >= SLOWEST_MM);
        moving(0) + moving(1) + moving(2) > 1
    }
}
