//! The checking space Omega over the baseplate: the broad phase of the layer-based projection model.
//!
//! Order of the questions, each an early out, all of them plain comparisons of boxes that were
//! rounded outward, so that a piece is never lost:
//! 1. Does the swept mover reach into the height of Omega, and into which layers? ([`layers`])
//! 2. Which squares of the baseplate does it pass, and is one of those layers there? One word per
//!    square answers ([`grid`]).
//! 3. Do the silhouettes overlap during the move, and when first? Intervals on x, y and z.
//!
//! What is left goes to the exact phase, whose planes are those of the oriented boxes and shapes.
//! Pieces are put in and taken out one by one; nothing is ever rebuilt.

pub(crate) mod grid;
pub(crate) mod layers;

use super::vector::Vec3;
use grid::{Area, Cell, Grid, PITCH_MM, cell_of};
use layers::Layers;

/// A piece as the broad phase knows it.
#[derive(Debug, Clone, Copy)]
struct Silhouette {
    low: Vec3,
    high: Vec3,
    layer: u8,
    in_cells: bool,
    owner: u32,
}

impl Silhouette {
    fn area(&self) -> Area {
        area(self.low, self.high)
    }
}

fn area(low: Vec3, high: Vec3) -> Area {
    Area {
        low: [cell_of(low[0]), cell_of(low[1])],
        high: [cell_of(high[0]), cell_of(high[1])],
    }
}

/// A box that is translated: `low..high` at the start (margin included), then by `displacement`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SweptBox {
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
    pub(crate) displacement: Vec3,
}

impl SweptBox {
    fn covered(&self) -> (Vec3, Vec3) {
        let mut covered = (self.low, self.high);
        for axis in 0..3 {
            covered.0[axis] += self.displacement[axis].min(0.0);
            covered.1[axis] += self.displacement[axis].max(0.0);
        }
        covered
    }

    /// Part of the move, widened by rounding, during which one axis overlaps `low..high`.
    fn during(&self, axis: usize, low: f64, high: f64) -> (f64, f64) {
        let rate = self.displacement[axis];
        let (behind, ahead) = (low - self.high[axis], high - self.low[axis]);
        if rate.abs() < 1e-9 {
            // Too slow to tell times apart: a nanometre of slack covers the whole way.
            let overlaps = behind <= 1e-9 && ahead >= -1e-9;
            return if overlaps { (0.0, 1.0) } else { (1.0, 0.0) };
        }
        let (one, two) = (behind / rate, ahead / rate);
        (one.min(two) - 1e-9, one.max(two) + 1e-9)
    }
}

/// Everything that stands, by its silhouettes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Space {
    silhouettes: Vec<Silhouette>,
    free: Vec<u32>,
    layers: Layers,
    grid: Grid,
}

/// A piece that the mover may meet, not before the fraction `entry` of the move.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    pub(crate) entry: f64,
    pub(crate) owner: u32,
    pub(crate) piece: u32,
}

impl Space {
    /// Puts a piece in and returns its number.
    pub(crate) fn insert(&mut self, low: Vec3, high: Vec3, owner: u32) -> u32 {
        let layer = self.layers.join(low[2], high[2]);
        let mut silhouette = Silhouette {
            low,
            high,
            layer,
            in_cells: true,
            owner,
        };
        let number = self.free.pop().unwrap_or(self.silhouettes.len() as u32);
        silhouette.in_cells = self.grid.put(number, layer, &silhouette.area());
        if number as usize == self.silhouettes.len() {
            self.silhouettes.push(silhouette);
        } else {
            self.silhouettes[number as usize] = silhouette;
        }
        number
    }

    /// Takes a piece out by its number.
    pub(crate) fn remove(&mut self, number: u32) {
        let gone = self.silhouettes[number as usize];
        let all = &self.silhouettes;
        self.grid
            .take(number, &gone.area(), gone.in_cells, |piece| {
                all[piece as usize].layer
            });
        self.layers.leave(gone.layer);
        self.free.push(number);
    }

    /// Every piece that the box may meet, earliest first, each once.
    pub(crate) fn candidates(&self, swept: &SweptBox, into: &mut Vec<Candidate>) {
        into.clear();
        let (low, high) = swept.covered();
        let Some((bottom, top)) = self.layers.heights() else {
            return;
        };
        if high[2] < bottom || low[2] > top {
            return;
        }
        let layers = self.layers.meeting(low[2], high[2]);
        for piece in &self.grid.open {
            self.offer(*piece, swept, into);
        }
        if let Some(area) = self.grid.common(&area(low, high)) {
            self.rows(&area, layers, swept, into);
        }
        into.sort_unstable_by(|a, b| a.entry.total_cmp(&b.entry).then(a.piece.cmp(&b.piece)));
        into.dedup_by_key(|candidate| candidate.piece);
    }

    /// Row by row along the way: only the columns the box passes while it is over the row.
    fn rows(&self, area: &Area, layers: u64, swept: &SweptBox, into: &mut Vec<Candidate>) {
        let long = area.high[0] > area.low[0] + 1 && area.high[1] > area.low[1] + 1;
        for row in area.low[1]..=area.high[1] {
            let (from, to) = if long {
                columns(row, area, swept)
            } else {
                (area.low[0], area.high[0])
            };
            if from > to {
                continue;
            }
            for Cell {
                layers: here,
                pieces,
            } in self.grid.row(row, from, to)
            {
                if here & layers != 0 {
                    pieces
                        .iter()
                        .for_each(|piece| self.offer(*piece, swept, into));
                }
            }
        }
    }

    fn offer(&self, piece: u32, swept: &SweptBox, into: &mut Vec<Candidate>) {
        let silhouette = &self.silhouettes[piece as usize];
        let (mut entry, mut exit) = (0.0_f64, 1.0_f64);
        for axis in 0..3 {
            let (first, last) = swept.during(axis, silhouette.low[axis], silhouette.high[axis]);
            entry = entry.max(first);
            exit = exit.min(last);
        }
        if entry <= exit {
            into.push(Candidate {
                entry,
                owner: silhouette.owner,
                piece,
            });
        }
    }
}

/// First and last column passed while the box is over a row, one cell of slack to either side.
fn columns(row: i64, area: &Area, swept: &SweptBox) -> (i64, i64) {
    let edge = row as f64 * PITCH_MM;
    let (first, last) = swept.during(1, edge, edge + PITCH_MM);
    let (first, last) = (first.max(0.0), last.min(1.0));
    if first > last {
        return (1, 0);
    }
    let way = swept.displacement[0];
    let left = swept.low[0] + (first * way).min(last * way);
    let right = swept.high[0] + (first * way).max(last * way);
    (
        area.low[0].max(cell_of(left) - 1),
        area.high[0].min(cell_of(right) + 1),
    )
}
