//! The pieces of the stationary elements in one block of memory, reduced to the numbers that questions read.
//!
//! An upright piece is stored as its [`Prism`], which describes it completely. A tilted piece or a triangle needs a
//! whole [`Piece`], which is stored separately.

use super::answer::ElementKey;
use super::piece::{Piece, each_piece};
use super::pose::{Frame, Pose};
use super::prism::Prism;
use super::shape::Shape;
use super::space::{Cover, Entering};

/// Number that means no piece.
pub(crate) const NONE: u32 = u32::MAX;

/// A placed stationary piece, in two cache lines.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Stationary {
    /// Least and greatest corner of the box around the piece, mm.
    corners: [[f32; 3]; 2],
    pub(crate) form: Stored,
    /// The element to which the piece belongs.
    pub(crate) owner: ElementKey,
    /// Number of another piece of the same element, or [`NONE`].
    pub(crate) sibling: u32,
}

const _: () = assert!(size_of::<Stationary>() == 128, "two cache lines");

impl Stationary {
    /// Returns the box around the piece.
    #[inline(always)]
    pub(crate) fn cover(&self) -> Cover {
        let [low, high] = self.corners.map(|[x, y, z]| [x, y, z, 0.0]);
        Cover { low, high }
    }
}

/// How a piece is stored.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Stored {
    /// Upright piece: closed forms apply.
    Upright(Prism),
    /// Tilted piece or triangle: index of the general piece.
    Askew(u32),
}

/// All stationary pieces, by the numbers that the broad phase uses.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pieces {
    pieces: Vec<Stationary>,
    free: Vec<u32>,
    askew: Vec<Piece>,
    free_askew: Vec<u32>,
}

impl Pieces {
    /// Adds the pieces of a checked shape and enters their boxes into `space`. Returns the number of the first piece in
    /// their chain of siblings.
    #[inline]
    pub(crate) fn insert(
        &mut self,
        space: &mut impl Entering,
        shape: &Shape,
        pose: &Pose,
        owner: ElementKey,
    ) -> u32 {
        // Nearly every element is one upright block or cylinder and needs no general piece.
        if let Some(prism) = Prism::standing(shape, pose) {
            let cover = Cover::of(prism.bounds());
            return self.enter(space, Stored::Upright(prism), &cover, owner, NONE);
        }
        let frame = Frame::of(pose.rotation);
        let mut first = NONE;
        each_piece(shape, |piece| {
            let piece = piece.placed(&frame, pose.position);
            let form = if piece.upright {
                Stored::Upright(Prism::of(&piece))
            } else {
                Stored::Askew(kept(&mut self.askew, &mut self.free_askew, piece))
            };
            let cover = Cover::of(piece.bounds());
            first = self.enter(space, form, &cover, owner, first);
        });
        first
    }

    #[inline(always)]
    fn enter(
        &mut self,
        space: &mut impl Entering,
        form: Stored,
        cover: &Cover,
        owner: ElementKey,
        sibling: u32,
    ) -> u32 {
        let stationary = Stationary {
            corners: [cover.low, cover.high].map(|[x, y, z, _]| [x, y, z]),
            form,
            owner,
            sibling,
        };
        let number = kept(&mut self.pieces, &mut self.free, stationary);
        space.enter(number, cover);
        number
    }

    /// Removes a piece and returns the number of the next piece of its element.
    #[inline]
    pub(crate) fn remove(&mut self, number: u32) -> u32 {
        if let Stored::Askew(whole) = self.at(number).form {
            self.free_askew.push(whole);
        }
        self.free.push(number);
        self.at(number).sibling
    }

    #[inline]
    pub(crate) fn at(&self, number: u32) -> &Stationary {
        &self.pieces[number as usize]
    }

    /// Returns a piece in its general form, for searches.
    pub(crate) fn piece(&self, number: u32) -> Piece {
        match &self.at(number).form {
            Stored::Upright(prism) => prism.piece(),
            Stored::Askew(whole) => self.askew[*whole as usize],
        }
    }

    /// Reserves room for `count` more pieces.
    pub(crate) fn reserve(&mut self, count: usize) {
        self.pieces.reserve(count);
    }

    /// Returns the heap that the pieces use, bytes.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.pieces.capacity() * size_of::<Stationary>()
            + self.askew.capacity() * size_of::<Piece>()
            + (self.free.capacity() + self.free_askew.capacity()) * size_of::<u32>()
    }
}

/// Stores a value in a free place, else at the end, and returns its index.
#[inline]
fn kept<T>(things: &mut Vec<T>, free: &mut Vec<u32>, thing: T) -> u32 {
    match free.pop() {
        Some(number) => {
            things[number as usize] = thing;
            number
        }
        None => {
            things.push(thing);
            (things.len() - 1) as u32
        }
    }
}
