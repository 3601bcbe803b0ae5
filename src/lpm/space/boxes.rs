//! Boxes in single precision, member by member (`low` of x of every box, ...), so that four of them
//! are compared by one instruction.
//!
//! Bounds are rounded outward, strictly. An f32 costs sharpness (6e-5 mm at 1 m, 0.06 mm at 1 km),
//! never safety: a rounded box holds the true one, and what overlaps by rounding only is sorted out by
//! the exact phase.

use super::cover::{Cover, larger, smaller};
use super::sweep::Pace;

/// `N` boxes, a multiple of four.
#[derive(Debug, Clone, Copy)]
#[repr(align(16))]
pub(crate) struct Boxes<const N: usize> {
    pub(crate) low: [[f32; N]; 3],
    pub(crate) high: [[f32; N]; 3],
}

/// Which boxes a box on its way meets (bit k: lane k), and not before which fraction of the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing<const N: usize> {
    pub(crate) lanes: u32,
    /// Not after the true fraction; only of lanes that are met.
    pub(crate) entry: [f32; N],
}

/// Factors that outweigh the four roundings of a fraction of the way.
const EARLIER: f32 = 1.0 - 8.0 * f32::EPSILON;
const LATER: f32 = 1.0 + 8.0 * f32::EPSILON;

impl<const N: usize> Boxes<N> {
    /// Points at infinity: they meet nothing, wherever it goes.
    pub(crate) const NOWHERE: Boxes<N> = Boxes {
        low: [[f32::INFINITY; N]; 3],
        high: [[f32::INFINITY; N]; 3],
    };

    #[inline]
    pub(crate) fn set(&mut self, lane: usize, cover: &Cover) {
        for axis in 0..3 {
            self.low[axis][lane] = cover.low[axis];
            self.high[axis][lane] = cover.high[axis];
        }
    }

    /// One of them.
    #[inline]
    pub(crate) fn cover(&self, lane: usize) -> Cover {
        let member = |[x, y, z]: &[[f32; N]; 3]| [x[lane], y[lane], z[lane]];
        Cover {
            low: member(&self.low),
            high: member(&self.high),
        }
    }

    /// Bit k: box k shares a point with `cover` on every axis.
    #[inline]
    pub(crate) fn meeting(&self, cover: &Cover) -> u32 {
        let beside = |axis: usize| {
            at_most(&self.low[axis], &[cover.high[axis]; N])
                & at_most(&[cover.low[axis]; N], &self.high[axis])
        };
        beside(0) & beside(1) & beside(2)
    }

    /// Before which fraction of the way each box is not met, on a way along one axis.
    #[inline]
    pub(crate) fn entry(&self, cover: &Cover, pace: &Pace, axis: usize) -> [f32; N] {
        let (low, high, pace) = (cover.low[axis], cover.high[axis], pace.0[axis]);
        std::array::from_fn(|lane| {
            let near = (self.low[axis][lane] - high) * pace;
            let far = (self.high[axis][lane] - low) * pace;
            larger(smaller(near, far), 0.0) * EARLIER
        })
    }

    /// The boxes that a box, starting as `cover`, meets on its way up to the fraction `until`. The
    /// same holds when the boxes go the other way and `cover` stands.
    #[inline(always)]
    pub(crate) fn crossing(&self, cover: &Cover, pace: &Pace, until: f32) -> Crossing<N> {
        let (mut entry, mut exit) = ([0.0; N], [until; N]);
        for axis in 0..3 {
            let (low, high) = (cover.low[axis], cover.high[axis]);
            for lane in 0..N {
                let near = (self.low[axis][lane] - high) * pace.0[axis];
                let far = (self.high[axis][lane] - low) * pace.0[axis];
                entry[lane] = larger(smaller(near, far), entry[lane]);
                exit[lane] = smaller(larger(near, far), exit[lane]);
            }
        }
        for lane in 0..N {
            entry[lane] *= EARLIER;
            exit[lane] *= LATER;
        }
        Crossing {
            lanes: at_most(&entry, &exit),
            entry,
        }
    }
}

/// Bit k: `a[k] <= b[k]`.
#[inline]
fn at_most<const N: usize>(a: &[f32; N], b: &[f32; N]) -> u32 {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: SSE is part of every x86-64; the call needs nothing else.
    return unsafe { at_most_by_four(a, b) };
    #[cfg(not(target_arch = "x86_64"))]
    return at_most_one_by_one(a, b);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "sse")]
