//! The grid `V` of all layers: which pieces stand over which square of the baseplate.
//!
//! A cell has one word (bit k: the cell has a piece in layer k) and a chain of bundles of silhouettes. A piece is
//! entered in every cell that its silhouette touches. Words and chains are stored separately, so that a path over empty
//! squares reads only words.

use super::Seat;
use std::ops::Range;

use super::area::{Area, Ends, GROWTH};
use super::codes::Scale;
use super::cover::Cover;
use super::layers::Reach;
use super::pool::{Cell, Chain, Pool};
use super::silhouettes::{Lane, NONE};

/// Maximum number of cells of the grid; pieces farther out go into the open cell.
const MOST_CELLS: i64 = 1 << 18;

/// Cells, one for each square, and the open cell, which holds pieces too large or too far out for squares.
#[derive(Debug, Clone)]
pub(crate) struct Grid {
    area: Area,
    /// Limits of the area that the grid covers.
    pub(super) ends: Ends,
    /// How places become the codes of silhouettes.
    pub(super) scale: Scale,
    pub(super) columns: usize,
    /// For each cell, the layers in which it has pieces (its word, see [`Cell`]); then a row and a cell of empty words,
    /// so that every cell has a next column and a next row.
    pub(super) layers: Vec<u64>,
    pub(super) heads: Vec<u32>,
    pub(super) open_layers: u64,
    pub(super) open_head: u32,
    pub(super) pool: Pool,
}

impl Default for Grid {
    fn default() -> Grid {
        Grid {
            area: Area::NOWHERE,
            ends: Ends::FIRST,
            scale: Scale::over(&Area::NOWHERE),
            columns: 0,
            layers: Vec::new(),
            heads: Vec::new(),
            open_layers: 0,
            open_head: NONE,
            pool: Pool::default(),
        }
    }
}

impl Grid {
    /// Enters a piece in every cell that its silhouette touches, or in the open cell.
    #[inline(always)]
    pub(crate) fn put(&mut self, piece: u32, cover: &Cover) -> Reach {
        let area = Area::of(cover);
        if !self.has_seat(&area) {
            return self.put_outside(piece, cover);
        }
        let lane = self.lane(piece, cover);
        let reach = lane.extent.reach();
        let word = reach.word();
        self.each_cell(&area, |pool, cell| pool.put(cell, &lane, word));
        reach
    }

    /// Returns true when a piece that covers `area` belongs in the cells of the grid as it is.
    #[inline(always)]
    fn has_seat(&self, area: &Area) -> bool {
        self.area.holds(area) && area.is_small()
    }

    /// Enters a piece that the grid does not cover: extends the grid, or enters the piece in the open cell.
    #[cold]
    #[inline(never)]
    fn put_outside(&mut self, piece: u32, cover: &Cover) -> Reach {
        let area = Area::of(cover);
        if area.is_small() && self.reach_over(&area) {
            return self.put(piece, cover);
        }
        let lane = self.lane(piece, cover);
        let reach = lane.extent.reach();
        let cell = Cell {
            layers: &mut self.open_layers,
            head: &mut self.open_head,
        };
        self.pool.put(cell, &lane, reach.word());
        reach
    }

    #[inline]
    fn lane(&self, piece: u32, cover: &Cover) -> Lane {
        let extent = self.scale.extent(cover);
        Lane { piece, extent }
    }

    /// Removes a piece and returns its layers; `None` when the grid does not have it.
    #[inline(always)]
    pub(crate) fn take(&mut self, piece: u32, cover: &Cover) -> Option<Reach> {
        let (area, mut taken) = (Area::of(cover), None);
        if self.has_seat(&area) {
            self.each_cell(&area, |pool, cell| taken = pool.take(cell, piece));
        }
        // A piece that was too far out when it was entered stays in the open cell, even if the grid has grown since.
        let [low, high] = taken.or_else(|| self.take_open(piece))?;
        Some(Reach::between(low, high))
    }

    /// Removes a piece from the open cell and returns the codes of its heights.
    #[cold]
    #[inline(never)]
    fn take_open(&mut self, piece: u32) -> Option<[i16; 2]> {
        let cell = Cell {
            layers: &mut self.open_layers,
            head: &mut self.open_head,
        };
        self.pool.take(cell, piece)
    }

