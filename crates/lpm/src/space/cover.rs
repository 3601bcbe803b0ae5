//! Boxes in single precision, each of which encloses a box in double precision.

use super::four::Four;
use crate::vector::Vec3;

/// Two units in the last place of an f32, relative: more than rounding to nearest and one further step can lose.
const ULP: f32 = 2.0 * f32::EPSILON;

/// Relative rounding bound: four units in the last place.
const SINGLE: f32 = 4.0 * f32::EPSILON;
/// Least normal number, mm, below which an f32 loses digits.
const TINY: f32 = f32::MIN_POSITIVE;

/// Returns an f32 that is larger than `x`.
#[inline]
pub(crate) fn above(x: f64) -> f32 {
    let nearest = x as f32;
    nearest + (nearest.abs() * ULP + TINY)
}

/// Returns the smaller number; `b` when one of them is NaN.
#[inline]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Returns the larger number; `b` when one of them is NaN.
#[inline]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// A box in single precision that encloses a box in double precision. The fourth members are 0: four numbers fill one
/// register.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(16))]
pub(crate) struct Cover {
    pub(crate) low: [f32; 4],
    pub(crate) high: [f32; 4],
}

impl Cover {
    #[inline]
    pub(crate) fn of((low, high): (Vec3, Vec3)) -> Cover {
        let (low, high) = (Four::rounded(&low), Four::rounded(&high));
        let outward = |nearest: Four| {
            let step = nearest.abs().times(Four::all(ULP));
            step.plus(Four::all(TINY))
        };
        Cover {
            low: low.minus(outward(low)).numbers(),
            high: high.plus(outward(high)).numbers(),
        }
    }

    /// Returns a box around the path of this box when it moves by `run`, mm.
    #[inline]
    pub(crate) fn swept(&self, run: Vec3) -> Cover {
        let (low, high) = (Four::of(&self.low), Four::of(&self.high));
        let (way, rest) = (Four::rounded(&run), Four::all(0.0));
        // The slack is twice the rounding of the sum and of the path.
        let slack = |bound: Four| {
            let magnitude = bound.abs().plus(way.abs());
            magnitude.times(Four::all(SINGLE)).plus(Four::all(TINY))
        };
        Cover {
            low: low.plus(way.smaller(rest)).minus(slack(low)).numbers(),
            high: high.plus(way.larger(rest)).plus(slack(high)).numbers(),
        }
    }

    /// Returns a box that encloses this box moved by `run`, mm.
    #[inline]
    pub(crate) fn swept_to(&self, run: Vec3) -> Cover {
        let (low, high) = (Four::of(&self.low), Four::of(&self.high));
        let way = Four::rounded(&run);
        let slack = |bound: Four| {
            let magnitude = bound.abs().plus(way.abs());
            magnitude.times(Four::all(SINGLE)).plus(Four::all(TINY))
        };
        Cover {
            low: low.plus(way).minus(slack(low)).numbers(),
            high: high.plus(way).plus(slack(high)).numbers(),
        }
    }

    /// Returns the smallest box that encloses both boxes.
    #[inline]
    pub(crate) fn around(self, other: Cover) -> Cover {
        Cover {
            low: Four::of(&self.low).smaller(Four::of(&other.low)).numbers(),
            high: Four::of(&self.high).larger(Four::of(&other.high)).numbers(),
        }
    }

    /// Returns a lower bound of the distance between the enclosed bodies, mm.
    pub(crate) fn distance(&self, other: &Cover) -> f64 {
        let squared = (0..3).fold(0.0, |sum, axis| {
            let beyond = f64::from(other.low[axis]) - f64::from(self.high[axis]);
            let behind = f64::from(self.low[axis]) - f64::from(other.high[axis]);
            let apart = beyond.max(behind).max(0.0);
            sum + apart * apart
        });
        squared.sqrt() * (1.0 - 8.0 * f64::EPSILON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::tests::Dice;

    #[test]
    fn a_cover_holds_what_it_covers() {
        let mut dice = Dice::new(7);
        for exponent in -45..7 {
            for _ in 0..200 {
                let at = dice.vector().map(|member| member * 10f64.powi(exponent));
                let cover = Cover::of((at, at));
                for (axis, x) in at.into_iter().enumerate() {
                    let (low, high) = (f64::from(cover.low[axis]), f64::from(cover.high[axis]));
                    assert!(low < x && x < high && x < f64::from(above(x)), "{x:e}");
                }
            }
        }
        let origin = Cover::of(([0.0; 3], [-0.0; 3]));
        assert!(origin.low[0] < 0.0 && origin.high[0] > 0.0);
    }

    #[test]
    fn the_cover_of_a_way_holds_its_end() {
        let mut dice = Dice::new(11);
        for exponent in -12..6 {
            for _ in 0..200 {
                let at = dice.vector().map(|member| member * 1e3);
                let run = dice.vector().map(|member| member * 10f64.powi(exponent));
                let start = Cover::of((at, at));
                let swept = start.swept(run);
                for axis in 0..3 {
                    let end = [start.low, start.high].map(|it| f64::from(it[axis]) + run[axis]);
                    assert!(f64::from(swept.low[axis]) <= end[0].min(f64::from(start.low[axis])));
                    assert!(f64::from(swept.high[axis]) >= end[1].max(f64::from(start.high[axis])));
                }
            }
        }
    }
}
