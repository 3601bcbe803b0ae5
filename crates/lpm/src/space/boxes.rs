//! Boxes in single precision, stored axis by axis (`low` of x of every box, then of y, ...), so that one instruction
//! compares four of them.
//!
//! Bounds are always rounded outward. Single precision makes boxes larger (by 6e-5 mm at 1 m, 0.06 mm at 1 km) but
//! never unsafe: a rounded box contains the true one, and the exact phase removes pairs that overlap only by rounding.

use super::cover::Cover;
use super::four::Four;
use super::sweep::Pace;

/// `N` boxes; `N` is a multiple of four.
#[derive(Debug, Clone, Copy)]
#[repr(align(16))]
pub(crate) struct Boxes<const N: usize> {
    pub(crate) low: [[f32; N]; 3],
    pub(crate) high: [[f32; N]; 3],
}

/// Which boxes a moving box meets (bit k: lane k), and the earliest fraction of the path at which it can meet each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossing<const N: usize> {
    pub(crate) lanes: u32,
    /// Fraction of the path before which the moving box does not meet this box, never later than the true one; valid
    /// only for lanes in the mask.
    pub(crate) entry: [f32; N],
}

/// Factor that decreases a fraction of the path by more than its four roundings.
const EARLIER: f32 = 1.0 - 8.0 * f32::EPSILON;
const LATER: f32 = 1.0 + 8.0 * f32::EPSILON;

impl<const N: usize> Boxes<N> {
    /// Boxes at infinity, which meet no box on any path.
    pub(crate) const NOWHERE: Boxes<N> = Boxes {
        low: [[f32::INFINITY; N]; 3],
        high: [[f32::INFINITY; N]; 3],
    };

    #[cfg(test)]
    pub(crate) fn set(&mut self, lane: usize, cover: &Cover) {
        for axis in 0..3 {
            self.low[axis][lane] = cover.low[axis];
            self.high[axis][lane] = cover.high[axis];
        }
    }

    /// Returns the box of one lane.
    #[inline]
    pub(crate) fn cover(&self, lane: usize) -> Cover {
        let member = |[x, y, z]: &[[f32; N]; 3]| [x[lane], y[lane], z[lane], 0.0];
        Cover {
            low: member(&self.low),
            high: member(&self.high),
        }
    }

    /// Returns a mask in which bit k is set when box k shares a point with `cover`.
    #[inline]
    pub(crate) fn meeting(&self, cover: &Cover) -> u32 {
        let (low, high) = (cover.low.map(Four::all), cover.high.map(Four::all));
        (0..N / 4).fold(0, |lanes, four| {
            let pair = |axis: usize| {
                let [own_low, own_high] =
                    [&self.low[axis], &self.high[axis]].map(|it| Four::of(&it.as_chunks().0[four]));
                [(own_low, high[axis]), (low[axis], own_high)]
            };
            let ([a, b], [c, d], [e, f]) = (pair(0), pair(1), pair(2));
            lanes | Four::all_at_most([a, b, c, d, e, f]) << (4 * four)
        })
    }

    /// Returns the boxes that a box, which starts as `cover`, meets on its path up to the fraction `until`. The answer
    /// is the same when the boxes move the opposite way and `cover` is at rest.
    #[inline(always)]
    pub(crate) fn crossing(&self, cover: &Cover, pace: &Pace, until: f32) -> Crossing<N> {
        let mut crossing = Crossing {
            lanes: 0,
            entry: [0.0; N],
        };
        for (four, entries) in crossing.entry.as_chunks_mut().0.iter_mut().enumerate() {
            let (mut entry, mut exit) = (Four::all(0.0), Four::all(until));
            for axis in 0..3 {
                let (near, far) = self.ends(four, cover, pace, axis);
                entry = near.smaller(far).larger(entry);
                exit = near.larger(far).smaller(exit);
            }
            let entry = entry.times(Four::all(EARLIER));
            let exit = exit.times(Four::all(LATER));
            crossing.lanes |= entry.at_most(exit) << (4 * four);
            *entries = entry.numbers();
        }
        crossing
    }

    /// Returns, for four boxes, the fractions of the path at which `cover` reaches one side and has left the other.
    #[inline(always)]
    fn ends(&self, four: usize, cover: &Cover, pace: &Pace, axis: usize) -> (Four, Four) {
        let pace = Four::all(pace.0[axis]);
        let [low, high] = [&self.low, &self.high].map(|it| Four::of(&it[axis].as_chunks().0[four]));
        let near = low.minus(Four::all(cover.high[axis])).times(pace);
        (near, high.minus(Four::all(cover.low[axis])).times(pace))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::tests::Dice;

    fn three([x, y, z, _]: [f32; 4]) -> [f64; 3] {
        [x, y, z].map(f64::from)
    }

    fn four([x, y, z]: [f32; 3]) -> [f32; 4] {
        [x, y, z, 0.0]
    }

    fn drawn(dice: &mut Dice) -> Cover {
        let at = dice.vector().map(|member| (3.0 * member).round());
        let size = dice.vector().map(|member| (2.0 * member).abs().round());
        Cover {
            low: four([0, 1, 2].map(|axis| (at[axis] - size[axis]) as f32)),
            high: four([0, 1, 2].map(|axis| (at[axis] + size[axis]) as f32)),
        }
    }

    #[test]
    fn boxes_meet_exactly_when_they_share_a_point() {
        let mut dice = Dice::new(9);
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
        let mut dice = Dice::new(10);
        let (mut met, mut missed) = (0, 0);
        for _ in 0..2_000 {
            let (element, mover) = (drawn(&mut dice), drawn(&mut dice));
            let mut run = dice.vector().map(|member| (4.0 * member).round());
            if dice.pick(3) == 0 {
                (run[0], run[1]) = (0.0, 0.0);
            }
            let mut boxes = Boxes::<4>::NOWHERE;
            // The box of the element becomes slightly larger, because it is rounded outward.
            boxes.set(1, &Cover::of((three(element.low), three(element.high))));
            let crossing = boxes.crossing(&mover, &Pace::of(run), 1.0);
            let at = |t: f64| {
                let moved = |bound: [f32; 4]| {
                    four([0, 1, 2].map(|axis| (f64::from(bound[axis]) + t * run[axis]) as f32))
                };
                let (low, high) = (moved(mover.low), moved(mover.high));
                element.distance(&Cover { low, high }) == 0.0
            };
            // Boxes and runs are whole numbers, so the first touch is at a multiple of an eighth of the path.
            let first = (0..=8)
                .map(|eighth| f64::from(eighth) / 8.0)
                .find(|t| at(*t));
            if let Some(first) = first {
                assert_eq!(crossing.lanes, 2, "{element:?} {mover:?} {run:?}");
                assert!(f64::from(crossing.entry[1]) <= first);
                met += 1;
            } else {
                missed += u32::from(crossing.lanes == 0);
            }
        }
        assert!(met > 300 && missed > 300, "{met} {missed}");
    }
}
