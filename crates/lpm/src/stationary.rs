//! The pieces of the stationary elements in one block of memory, reduced to the numbers that questions read.
//!
//! An upright piece is stored as its [`Prism`], which describes it completely. A tilted piece or a triangle needs a
//! whole [`Piece`], which is stored separately.

use super::answer::ElementKey;
use super::piece::{Piece, each_piece};
use super::pose::{Frame, Pose};
use super::prism::{Checked, Prism};
use super::shape::Shape;
use super::space::{Cover, Entering};

/// Number that means no piece.
pub(crate) const NONE: u32 = u32::MAX;

/// A placed stationary piece, in two cache lines.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(crate) struct Stationary {
    /// The box around the piece, mm: least x and y, then greatest x and y. They are written and read as one, because a
    /// read that spans two recent writes stalls the processor.
    footprint: [f32; 4],
    /// Least and greatest z of the box around the piece, mm.
    heights: [f32; 2],
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
        let ([left, front, right, back], [bottom, top]) = (self.footprint, self.heights);
        Cover {
            low: [left, front, bottom, 0.0],
            high: [right, back, top, 0.0],
        }
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
    /// Adds the pieces of a shape and enters their boxes into `space`. Returns the number of the first piece in
    /// their chain of siblings.
    #[inline(always)]
    pub(crate) fn insert(
        &mut self,
        space: &mut impl Entering,
        checked: &Checked<'_>,
        pose: &Pose,
        owner: ElementKey,
    ) -> u32 {
        // Nearly every element is one upright block or cylinder and needs no general piece.
        let single = checked.single.as_ref();
        if let Some(prism) = single.and_then(|single| Prism::standing(single, pose)) {
            let cover = Cover::of(prism.bounds());
            return self.enter(space, Stored::Upright(prism), &cover, owner, NONE);
        }
        self.insert_pieces(space, checked.shape, pose, owner)
    }

    /// Adds the pieces of a shape that is not a single upright body.
    #[cold]
    #[inline(never)]
    fn insert_pieces(
        &mut self,
        space: &mut impl Entering,
        shape: &Shape,
        pose: &Pose,
        owner: ElementKey,
    ) -> u32 {
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
            footprint: [cover.low[0], cover.low[1], cover.high[0], cover.high[1]],
            heights: [cover.low[2], cover.high[2]],
            form,
            owner,
            sibling,
        };
        let number = kept(&mut self.pieces, &mut self.free, stationary);
        space.enter(number, cover);
        number
    }

    /// Removes a piece; returns the box around it and the number of the next piece of its element.
    #[inline(always)]
    pub(crate) fn remove(&mut self, number: u32) -> (Cover, u32) {
        let gone = &self.pieces[number as usize];
        if let Stored::Askew(whole) = gone.form {
            self.free_askew.push(whole);
        }
        self.free.push(number);
        (gone.cover(), gone.sibling)
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
