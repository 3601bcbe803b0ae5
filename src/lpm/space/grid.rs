//! Grid information `V` of all layers: what stands over which square of the baseplate.
//!
//! A cell is one word (bit k: layer k has something here) and a chain of bundles of silhouettes. A
//! piece is entered in every cell that its silhouette touches. Bundles come from one pool, so that
//! putting in and taking out asks the allocator for nothing.

use super::silhouettes::{Bundle, Cover, NONE};

/// Edge of a cell, mm: about the pitch at which fixture elements stand; a power of two, so that
/// dividing by it is exact.
pub(crate) const PITCH_MM: f64 = 64.0;
/// Pieces over more cells than this are kept in the open cell (the baseplate).
const MOST_CELLS_OF_A_PIECE: i64 = 128;
/// Largest grid, in cells; pieces farther out are kept in the open cell.
const MOST_CELLS: i64 = 1 << 18;
/// Cells added around a piece that stands outside.
const GROWTH: i32 = 4;

/// Columns and rows, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Area {
    pub(crate) low: [i32; 2],
    pub(crate) high: [i32; 2],
}

impl Area {
    /// What a silhouette touches.
    #[inline]
    pub(crate) fn of(cover: &Cover) -> Area {
        let cell = |coordinate: f32| cell_of(f64::from(coordinate));
        Area {
            low: [cell(cover.low[0]), cell(cover.low[1])],
            high: [cell(cover.high[0]), cell(cover.high[1])],
        }
    }

    fn cells(&self) -> i64 {
        let edge = |axis: usize| i64::from(self.high[axis]) - i64::from(self.low[axis]) + 1;
        edge(0) * edge(1)
    }

    fn holds(&self, other: &Area) -> bool {
        (0..2).all(|axis| self.low[axis] <= other.low[axis] && other.high[axis] <= self.high[axis])
    }

    /// Both, with room to grow where `other` reaches out.
    fn with(&self, other: &Area) -> Area {
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

    fn columns(&self) -> i64 {
        i64::from(self.high[0]) - i64::from(self.low[0]) + 1
    }
}

/// Column or row of a coordinate. Rounding is monotone, so covering areas stay covering.
#[inline]
pub(crate) fn cell_of(coordinate: f64) -> i32 {
    let scaled = coordinate * (1.0 / PITCH_MM);
    let whole = scaled as i32;
    whole.saturating_sub(i32::from(f64::from(whole) > scaled))
}

/// One square of the baseplate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cell {
    /// Bit k: layer k has something here.
    pub(crate) layers: u64,
    /// Newest bundle; the only one that need not be full.
    head: u32,
}

impl Cell {
    const EMPTY: Cell = Cell {
        layers: 0,
        head: NONE,
    };
}

/// The squares, and one open cell for pieces too large or too far out for them.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    area: Area,
    columns: usize,
    cells: Vec<Cell>,
    open: Cell,
    pool: Pool,
}

impl Default for Grid {
    fn default() -> Grid {
        Grid {
            // Nothing lies in an area whose ends are crossed.
            area: Area {
                low: [0; 2],
                high: [-1; 2],
            },
            columns: 0,
            cells: Vec::new(),
            open: Cell::EMPTY,
            pool: Pool::default(),
        }
    }
}

/// All bundles, used and spare.
#[derive(Debug, Clone, Default)]
struct Pool {
    bundles: Vec<Bundle>,
    spare: Vec<u32>,
}

impl Grid {
    /// Enters a piece wherever its silhouette lies. True when that is the grid, false for the open cell:
    /// taking it out needs to know.
    pub(crate) fn put(&mut self, piece: u32, layer: u8, cover: &Cover) -> bool {
        let area = Area::of(cover);
        if area.cells() > MOST_CELLS_OF_A_PIECE || !self.reach_over(&area) {
            self.pool.put(&mut self.open, piece, layer, cover);
            return false;
        }
        let pool = &mut self.pool;
        each_cell(&mut self.cells, &self.area, &area, |cell| {
            pool.put(cell, piece, layer, cover);
        });
        true
    }

    /// Takes a piece out again.
    pub(crate) fn take(&mut self, piece: u32, cover: &Cover, gridded: bool) {
        let pool = &mut self.pool;
        if gridded {
            each_cell(&mut self.cells, &self.area, &Area::of(cover), |cell| {
                pool.take(cell, piece);
            });
        } else {
            pool.take(&mut self.open, piece);
        }
    }

    /// The part of an area that has cells.
    #[inline]
    pub(crate) fn common(&self, area: &Area) -> Option<Area> {
        let own = &self.area;
        let low = [area.low[0].max(own.low[0]), area.low[1].max(own.low[1])];
        let high = [area.high[0].min(own.high[0]), area.high[1].min(own.high[1])];
        (low[0] <= high[0] && low[1] <= high[1]).then_some(Area { low, high })
    }

