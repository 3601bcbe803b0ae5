//! The checking space Omega over the baseplate: the broad phase of the layer-based projection model.
//!
//! Three tests follow each other, and each may end the check. All tests compare boxes that are rounded outward, so that
//! no piece gets lost:
//! 1. Does the swept mover reach into the height of Omega, and into which layers? ([`layers`])
//! 2. Which squares of the baseplate does the mover pass, and does one of them have a piece in these layers? One word
//!    per square answers ([`grid`]).
//! 3. Do the silhouettes overlap while the mover passes? Eight are tested at a time ([`silhouettes`], [`boxes`]).
//!
//! The pairs that remain go to the exact phase, which tests separating planes and the shapes themselves. Squares are
//! visited in the order of the path, so a question about the first contact can end early. Pieces are inserted and
//! removed one by one; nothing is rebuilt.

mod area;
mod around;
mod boxes;
mod codes;
mod cover;
mod eight;
mod four;
mod grid;
mod layers;
mod pool;
mod silhouettes;
mod strip;
mod sweep;
mod walk;

pub(crate) use boxes::Boxes;
pub(crate) use codes::Onset;
pub(crate) use cover::{Cover, above};
pub(crate) use four::Four;
pub(crate) use silhouettes::{Bundle, LANES};
pub(crate) use sweep::{SLOWEST_MM, Sweep};
pub(crate) use walk::Visit;

use area::Area;
use around::Around;
use grid::Grid;
use layers::{Layers, Reach};
use walk::Walk;

/// All stationary pieces, as the broad phase sees them: by their silhouettes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Space {
    layers: Layers,
    grid: Grid,
}

impl Space {
    /// Removes a piece, which was entered with `cover`, from its cells and layers.
    #[inline]
    pub(crate) fn remove(&mut self, piece: u32, cover: &Cover) {
        if let Some(reach) = self.grid.take(piece, cover) {
            self.layers.remove(reach);
        }
    }

    /// Returns the heap in use, bytes.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.grid.heap_bytes()
    }

    /// Returns the bundles with pieces that a box at rest may meet, each with a mask (bit k: lane k). The same piece
    /// may come more than once.
    #[inline(always)]
    pub(crate) fn around<'a>(&'a self, cover: &'a Cover) -> Option<Around<'a>> {
        let misses = self.layers.misses(cover.low[2], cover.high[2]);
        (!misses).then(|| Around::new(&self.grid, cover))
    }

    /// Passes to `visit`, bundle by bundle, every piece that a moving box may meet up to the fraction `until` of its
    /// path.
    #[inline]
    pub(crate) fn walk(&self, sweep: &Sweep, until: f64, visit: &mut impl Visit) {
        let cover = sweep.cover(until);
        let layers = self.layers.meeting(cover.low[2], cover.high[2]);
        if layers != 0 {
            Walk::new(&self.grid, sweep, layers, cover, visit).whole();
        }
    }
}

/// The squares in which a piece is entered.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seat {
    area: Area,
    /// True when the piece covers few enough squares to be entered in each of them.
    is_small: bool,
}

impl Seat {
    #[inline]
    fn of(cover: &Cover) -> Seat {
        let area = Area::of(cover);
        Seat {
            area,
            is_small: area.is_small(),
        }
    }
}

/// A collection into which pieces are entered by the boxes that cover them.
pub(crate) trait Entering {
    /// Enters the piece with this number, which is that of a removed piece or the next new one.
    fn enter(&mut self, piece: u32, cover: &Cover);
}

impl Entering for Space {
    #[inline(always)]
    fn enter(&mut self, piece: u32, cover: &Cover) {
        let reach = self.grid.put(piece, cover);
        self.layers.join(reach, cover.low[2], cover.high[2]);
    }
}

/// Pieces from which a space is built at once. Each step runs over all pieces before the next step begins: all steps
/// for one piece in a row would form a long chain of dependencies, which stalls the processor.
#[derive(Debug, Default)]
pub(crate) struct Filling {
    covers: Vec<Cover>,
}

impl Filling {
    /// Creates an empty collection with room for `count` pieces.
    pub(crate) fn of(count: usize) -> Filling {
        Filling {
            covers: Vec::with_capacity(count),
        }
    }

    /// Builds the space; it is equal to one into which the pieces are inserted one by one.
    pub(crate) fn space(self) -> Space {
        let seats: Vec<Seat> = self.covers.iter().map(Seat::of).collect();
        let reach = |cover: &Cover| Reach::of(cover.low[2], cover.high[2]);
        let reaches: Vec<Reach> = self.covers.iter().map(reach).collect();
        Space {
            layers: Layers::of(&reaches, &self.covers),
            grid: Grid::filled(&self.covers, &seats, &reaches),
        }
    }
}

impl Entering for Filling {
    /// Enters the next piece; pieces must come in the order of their numbers, from 0.
    #[inline]
    fn enter(&mut self, _piece: u32, cover: &Cover) {
        self.covers.push(*cover);
    }
}
