//! Bodies that move: taken apart once, asked about often.

use super::path::Path;
use super::piece::{Piece, pieces_of};
use super::pose::Frame;
use super::shape::{Flaw, Shape};
use super::solid::Interior;
use std::borrow::Cow;

/// A checked body in its own frame, ready for many questions.
#[derive(Debug, Clone)]
pub struct Mover {
    pub(crate) pieces: Vec<Piece>,
    interior: Interior,
}

impl Mover {
    /// Takes a shape apart.
    ///
    /// # Errors
    /// [`Flaw`] of the shape.
    pub fn new(shape: &Shape) -> Result<Mover, Flaw> {
        shape.check()?;
        Ok(Mover {
            pieces: pieces_of(shape),
            interior: Interior::of(shape),
        })
    }

    /// True when the body holds space that others can be inside of without touching its triangles.
    pub(crate) fn is_hollow(&self) -> bool {
        !self.interior.solids.is_empty()
    }

    /// The inside where the way begins.
    pub(crate) fn interior_at_start(&self, start: &Frame, path: &Path) -> Interior {
        self.interior.placed(start, path.origin(0.0))
    }
}

/// What the model can be asked about: a [`Mover`], or a [`Shape`] that is taken apart for this one question.
pub trait Moving {
    /// The body taken apart; `None` when the shape is flawed, which is answered with blocked.
    fn mover(&self) -> Option<Cow<'_, Mover>>;
}

impl Moving for Mover {
    fn mover(&self) -> Option<Cow<'_, Mover>> {
        Some(Cow::Borrowed(self))
    }
}

impl Moving for Shape {
    fn mover(&self) -> Option<Cow<'_, Mover>> {
        Mover::new(self).ok().map(Cow::Owned)
    }
}