    /// The cell of a column and a row that [`Grid::common`] found.
    #[inline]
    pub(crate) fn cell(&self, column: i32, row: i32) -> &Cell {
        let place =
            (row - self.area.low[1]) as usize * self.columns + (column - self.area.low[0]) as usize;
        &self.cells[place]
    }

    /// The cell of what has no square.
    pub(crate) fn open(&self) -> &Cell {
        &self.open
    }

    /// The bundles of a cell.
    #[inline]
    pub(crate) fn bundles(&self, cell: &Cell) -> Chain<'_> {
        Chain {
            bundles: &self.pool.bundles,
            next: cell.head,
        }
    }

    /// Heap in use, bytes.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.cells.capacity() * size_of::<Cell>()
            + self.pool.bundles.capacity() * size_of::<Bundle>()
            + self.pool.spare.capacity() * size_of::<u32>()
    }

    /// Makes the grid reach over `area`; false when it would become too large.
    fn reach_over(&mut self, area: &Area) -> bool {
        if self.area.holds(area) {
            return true;
        }
        let grown = if self.cells.is_empty() {
            Area {
                low: area.low.map(|low| low - GROWTH),
                high: area.high.map(|high| high + GROWTH),
            }
        } else {
            self.area.with(area)
        };
        if grown.cells() > MOST_CELLS {
            return false;
        }
        let mut cells = vec![Cell::EMPTY; grown.cells() as usize];
        let columns = grown.columns() as usize;
        if self.columns > 0 {
            let first = (self.area.low[1] - grown.low[1]) as usize * columns
                + (self.area.low[0] - grown.low[0]) as usize;
            for (row, old) in self.cells.chunks(self.columns).enumerate() {
                cells[first + row * columns..][..old.len()].copy_from_slice(old);
            }
        }
        (self.cells, self.columns, self.area) = (cells, columns, grown);
        true
    }
}

fn each_cell(cells: &mut [Cell], own: &Area, area: &Area, mut change: impl FnMut(&mut Cell)) {
    let columns = own.columns();
    for row in area.low[1]..=area.high[1] {
        let start = i64::from(row - own.low[1]) * columns - i64::from(own.low[0]);
        let range =
            (start + i64::from(area.low[0])) as usize..=(start + i64::from(area.high[0])) as usize;
        cells[range].iter_mut().for_each(&mut change);
    }
}

impl Pool {
    fn put(&mut self, cell: &mut Cell, piece: u32, layer: u8, cover: &Cover) {
        let full = self
            .bundles
            .get(cell.head as usize)
            .is_none_or(Bundle::is_full);
        if full {
            let fresh = self.spare.pop().unwrap_or_else(|| {
                self.bundles.push(Bundle::EMPTY);
                (self.bundles.len() - 1) as u32
            });
            self.bundles[fresh as usize].next = cell.head;
            cell.head = fresh;
        }
        self.bundles[cell.head as usize].push(piece, layer, cover);
        cell.layers |= 1 << layer;
    }

    /// The last piece of the newest bundle fills the gap.
    fn take(&mut self, cell: &mut Cell, piece: u32) {
        let mut at = cell.head;
        while at != NONE {
            if let Some(lane) = self.bundles[at as usize].lane_of(piece) {
                self.fill(cell.head, at, lane);
                break;
            }
            at = self.bundles[at as usize].next;
        }
        let head = &self.bundles[cell.head as usize];
        if head.is_empty() {
            self.spare.push(cell.head);
            cell.head = head.next;
        }
        cell.layers = 0;
        let mut at = cell.head;
        while at != NONE {
            let bundle = &self.bundles[at as usize];
            cell.layers |= bundle.word();
            at = bundle.next;
        }
    }

    fn fill(&mut self, head: u32, at: u32, lane: usize) {
        let Some((last, layer, cover)) = self.bundles[head as usize].pop() else {
            return;
        };
        let bundle = &mut self.bundles[at as usize];
        if lane < bundle.len() {
            bundle.set(lane, last, layer, &cover);
        }
    }
}

/// The bundles of one cell, newest first.
pub(crate) struct Chain<'a> {
    bundles: &'a [Bundle],
    next: u32,
}

impl<'a> Iterator for Chain<'a> {
    type Item = &'a Bundle;

    #[inline]
    fn next(&mut self) -> Option<&'a Bundle> {
        let bundle = self.bundles.get(self.next as usize)?;
        self.next = bundle.next;
        Some(bundle)
    }
}
