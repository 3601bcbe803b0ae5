//! Silhouettes, `B` of the paper: what each piece covers of x, y and z, eight pieces at a time.
//!
//! Bounds are kept in f32, rounded outward, member by member (`low` of x for eight pieces, ...), so
//! that eight pieces are compared with a box by a dozen instructions. An f32 costs sharpness (6e-5
//! mm at 1 m, 0.06 mm at 1 km), never safety: a rounded box holds the true one, and what overlaps
//! by rounding only is sorted out by the exact phase.

use super::layers::Reach;
use crate::lpm::vector::Vec3;

/// Pieces of one bundle: the width of two SSE registers or one AVX register.
pub(crate) const LANES: usize = 8;

/// No bundle.
pub(super) const NONE: u32 = u32::MAX;

/// More than half a unit in the last place of an f32, relative.
const ULP: f64 = 1.2e-7;
/// Below this an f32 loses digits (denormal), mm.
const TINY_MM: f64 = 1e-37;

/// An f32 that is not above `x`.
#[inline]
fn below(x: f64) -> f32 {
    (x - (x.abs() * ULP + TINY_MM)) as f32
}

/// An f32 that is not below `x`.
#[inline]
fn above(x: f64) -> f32 {
    (x + (x.abs() * ULP + TINY_MM)) as f32
}

/// A box of single precision that holds a box of double precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cover {
    pub(crate) low: [f32; 3],
    pub(crate) high: [f32; 3],
}

impl Cover {
    #[inline]
    pub(crate) fn of((low, high): (Vec3, Vec3)) -> Cover {
        Cover {
            low: low.map(below),
            high: high.map(above),
        }
    }

    /// Not above the distance of what the covers hold, mm.
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

/// Eight silhouettes and whose they are. Lanes from `count` on meet nothing.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(crate) struct Bundle {
    low: [[f32; LANES]; 3],
    high: [[f32; LANES]; 3],
    pieces: [u32; LANES],
    reaches: [Reach; LANES],
    count: u32,
    /// Next bundle of the same cell; always a full one.
    pub(super) next: u32,
}

impl Bundle {
    const EMPTY: Bundle = Bundle {
        low: [[f32::INFINITY; LANES]; 3],
        high: [[f32::NEG_INFINITY; LANES]; 3],
        pieces: [0; LANES],
        reaches: [Reach { low: 0, high: 0 }; LANES],
        count: 0,
        next: NONE,
    };

    /// An empty bundle, and the bundle that follows it in its cell.
    pub(super) fn before(next: u32) -> Bundle {
        Bundle {
            next,
            ..Bundle::EMPTY
        }
    }

