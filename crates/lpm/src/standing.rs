//! The pieces that stand, in one block of memory: what a question reads of them, and no more.
//!
//! An upright piece is kept as its [`Prism`] alone, which says all there is to say of it. What is
//! tilted, and triangles, need a whole [`Piece`] each and are kept apart.

use super::answer::ElementKey;
use super::piece::{Piece, each_piece};
use super::pose::{Frame, Pose};
use super::prism::Prism;
use super::shape::Shape;
use super::space::{Cover, Entering};

/// No piece.
pub(crate) const NONE: u32 = u32::MAX;

/// A piece where it stands.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Standing {
    pub(crate) form: Stands,
    /// Its element.
    pub(crate) owner: ElementKey,
    /// Another piece of the same element, or [`NONE`].
    pub(crate) sibling: u32,
}

/// How a piece stands.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Stands {
    /// Closed forms apply.
    Upright(Prism),
    /// Number of the whole piece.
    Askew(u32),
}

/// All standing pieces by the numbers that the space knows.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pieces {
    standing: Vec<Standing>,
    free: Vec<u32>,
    askew: Vec<Piece>,
    free_askew: Vec<u32>,
}

impl Pieces {
    /// Takes the pieces of a checked shape in, enters their boxes into `space` and says the number of
    /// the first in the chain of siblings.
    #[inline]
    pub(crate) fn stand(
        &mut self,
        space: &mut impl Entering,
        shape: &Shape,
        pose: &Pose,
        owner: ElementKey,
    ) -> u32 {
        // What nearly all elements are needs no detour by the general piece.
        if let Some(prism) = Prism::standing(shape, pose) {
            let cover = Cover::of(prism.bounds());
            return self.enter(space, Stands::Upright(prism), &cover, owner, NONE);
        }
        let frame = Frame::of(pose.rotation);
        let mut first = NONE;
        each_piece(shape, |piece| {
            let piece = piece.placed(&frame, pose.position);
            let form = if piece.upright {
                Stands::Upright(Prism::of(&piece))
            } else {
                Stands::Askew(kept(&mut self.askew, &mut self.free_askew, piece))
            };
            let cover = Cover::of(piece.bounds());
            first = self.enter(space, form, &cover, owner, first);
        });
        first
    }

    #[inline]
    fn enter(
        &mut self,
        space: &mut impl Entering,
        form: Stands,
        cover: &Cover,
        owner: ElementKey,
        sibling: u32,
    ) -> u32 {
        let standing = Standing {
            form,
            owner,
            sibling,
        };
        let number = kept(&mut self.standing, &mut self.free, standing);
        space.enter(number, cover);
        number
    }

    /// Forgets a piece and says which is the next one of its element.
    #[inline]
    pub(crate) fn let_go(&mut self, number: u32) -> u32 {
        if let Stands::Askew(whole) = self.at(number).form {
            self.free_askew.push(whole);
        }
        self.free.push(number);
        self.at(number).sibling
    }

    #[inline]
    pub(crate) fn at(&self, number: u32) -> &Standing {
        &self.standing[number as usize]
    }

    /// The whole piece, for searches.
    pub(crate) fn piece(&self, number: u32) -> Piece {
        match &self.at(number).form {
            Stands::Upright(prism) => prism.piece(),
            Stands::Askew(whole) => self.askew[*whole as usize],
        }
    }

    /// Room for so many more.
    pub(crate) fn reserve(&mut self, count: usize) {
        self.standing.reserve(count);
    }

    /// Heap in use, bytes.
    pub(crate) fn heap_bytes(&self) -> usize {
        self.standing.capacity() * size_of::<Standing>()
            + self.askew.capacity() * size_of::<Piece>()
            + (self.free.capacity() + self.free_askew.capacity()) * size_of::<u32>()
    }
}

/// Puts a thing in a free place, or behind the last.
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
