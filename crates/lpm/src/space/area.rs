//! Areas: the squares of the baseplate that a body covers.

use super::cover::Cover;
use super::four::Four;

/// Edge of a square of the grid, mm: about the distance between fixture elements; a power of two, so that dividing by
/// it is exact.
pub(crate) const PITCH_MM: f64 = 64.0;

/// The outermost column and row, 134 km out; farther places are clamped to it, because no grid reaches as far.
const FARTHEST: f32 = (1 << 21) as f32;

/// First and last column and row of a range of squares, each stored twice, to compare four numbers at once.
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

    /// Ends of the first square alone.
    pub(super) const FIRST: Ends = Ends {
        low: [0.0; 4],
        high: [0.0; 4],
    };
}

/// Number of cells by which the grid extends beyond a piece outside it.
pub(super) const GROWTH: i32 = 4;

/// Maximum number of cells in which a piece is entered; larger pieces, such as the baseplate, go into the open cell.
const MOST_CELLS_OF_A_PIECE: i64 = 128;

/// A range of columns and rows of the grid; both ends are included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Area {
    pub(crate) low: [i32; 2],
    pub(crate) high: [i32; 2],
}

impl Area {
    /// The empty area, whose last column and row come before the first.
    pub(super) const NOWHERE: Area = Area {
        low: [0; 2],
        high: [-1; 2],
    };

    /// Returns the squares that a silhouette touches.
    #[inline]
    pub(crate) fn of(cover: &Cover) -> Area {
        Area::among(cover, &Ends::FARTHEST)
    }

    /// Returns the squares that a silhouette touches, clamped to `ends`.
    #[inline(always)]
    pub(super) fn among(cover: &Cover, ends: &Ends) -> Area {
        let corners = Four::of(&cover.low).first_two(Four::of(&cover.high));
        let squares = corners.times(Four::all(1.0 / PITCH_MM as f32));
        // Selects the square with the nearest centre. A bound on a grid line may go to either side: covers are rounded
        // outward, so the covered body itself does not reach their bounds. The same holds for bounds up to 2e-6 mm
        // below 0. Every step keeps the order, so the area of a cover contains that of every cover inside it.
        let middles = squares.minus(Four::all(0.5));
        let within = middles.within(Four::of(&ends.low), Four::of(&ends.high));
        let [left, front, right, back] = within.nearest();
        Area {
            low: [left, front],
            high: [right, back],
        }
    }

    /// Returns the ends of this area, which must not be empty.
    pub(super) fn ends(&self) -> Ends {
        let twice = |[x, y]: [i32; 2]| [x as f32, y as f32, x as f32, y as f32];
        Ends {
            low: twice(self.low),
            high: twice(self.high),
        }
    }

    /// Returns the number of cells.
    pub(super) fn cells(&self) -> i64 {
        let edge = |axis: usize| i64::from(self.high[axis] - self.low[axis]) + 1;
        edge(0) * edge(1)
    }

    /// Returns true when a piece that covers this area is entered in each of its cells.
    #[inline(always)]
    pub(super) fn is_small(&self) -> bool {
        self.cells() <= MOST_CELLS_OF_A_PIECE
    }

    /// Returns true when the area has at most two by two cells.
    #[inline]
    pub(super) fn is_few(&self) -> bool {
        (self.high[0] - self.low[0] <= 1) & (self.high[1] - self.low[1] <= 1)
    }

    /// Returns a mask of the squares, of a block of two by two, that the area has. Bit 0: the first square, bit 1: the
    /// next column, bit 2: the next row, bit 3: the next column in the next row.
    #[inline(always)]
    pub(super) fn different(&self) -> u32 {
        let edge = |axis: usize| (self.high[axis] - self.low[axis]) as u32;
        let (wide, deep) = (edge(0), edge(1));
        (1 + 2 * wide).wrapping_mul(1 + 4 * deep)
    }

    /// Returns true when the area contains `other`.
    pub(super) fn holds(&self, other: &Area) -> bool {
        (0..2).all(|axis| self.low[axis] <= other.low[axis] && other.high[axis] <= self.high[axis])
    }

    /// Returns an area that contains this one and `other`, with room to grow on the sides where `other` extends beyond.
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

    /// Returns the number of columns.
    pub(super) fn columns(&self) -> i64 {
        i64::from(self.high[0]) - i64::from(self.low[0]) + 1
    }
}