    #[inline]
    pub(super) fn is_full(&self) -> bool {
        self.count as usize == LANES
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub(super) fn len(&self) -> usize {
        self.count as usize
    }

    #[inline]
    pub(super) fn push(&mut self, piece: u32, reach: Reach, cover: &Cover) {
        let lane = self.count as usize;
        self.count += 1;
        self.set(lane, piece, reach, cover);
    }

    #[inline]
    pub(super) fn pop(&mut self) -> Option<(u32, Reach, Cover)> {
        let lane = self.count.checked_sub(1)? as usize;
        let last = (self.pieces[lane], self.reaches[lane], self.cover(lane));
        let nowhere = Cover {
            low: [f32::INFINITY; 3],
            high: [f32::NEG_INFINITY; 3],
        };
        self.set(lane, 0, Reach { low: 0, high: 0 }, &nowhere);
        self.count -= 1;
        Some(last)
    }

    #[inline]
    pub(super) fn set(&mut self, lane: usize, piece: u32, reach: Reach, cover: &Cover) {
        for axis in 0..3 {
            self.low[axis][lane] = cover.low[axis];
            self.high[axis][lane] = cover.high[axis];
        }
        self.pieces[lane] = piece;
        self.reaches[lane] = reach;
    }

    #[inline]
    pub(super) fn lane_of(&self, piece: u32) -> Option<usize> {
        let used = &self.pieces[..self.count as usize];
        used.iter().position(|known| *known == piece)
    }

    /// Word of the layers of this bundle.
    #[inline]
    pub(super) fn word(&self) -> u64 {
        let used = &self.reaches[..self.count as usize];
        used.iter().fold(0, |word, reach| word | reach.word())
    }

    /// One silhouette.
    pub(crate) fn cover(&self, lane: usize) -> Cover {
        let member = |bounds: &[[f32; LANES]; 3]| [0, 1, 2].map(|axis: usize| bounds[axis][lane]);
        Cover {
            low: member(&self.low),
            high: member(&self.high),
        }
    }

    #[inline]
    pub(crate) fn piece(&self, lane: usize) -> u32 {
        self.pieces[lane]
    }

    /// Bit k: the silhouette of lane k shares a point with `cover` on every axis.
    #[inline]
    pub(crate) fn meeting(&self, cover: &Cover) -> u32 {
        #[cfg(target_arch = "x86_64")]
        // SAFETY: SSE is part of every x86-64; the call needs nothing else.
        return unsafe { self.meeting_by_four(cover) };
        #[cfg(not(target_arch = "x86_64"))]
        return self.meeting_one_by_one(cover);
    }

    /// Four lanes to an instruction.
    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "sse")]
    #[inline]
    fn meeting_by_four(&self, cover: &Cover) -> u32 {
        use std::arch::x86_64::{
            __m128, _mm_and_ps, _mm_cmple_ps, _mm_movemask_ps, _mm_set1_ps, _mm_setr_ps,
        };
        let four = |from: &[f32; LANES], at: usize| -> __m128 {
            _mm_setr_ps(from[at], from[at + 1], from[at + 2], from[at + 3])
        };
        let half = |at: usize| {
            let axis = |axis: usize| {
                let low = _mm_cmple_ps(four(&self.low[axis], at), _mm_set1_ps(cover.high[axis]));
                let high = _mm_cmple_ps(_mm_set1_ps(cover.low[axis]), four(&self.high[axis], at));
                _mm_and_ps(low, high)
            };
            _mm_movemask_ps(_mm_and_ps(axis(0), _mm_and_ps(axis(1), axis(2)))) as u32
        };
        half(0) | half(4) << 4
    }

    /// The same, lane by lane.
    #[cfg(any(test, not(target_arch = "x86_64")))]
    fn meeting_one_by_one(&self, cover: &Cover) -> u32 {
        let meets = |lane: usize, axis: usize| {
            self.low[axis][lane] <= cover.high[axis] && cover.low[axis] <= self.high[axis][lane]
        };
        (0..LANES).fold(0, |word, lane| {
            word | u32::from((0..3).all(|axis| meets(lane, axis))) << lane
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lpm::distance::tests::Dice;

    #[test]
    fn a_cover_holds_what_it_covers() {
        let mut dice = Dice(7);
        for exponent in -45..7 {
            for _ in 0..200 {
                let x = dice.signed() * 10f64.powi(exponent);
                assert!(
                    f64::from(below(x)) <= x && x <= f64::from(above(x)),
                    "{x:e}"
                );
            }
        }
        assert!(f64::from(below(0.0)) <= 0.0 && f64::from(above(-0.0)) >= 0.0);
    }

    #[test]
    fn four_lanes_at_a_time_say_what_one_by_one_says() {
        let mut dice = Dice(8);
        let drawn = |dice: &mut Dice| {
            let at = dice.vector().map(|member| (2.0 * member).round());
            let size = dice.vector().map(|member| (2.0 * member).abs().round());
            Cover {
                low: [0, 1, 2].map(|axis| (at[axis] - size[axis]) as f32),
                high: [0, 1, 2].map(|axis| (at[axis] + size[axis]) as f32),
            }
        };
        let mut met = 0;
        for _ in 0..2_000 {
            let mut bundle = Bundle::EMPTY;
            for piece in 0..5 {
                bundle.push(piece, Reach { low: 0, high: 0 }, &drawn(&mut dice));
            }
            let asked = drawn(&mut dice);
            let word = bundle.meeting(&asked);
            assert_eq!(word, bundle.meeting_one_by_one(&asked));
            assert_eq!(word >> 5, 0, "an empty lane met something");
            met += word.count_ones();
        }
        assert!(met > 500, "only {met}");
    }
}