#[inline]
fn at_most_by_four<const N: usize>(a: &[f32; N], b: &[f32; N]) -> u32 {
    use std::arch::x86_64::{_mm_cmple_ps, _mm_loadu_ps, _mm_movemask_ps};
    let fours = a.as_chunks::<4>().0.iter().zip(b.as_chunks::<4>().0);
    fours.enumerate().fold(0, |word, (at, (a, b))| {
        // SAFETY: each chunk is four numbers that may be read, wherever they stand.
        let (a, b) = unsafe { (_mm_loadu_ps(a.as_ptr()), _mm_loadu_ps(b.as_ptr())) };
        word | (_mm_movemask_ps(_mm_cmple_ps(a, b)) as u32) << (4 * at)
    })
}

/// The same, lane by lane.
#[cfg(any(test, not(target_arch = "x86_64")))]
fn at_most_one_by_one<const N: usize>(a: &[f32; N], b: &[f32; N]) -> u32 {
    (0..N).fold(0, |word, lane| word | u32::from(a[lane] <= b[lane]) << lane)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lpm::distance::tests::Dice;

    #[test]
    fn four_lanes_at_a_time_say_what_one_by_one_says() {
        let mut dice = Dice(8);
        for _ in 0..2_000 {
            let mut drawn = || {
                [0; 8].map(|_| match dice.pick(5) {
                    0 => f32::NAN,
                    1 => f32::INFINITY,
                    _ => (3.0 * dice.signed()).round() as f32,
                })
            };
            let (a, b) = (drawn(), drawn());
            assert_eq!(at_most(&a, &b), at_most_one_by_one(&a, &b), "{a:?} {b:?}");
        }
    }

    fn drawn(dice: &mut Dice) -> Cover {
        let at = dice.vector().map(|member| (3.0 * member).round());
        let size = dice.vector().map(|member| (2.0 * member).abs().round());
        Cover {
            low: [0, 1, 2].map(|axis| (at[axis] - size[axis]) as f32),
            high: [0, 1, 2].map(|axis| (at[axis] + size[axis]) as f32),
        }
    }

    #[test]
    fn whoever_shares_a_point_is_met_and_nobody_else() {
        let mut dice = Dice(9);
        let mut met = 0;
        for _ in 0..2_000 {
            let (mut boxes, asked) = (Boxes::<8>::NOWHERE, drawn(&mut dice));
            let stand: Vec<Cover> = (0..5).map(|_| drawn(&mut dice)).collect();
            for (lane, cover) in stand.iter().enumerate() {
                boxes.set(lane, cover);
            }
            for lane in 0..8 {
                let shares = stand.get(lane).is_some_and(|it| it.distance(&asked) == 0.0);
                assert_eq!(boxes.meeting(&asked) >> lane & 1 == 1, shares);
                met += u32::from(shares);
            }
        }
        assert!(met > 500, "only {met}");
    }

    #[test]
    fn a_crossing_begins_no_later_than_the_boxes_meet() {
        let mut dice = Dice(10);
        let (mut met, mut missed, mut alone) = (0, 0, 0);
        for _ in 0..2_000 {
            let (element, mover) = (drawn(&mut dice), drawn(&mut dice));
            let mut run = dice.vector().map(|member| (4.0 * member).round());
            if dice.pick(3) == 0 {
                (run[0], run[1]) = (0.0, 0.0);
            }
            let mut boxes = Boxes::<4>::NOWHERE;
            // A hair larger, as rounding outward leaves them.
            boxes.set(
                1,
                &Cover::of((element.low.map(f64::from), element.high.map(f64::from))),
            );
            let crossing = boxes.crossing(&mover, &Pace::of(run), 1.0);
            let at = |t: f64| {
                let moved = |bound: [f32; 3]| {
                    [0, 1, 2].map(|axis| (f64::from(bound[axis]) + t * run[axis]) as f32)
                };
                let (low, high) = (moved(mover.low), moved(mover.high));
                element.distance(&Cover { low, high }) == 0.0
            };
            // Eighths hold the first contact of whole numbers with runs of 1, 2 and 4.
            let first = (0..=8)
                .map(|eighth| f64::from(eighth) / 8.0)
                .find(|t| at(*t));
            if let Some(first) = first {
                assert_eq!(crossing.lanes, 2, "{element:?} {mover:?} {run:?}");
                assert!(f64::from(crossing.entry[1]) <= first);
                let moving: Vec<usize> = (0..3).filter(|axis| run[*axis] != 0.0).collect();
                if let [axis] = moving[..] {
                    let entry = boxes.entry(&mover, &Pace::of(run), axis);
                    assert_eq!(entry[1], crossing.entry[1]);
                    alone += 1;
                }
                met += 1;
            } else {
                missed += u32::from(crossing.lanes == 0);
            }
        }
        assert!(met > 300 && missed > 300, "{met} {missed}");
        assert!(alone > 50, "{alone}");
    }
}
