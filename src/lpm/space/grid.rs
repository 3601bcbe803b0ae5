//! Grid information of all layers: which pieces stand over which square of the baseplate.

/// Edge of a cell, mm: about the pitch at which fixture elements stand.
pub(crate) const PITCH_MM: f64 = 64.0;
/// Pieces over more cells than this are kept in the open list (the baseplate).
const MOST_CELLS_OF_A_PIECE: i64 = 128;
/// Largest grid, in cells; pieces farther out are kept in the open list.
const MOST_CELLS: i64 = 1 << 18;
/// Cells added around a piece that stands outside.
const GROWTH: i64 = 4;

/// Columns and rows, both ends included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Area {
    pub(crate) low: [i64; 2],
    pub(crate) high: [i64; 2],
}

impl Area {
    fn cells(&self) -> i64 {
        (self.high[0] - self.low[0] + 1).saturating_mul(self.high[1] - self.low[1] + 1)
    }

    fn holds(&self, other: &Area) -> bool {
        (0..2).all(|axis| self.low[axis] <= other.low[axis] && other.high[axis] <= self.high[axis])
    }

    fn with(&self, other: &Area) -> Area {
        let span = (self.high[0] - self.low[0]).max(self.high[1] - self.low[1]) / 4 + GROWTH;
        let grown = |axis: usize| {
            let (low, high) = (other.low[axis], other.high[axis]);
            let below = if low < self.low[axis] {
                low - span
            } else {
                self.low[axis]
            };
            let above = if high > self.high[axis] {
                high + span
            } else {
                self.high[axis]
            };
            (below, above)
        };
        let (x, y) = (grown(0), grown(1));
        Area {
            low: [x.0, y.0],
            high: [x.1, y.1],
        }
    }
}

/// Column or row of a coordinate. Rounding is monotone, so covering areas stay covering.
pub(crate) fn cell_of(coordinate: f64) -> i64 {
    (coordinate / PITCH_MM).floor() as i64
}

/// One square of the baseplate.
#[derive(Debug, Clone, Default)]
pub(crate) struct Cell {
    /// Bit k: layer k has something here.
    pub(crate) layers: u64,
    pub(crate) pieces: Vec<u32>,
}

/// The squares, and the pieces too large or too far out for them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Grid {
    area: Option<Area>,
    cells: Vec<Cell>,
    pub(crate) open: Vec<u32>,
}

impl Grid {
    /// Puts a piece over its area; false when it went to the open list.
    pub(crate) fn put(&mut self, piece: u32, layer: u8, area: &Area) -> bool {
        if area.cells() > MOST_CELLS_OF_A_PIECE || !self.cover(area) {
            self.open.push(piece);
            return false;
        }
        self.each_cell(area, |cell| {
            cell.layers |= 1 << layer;
            cell.pieces.push(piece);
        });
        true
    }

    /// Takes a piece from its area, or from the open list when it was put there.
    pub(crate) fn take(
        &mut self,
        piece: u32,
        area: &Area,
        in_cells: bool,
        layer_of: impl Fn(u32) -> u8,
    ) {
        if !in_cells {
            self.open.retain(|known| *known != piece);
            return;
        }
        self.each_cell(area, |cell| {
            cell.pieces.retain(|known| *known != piece);
            cell.layers = cell
                .pieces
                .iter()
                .fold(0, |word, known| word | 1 << layer_of(*known));
        });
    }

    /// The part of an area that has cells.
    pub(crate) fn common(&self, area: &Area) -> Option<Area> {
        let own = self.area?;
        let low = [area.low[0].max(own.low[0]), area.low[1].max(own.low[1])];
        let high = [area.high[0].min(own.high[0]), area.high[1].min(own.high[1])];
        (low[0] <= high[0] && low[1] <= high[1]).then_some(Area { low, high })
    }

    /// Cells of one row of an area found by [`Grid::common`].
    pub(crate) fn row(&self, row: i64, from: i64, to: i64) -> &[Cell] {
        let Some(own) = self.area else { return &[] };
        let start = (row - own.low[1]) * (own.high[0] - own.low[0] + 1) + from - own.low[0];
        &self.cells[start as usize..=(start + to - from) as usize]
    }

    fn each_cell(&mut self, area: &Area, mut change: impl FnMut(&mut Cell)) {
        let Some(own) = self.area else { return };
        let columns = own.high[0] - own.low[0] + 1;
        for row in area.low[1]..=area.high[1] {
            let start = (row - own.low[1]) * columns - own.low[0];
            let range = (start + area.low[0]) as usize..=(start + area.high[0]) as usize;
            self.cells[range].iter_mut().for_each(&mut change);
        }
    }

    /// Makes the grid reach over `area`; false when it would become too large.
    fn cover(&mut self, area: &Area) -> bool {
        let Some(own) = self.area else {
            let around = Area {
                low: area.low.map(|low| low - GROWTH),
                high: area.high.map(|high| high + GROWTH),
            };
            self.area = Some(around);
            self.cells = vec![Cell::default(); around.cells() as usize];
            return true;
        };
        if own.holds(area) {
            return true;
        }
        let grown = own.with(area);
        if grown.cells() > MOST_CELLS {
            return false;
        }
        let mut cells = vec![Cell::default(); grown.cells() as usize];
        let (old, new) = (
            own.high[0] - own.low[0] + 1,
            grown.high[0] - grown.low[0] + 1,
        );
        for (index, cell) in std::mem::take(&mut self.cells).into_iter().enumerate() {
            let (row, column) = (
                index as i64 / old + own.low[1],
                index as i64 % old + own.low[0],
            );
            cells[((row - grown.low[1]) * new + column - grown.low[0]) as usize] = cell;
        }
        self.cells = cells;
        self.area = Some(grown);
        true
    }
}
