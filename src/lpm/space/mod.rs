//! The checking space Omega over the baseplate: the broad phase of the layer-based projection model.
//!
//! Order of the questions, each an early out, all of them plain comparisons of boxes that were
//! rounded outward, so that a piece is never lost:
//! 1. Does the swept mover reach into the height of Omega, and into which layers? ([`layers`])
//! 2. Which squares of the baseplate does it pass, and is one of those layers there? One word per
//!    square answers ([`grid`]).
//! 3. Do the silhouettes overlap, eight at a time? ([`silhouettes`])
//!
//! What is left goes to the exact phase, whose planes are those of the oriented boxes and shapes.
//! Squares are passed in the order of the way, so that a question about the first contact ends
//! where the first contact is. Pieces are put in and taken out one by one; nothing is ever rebuilt.

mod area;
mod grid;
mod layers;
mod pool;
mod silhouettes;
mod sweep;

pub(crate) use silhouettes::{Bundle, Cover, LANES};
pub(crate) use sweep::Sweep;

use super::vector::Vec3;
use area::{Area, PITCH_MM, cell_of};
use grid::Grid;
use layers::{Layers, Reach};
use pool::Chain;

/// Ways shorter than this, mm, along the axis of the bands are not followed band by band.
const SLOWEST_MM: f64 = 1e-9;

/// Everything that stands, by its silhouettes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Space {
    layers: Layers,
    grid: Grid,
}

impl Space {
    /// Takes a piece out by the bounds it came with.
    pub(crate) fn remove(&mut self, piece: u32, bounds: (Vec3, Vec3)) {
        let cover = Cover::of(bounds);
        self.layers.leave(Reach::of(cover.low[2], cover.high[2]));
        self.grid.take(piece, &cover);
    }

    /// Heap in use, bytes.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.grid.heap_bytes()
    }

    /// Shows every bundle that holds something the box may meet, with a bit for each such lane. A
    /// piece may be shown more than once.
    ///
    /// `visit` answers with the fraction of the way that still matters; below 0: nothing does.
    #[inline]
    pub(crate) fn walk(&self, sweep: &Sweep, visit: impl FnMut(&Bundle, u32) -> f64) {
        let cover = sweep.cover(1.0);
        let layers = self.layers.meeting(cover.low[2], cover.high[2]);
        let mut walk = Walk {
            grid: &self.grid,
            cover,
            layers,
            until: 1.0,
            visit,
        };
        if layers == 0 || walk.bundles(self.grid.open_in_layers(layers)) {
            return;
        }
        if let Some(area) = self.grid.common(&Area::of(&cover)) {
            walk.squares(sweep, &area);
        }
    }
}

/// Where pieces are entered by their bounds.
pub(crate) trait Entering {
    /// Enters the piece of this number.
    fn enter(&mut self, piece: u32, bounds: (Vec3, Vec3));
}

impl Entering for Space {
    fn enter(&mut self, piece: u32, bounds: (Vec3, Vec3)) {
        let cover = Cover::of(bounds);
        let reach = self.layers.join(cover.low[2], cover.high[2]);
        self.grid.put(piece, reach, &cover);
    }
}

/// A space in the making: many pieces that come at once.
#[derive(Debug, Default)]
pub(crate) struct Filling {
    layers: Layers,
    silhouettes: Vec<(Cover, Reach)>,
}

impl Filling {
    /// Room for so many pieces.
    pub(crate) fn of(count: usize) -> Filling {
        Filling {
            layers: Layers::default(),
            silhouettes: Vec::with_capacity(count),
        }
    }

    /// The space, as if each piece had been inserted.
    pub(crate) fn space(self) -> Space {
        Space {
            grid: Grid::filled(&self.silhouettes),
            layers: self.layers,
        }
    }
}

impl Entering for Filling {
    /// Pieces come in the order of their numbers, from 0.
    #[inline]
    fn enter(&mut self, _piece: u32, bounds: (Vec3, Vec3)) {
        let cover = Cover::of(bounds);
        let reach = self.layers.join(cover.low[2], cover.high[2]);
        self.silhouettes.push((cover, reach));
    }
}

struct Walk<'a, V> {
    grid: &'a Grid,
    cover: Cover,
    layers: u64,
    until: f64,
    visit: V,
}

impl<V: FnMut(&Bundle, u32) -> f64> Walk<'_, V> {
    /// True when the rest of the way does not matter.
    #[inline]
    fn bundles(&mut self, chain: Option<Chain<'_>>) -> bool {
        for bundle in chain.into_iter().flatten() {
            let meeting = bundle.meeting(&self.cover);
            if meeting != 0 {
                self.until = (self.visit)(bundle, meeting);
                if self.until < 0.0 {
                    return true;
                }
            }
        }
        false
    }

    fn squares(&mut self, sweep: &Sweep, area: &Area) {
        let [wide, high] = [0, 1].map(|axis: usize| area.high[axis] - area.low[axis]);
        if wide <= 1 && high <= 1 {
            self.few(area);
        } else if sweep.displacement[0].abs() >= sweep.displacement[1].abs() {
            self.along::<0>(sweep, area);
        } else {
            self.along::<1>(sweep, area);
        }
    }

    fn few(&mut self, area: &Area) {
        for row in area.low[1]..=area.high[1] {
            for column in area.low[0]..=area.high[0] {
                if self.bundles(self.grid.in_layers(self.grid.place(column, row), self.layers)) {
                    return;
                }
            }
        }
    }

    /// Band by band across the axis of the longer way, in its direction: of each band only the
    /// squares that the box passes while it is over the band.
    fn along<const AXIS: usize>(&mut self, sweep: &Sweep, area: &Area) {
        let across = 1 - AXIS;
        let bands = area.high[AXIS] - area.low[AXIS];
        let rate = sweep.displacement[AXIS];
        let (still, forward) = (rate.abs() < SLOWEST_MM, rate > 0.0);
        let pace = 1.0 / rate;
        for step in 0..=bands {
            let band = if forward {
                area.low[AXIS] + step
            } else {
                area.high[AXIS] - step
            };
            let (first, last) = if still {
                (0.0, 1.0)
            } else {
                let edge = f64::from(band) * PITCH_MM;
                sweep.during_by(AXIS, pace, edge, edge + PITCH_MM)
            };
            if first > self.until {
                return;
            }
            let (low, high) = sweep.between(across, first.max(0.0), last.min(self.until));
            let (from, to) = (
                cell_of(low).max(area.low[across]),
                cell_of(high).min(area.high[across]),
            );
            for square in from..=to {
                let place = if AXIS == 0 {
                    self.grid.place(band, square)
                } else {
                    self.grid.place(square, band)
                };
                if self.bundles(self.grid.in_layers(place, self.layers)) {
                    return;
                }
            }
        }
    }
}
