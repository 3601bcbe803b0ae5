//! Which squares of the baseplate something covers.

use super::cover::{Cover, larger, smaller, whole};

/// Edge of a cell, mm: about the pitch at which fixture elements stand; a power of two, so that
/// dividing by it is exact.
pub(crate) const PITCH_MM: f64 = 64.0;

/// Columns and rows beyond this, 100 km out, are one: no grid reaches there.
const FARTHEST: f32 = (1 << 21) as f32;

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
        // Rounding is monotone, so covering areas stay covering.
        let cell = |coordinate: f32| {
            let scaled = coordinate * (1.0 / PITCH_MM as f32);
            whole(smaller(larger(scaled, -FARTHEST), FARTHEST))
        };
        Area {
            low: [cell(cover.low[0]), cell(cover.low[1])],
            high: [cell(cover.high[0]), cell(cover.high[1])],
        }
    }

    /// Number of its cells.
    pub(super) fn cells(&self) -> i64 {
        let edge = |axis: usize| i64::from(self.high[axis]) - i64::from(self.low[axis]) + 1;
        edge(0) * edge(1)
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
