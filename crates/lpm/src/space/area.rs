//! Which squares of the baseplate something covers.

use super::cover::Cover;
use super::four::Four;

/// Edge of a cell, mm: about the pitch at which fixture elements stand; a power of two, so that
/// dividing by it is exact.
pub(crate) const PITCH_MM: f64 = 64.0;

/// Columns and rows beyond this, 100 km out, are one: no grid reaches there.
const FARTHEST: f32 = (1 << 21) as f32;

/// First and last column and row, each twice, in squares.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ends {
    low: [f32; 4],
    high: [f32; 4],
}

impl Ends {
    const FARTHEST: Ends = Ends {
        low: [-FARTHEST; 4],
        high: [FARTHEST; 4],
    };

    /// Of the first square alone.
    pub(super) const FIRST: Ends = Ends {
        low: [0.0; 4],
        high: [0.0; 4],
    };
}

/// Of two by two squares those that differ, by rows and columns less one.
const DIFFERENT: [[u32; 2]; 2] = [[0b0001, 0b0011], [0b0101, 0b1111]];

/// Cells added around a piece that stands outside.
pub(super) const GROWTH: i32 = 4;

/// Columns and rows, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Area {
    pub(crate) low: [i32; 2],
    pub(crate) high: [i32; 2],
}

impl Area {
    /// Nothing lies in an area whose ends are crossed.
    pub(super) const NOWHERE: Area = Area {
        low: [0; 2],
        high: [-1; 2],
    };

    /// What a silhouette touches.
    #[inline]
    pub(crate) fn of(cover: &Cover) -> Area {
        Area::among(cover, &Ends::FARTHEST)
    }

    /// The same, but of what lies beyond some ends the nearest squares that do not.
    #[inline(always)]
    pub(super) fn among(cover: &Cover, ends: &Ends) -> Area {
        let corners = Four::of(&cover.low).first_two(Four::of(&cover.high));
        let squares = corners.times(Four::all(1.0 / PITCH_MM as f32));
        // The square whose middle is nearest. What lies on a line belongs to either side, which may be: covers are
        // rounded outward, so nothing covered lies on their bounds. (So may what lies within 2e-6 mm below 0.)
        // All of this is monotone, so covering areas stay covering.
        let middles = squares.minus(Four::all(0.5));
        let within = middles.within(Four::of(&ends.low), Four::of(&ends.high));
        let [left, front, right, back] = within.nearest();
        Area {
            low: [left, front],
            high: [right, back],
        }
    }

    /// The ends of this area, which is not empty.
    pub(super) fn ends(&self) -> Ends {
        let twice = |[x, y]: [i32; 2]| [x as f32, y as f32, x as f32, y as f32];
        Ends {
            low: twice(self.low),
            high: twice(self.high),
        }
    }

    /// Number of its cells.
    pub(super) fn cells(&self) -> i64 {
        let edge = |axis: usize| i64::from(self.high[axis]) - i64::from(self.low[axis]) + 1;
        edge(0) * edge(1)
    }

    /// Whether it is two by two cells, or fewer.
    #[inline]
    pub(super) fn is_few(&self) -> bool {
        (self.high[0] - self.low[0] <= 1) & (self.high[1] - self.low[1] <= 1)
    }

    /// Of its two by two cells those that differ: bit 0 the first, bit 1 the next column, bit 2 the next row.
    #[inline(always)]
    pub(super) fn different(&self) -> u32 {
        let [wide, deep] = [0, 1].map(|axis: usize| (self.high[axis] - self.low[axis]) as usize);
        DIFFERENT[deep % 2][wide % 2]
    }

    /// Whether `other` lies in it.
    pub(super) fn holds(&self, other: &Area) -> bool {
        (0..2).all(|axis| self.low[axis] <= other.low[axis] && other.high[axis] <= self.high[axis])
    }

    /// Both, with room to grow where `other` reaches out.
    pub(super) fn with(&self, other: &Area) -> Area {
        let span = (self.high[0] - self.low[0]).max(self.high[1] - self.low[1]) / 4 + GROWTH;
        let below = |axis: usize| {
            if other.low[axis] < self.low[axis] {
                other.low[axis] - span
            } else {
                self.low[axis]
            }
        };
        let above = |axis: usize| {
            if other.high[axis] > self.high[axis] {
                other.high[axis] + span
            } else {
                self.high[axis]
            }
        };
        Area {
            low: [below(0), below(1)],
            high: [above(0), above(1)],
        }
    }

    /// Number of its columns.
    pub(super) fn columns(&self) -> i64 {
        i64::from(self.high[0]) - i64::from(self.low[0]) + 1
    }
}