    /// Passes each cell of `area`, which the grid must cover, to `change`.
    #[inline(always)]
    fn each_cell(&mut self, area: &Area, mut change: impl FnMut(&mut Pool, Cell<'_>)) {
        let [wide, deep] =
            [0, 1].map(|axis: usize| (area.high[axis] - area.low[axis]) as usize + 1);
        let mut first = number(self.area.low, self.columns, area.low);
        for _ in 0..deep {
            for place in first..first + wide {
                let (layers, head) = (&mut self.layers[place], &mut self.heads[place]);
                change(&mut self.pool, Cell { layers, head });
            }
            first += self.columns;
        }
    }

    /// Returns the part of an area that the grid covers.
    #[inline]
    pub(crate) fn common(&self, area: &Area) -> Option<Area> {
        let own = &self.area;
        let low = [area.low[0].max(own.low[0]), area.low[1].max(own.low[1])];
        let high = [area.high[0].min(own.high[0]), area.high[1].min(own.high[1])];
        (low[0] <= high[0] && low[1] <= high[1]).then_some(Area { low, high })
    }

    /// Returns the number of the cell in a column and a row, both within [`Grid::common`]; the cell in the next column
    /// has the next number.
    #[inline]
    pub(crate) fn place(&self, column: i32, row: i32) -> usize {
        number(self.area.low, self.columns, [column, row])
    }

    /// Returns the difference of cell number from one column (axis 0) or row (axis 1) to the next.
    #[inline]
    pub(crate) fn stride(&self, axis: usize) -> usize {
        [1, self.columns][axis]
    }

    /// Returns true when one of `steps` + 1 cells in a line may have a piece in one of these layers. Reads up to four
    /// cells without a branch between them; for more cells it returns true without reading any.
    #[inline]
    pub(crate) fn may_have_piece(
        &self,
        first: usize,
        stride: usize,
        steps: i32,
        layers: u64,
    ) -> bool {
        let word = |step: i32| self.layers[first + stride * step.min(steps) as usize];
        steps > 3 || steps >= 0 && (word(0) | word(1) | word(2) | word(3)) & layers != 0
    }

    /// Returns the words of the cell `place`, of the next column, of the next row, and of the next column in it; all 0
    /// when the grid has no cells.
    #[inline(always)]
    pub(super) fn words(&self, place: usize) -> [u64; 4] {
        let pair = |at: usize| self.layers.get(at..).and_then(|from| from.first_chunk());
        match (pair(place), pair(place + self.columns)) {
            (Some([a, b]), Some([c, d])) => [*a, *b, *c, *d],
            _ => [0; 4],
        }
    }

    /// Returns the bundles of a cell; `None` when it has no piece in one of these layers.
    #[inline]
    pub(crate) fn in_layers(&self, place: usize, layers: u64) -> Option<Chain<'_>> {
        let word = self.layers.get(place).copied().unwrap_or(0);
        (word & layers != 0).then(|| self.pool.chain(self.heads[place]))
    }

