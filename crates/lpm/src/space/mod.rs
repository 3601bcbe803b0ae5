//! The checking space Omega over the baseplate: the broad phase of the layer-based projection model.
//!
//! Order of the questions, each an early out, all of them plain comparisons of boxes that were
//! rounded outward, so that a piece is never lost:
//! 1. Does the swept mover reach into the height of Omega, and into which layers? ([`layers`])
//! 2. Which squares of the baseplate does it pass, and is one of those layers there? One word per
//!    square answers ([`grid`]).
//! 3. Do the silhouettes overlap, and while the mover passes? Eight at a time. ([`silhouettes`], [`boxes`])
//!
//! What is left goes to the exact phase, whose planes are those of the oriented boxes and shapes.
//! Squares are passed in the order of the way, so that a question about the first contact ends
//! where the first contact is. Pieces are put in and taken out one by one; nothing is ever rebuilt.

mod area;
mod around;
mod boxes;
mod cover;
mod four;
mod grid;
mod layers;
mod pool;
mod silhouettes;
mod strip;
mod sweep;
mod walk;

pub(crate) use boxes::Boxes;
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

/// Pieces over more cells than this are kept in the open cell (the baseplate).
const MOST_CELLS_OF_A_PIECE: i64 = 128;

/// Everything that stands, by its silhouettes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Space {
    layers: Layers,
    grid: Grid,
    /// Where each piece is, by its number.
    seats: Vec<Seat>,
}

impl Space {
    /// Takes a piece out of where it was entered.
    #[inline]
    pub(crate) fn remove(&mut self, piece: u32) {
        let seat = &self.seats[piece as usize];
        self.layers.leave(seat.reach);
        self.grid.take(piece, seat);
    }

    /// Heap in use, bytes.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.grid.heap_bytes() + self.seats.capacity() * size_of::<Seat>()
    }

    /// The bundles with what a box at rest may meet: bit k: lane k. A piece may come more than once.
    #[inline(always)]
    pub(crate) fn around<'a>(&'a self, cover: &'a Cover) -> Option<Around<'a>> {
        let layers = self.layers.between(cover.low[2], cover.high[2]);
        (layers != 0).then(|| Around::new(&self.grid, cover, layers))
    }

    /// A bundle that was shown, by its number.
    #[inline]
    pub(crate) fn bundle(&self, number: u32) -> &Bundle {
        self.grid.bundle(number)
    }

    /// Shows whatever a box on its way may meet up to the fraction `until`, bundle by bundle.
    #[inline]
    pub(crate) fn walk(&self, sweep: &Sweep, until: f64, visit: &mut impl Visit) {
        let cover = sweep.cover(until);
        let layers = self.layers.meeting(cover.low[2], cover.high[2]);
        if layers != 0 {
            Walk::new(&self.grid, sweep, layers, cover, visit).whole();
        }
    }
}

/// Where a piece is entered: squares and layers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seat {
    area: Area,
    reach: Reach,
    /// Few enough squares to be entered in each.
    is_small: bool,
}

impl Seat {
    #[inline]
    fn of(cover: &Cover) -> Seat {
        let area = Area::of(cover);
        Seat {
            area,
            reach: Reach::of(cover.low[2], cover.high[2]),
            is_small: area.cells() <= MOST_CELLS_OF_A_PIECE,
        }
    }
}

/// Where pieces are entered by their covers.
pub(crate) trait Entering {
    /// Enters the piece of this number, which is that of one that was taken out or the next new one.
    fn enter(&mut self, piece: u32, cover: &Cover);
}

impl Entering for Space {
    #[inline]
    fn enter(&mut self, piece: u32, cover: &Cover) {
        let seat = Seat::of(cover);
        self.layers.join(seat.reach, cover.low[2], cover.high[2]);
        self.grid.put(piece, cover, &seat);
        match self.seats.get_mut(piece as usize) {
            Some(known) => *known = seat,
            None => self.seats.push(seat),
        }
    }
}

/// A space in the making: many pieces that come at once, and are seated when all are known. (Each step for all
/// pieces before the next: one piece through all steps is one long chain that a processor has to wait for.)
#[derive(Debug, Default)]
pub(crate) struct Filling {
    covers: Vec<Cover>,
}

impl Filling {
    /// Room for so many pieces.
    pub(crate) fn of(count: usize) -> Filling {
        Filling {
            covers: Vec::with_capacity(count),
        }
    }

    /// The space, as if each piece had been inserted.
    pub(crate) fn space(self) -> Space {
        let seats: Vec<Seat> = self.covers.iter().map(Seat::of).collect();
        Space {
            layers: Layers::of(&seats, &self.covers),
            grid: Grid::filled(&self.covers, &seats),
            seats,
        }
    }
}

impl Entering for Filling {
    /// Pieces come in the order of their numbers, from 0.
    #[inline]
    fn enter(&mut self, _piece: u32, cover: &Cover) {
        self.covers.push(*cover);
    }
}