    /// Returns the bundles of the open cell; `None` when it has no piece in one of these layers.
    #[inline]
    pub(crate) fn open_in_layers(&self, layers: u64) -> Option<Chain<'_>> {
        (self.open_layers & layers != 0).then(|| self.pool.chain(self.open_head))
    }

    /// Returns the heap in use, bytes.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.layers.capacity() * size_of::<u64>()
            + self.heads.capacity() * size_of::<u32>()
            + self.pool.heap_bytes()
    }

    /// Extends the grid over `area`; returns false when it would need too many cells.
    fn reach_over(&mut self, area: &Area) -> bool {
        if self.area.holds(area) {
            return true;
        }
        let grown = if self.layers.is_empty() {
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
        let mut larger = Grid::over(grown);
        for row in self.area.low[1]..=self.area.high[1] {
            let (from, to) = (
                self.place(self.area.low[0], row),
                larger.place(self.area.low[0], row),
            );
            larger.layers[to..to + self.columns]
                .copy_from_slice(&self.layers[from..from + self.columns]);
            larger.heads[to..to + self.columns]
                .copy_from_slice(&self.heads[from..from + self.columns]);
        }
        (self.layers, self.heads) = (larger.layers, larger.heads);
        self.pool.convert(&self.scale, &larger.scale);
        (self.columns, self.area) = (larger.columns, larger.area);
        (self.ends, self.scale) = (larger.ends, larger.scale);
        true
    }

    /// Makes a grid of empty cells.
    fn over(area: Area) -> Grid {
        let cells = area.cells() as usize;
        Grid {
            area,
            ends: area.ends(),
            scale: Scale::over(&area),
            columns: area.columns() as usize,
            layers: vec![0; cells + area.columns() as usize + 1],
            heads: vec![NONE; cells],
            ..Grid::default()
        }
    }

    /// Makes a grid with pieces numbered from 0, equal to one that [`Grid::put`] fills piece by piece. Counts the
    /// silhouettes of each cell first, so that every cell gets all its bundles at once.
    pub(super) fn filled(covers: &[Cover], seats: &[Seat], reaches: &[Reach]) -> Grid {
        let with_squares = |(_, seat): &(&Cover, &Seat)| seat.is_small;
        let small = covers.iter().zip(seats).filter(with_squares);
        let whole = small.map(|(cover, _)| *cover).reduce(Cover::around);
        let whole = whole.map(|whole| Area::of(&whole));
        let fitting = whole.filter(|whole| whole.cells() <= MOST_CELLS);
        let mut grid = fitting.map_or_else(Grid::default, Grid::over);
        let reserved = |seat: &Seat| fitting.is_some() && seat.is_small;
        let all = seats.iter().zip(reaches);
        let mut lanes = grid.reserve(all.filter(|(seat, _)| reserved(seat)));
        for (number, (cover, seat)) in covers.iter().zip(seats).enumerate() {
            let number = number as u32;
            if reserved(seat) {
                let lane = grid.lane(number, cover);
                grid.put_reserved(&mut lanes, &lane, &seat.area);
            } else {
                grid.put(number, cover);
            }
        }
        grid
    }

    /// Reserves the bundles for the pieces of `seats` and sets the words of the cells. Returns, for each cell, the lane
    /// of its first silhouette.
    fn reserve<'a>(&mut self, seats: impl Iterator<Item = (&'a Seat, &'a Reach)>) -> Vec<u32> {
        let mut counts = vec![0u32; self.heads.len()];
        for (seat, reach) in seats {
            let word = reach.word();
            // Most pieces cover at most two by two squares, in a number that processors predict badly; so the code
            // always counts four squares, some of them by 0.
            if seat.area.is_few() {
                let (places, used) = few(self.area.low, self.columns, &seat.area);
                for (square, place) in places.into_iter().enumerate() {
                    counts[place] += used >> square & 1;
                    self.layers[place] |= word;
                }
                continue;
            }
            for place in rows(self.area.low, self.columns, &seat.area).flatten() {
                counts[place] += 1;
                self.layers[place] |= word;
            }
        }
        self.pool.reserve(&mut self.heads, &mut counts);
        counts
    }

    #[inline]
    fn put_reserved(&mut self, lanes: &mut [u32], lane: &Lane, area: &Area) {
        let pool = &mut self.pool;
        each_place(self.area.low, self.columns, area, |place| {
            let at = &mut lanes[place];
            pool.put_reserved(*at, lane);
            *at += 1;
        });
    }
}

/// Returns the number of the cell in a column and a row of a grid that begins at `low`, both of them at least `low`.
#[inline(always)]
fn number(low: [i32; 2], columns: usize, [column, row]: [i32; 2]) -> usize {
    (row - low[1]) as u32 as usize * columns + (column - low[0]) as u32 as usize
}

/// Passes the number of each cell of `area`, in a grid that begins at `low`, to `show`. Most areas have at most two by
/// two cells; these avoid nested loops, whose ends processors predict badly.
#[inline(always)]
fn each_place(low: [i32; 2], columns: usize, area: &Area, mut show: impl FnMut(usize)) {
    let [wide, deep] = [0, 1].map(|axis: usize| (area.high[axis] - area.low[axis]) as usize);
    let first = number(low, columns, area.low);
    if area.is_few() {
        show(first);
        if wide == 1 {
            show(first + 1);
        }
        if deep == 1 {
            show(first + columns);
            if wide == 1 {
                show(first + columns + 1);
            }
        }
        return;
    }
    rows(low, columns, area).for_each(|row| row.for_each(&mut show));
}

/// Returns the numbers of a block of two by two cells, in a grid that begins at `low`, and a mask of those that the
/// area has (bit k: index k); the numbers outside the area repeat others.
#[inline(always)]
fn few(low: [i32; 2], columns: usize, area: &Area) -> ([usize; 4], u32) {
    let [wide, deep] = [0, 1].map(|axis: usize| (area.high[axis] - area.low[axis]) as usize);
    let first = number(low, columns, area.low);
    let next = first + deep * columns;
    ([first, first + wide, next, next + wide], area.different())
}

/// Returns the numbers of the cells of `area` in a grid that begins at `low`, row by row.
#[inline]
fn rows(low: [i32; 2], columns: usize, area: &Area) -> impl Iterator<Item = Range<usize>> {
    let [wide, deep] = [0, 1].map(|axis: usize| (area.high[axis] - area.low[axis]) as usize + 1);
    let first = number(low, columns, area.low);
    (0..deep).map(move |row| first + row * columns..first + row * columns + wide)
}
