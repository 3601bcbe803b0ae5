//! Bodies that move: taken apart once, asked about often.

use super::path::Path;
use super::piece::{NOISE, Piece, pieces_of};
use super::shape::{Flaw, Shape};
use super::solid::Interior;
use super::space::Sweep;
use super::vector::{Vec3, add, dot, length, reach};
use std::borrow::Cow;

/// Pieces of a group: as many as are placed at once without asking for memory.
pub(crate) const MOST_OF_A_GROUP: usize = 4;

/// A checked body in its own frame, ready for many questions.
#[derive(Debug, Clone)]
pub struct Mover {
    pub(crate) pieces: Vec<Piece>,
    pub(crate) groups: Vec<Group>,
    interior: Option<Interior>,
}

/// A few pieces in one box: the whole is asked about before its parts are.
#[derive(Debug, Clone)]
pub(crate) struct Group {
    /// Of the first piece.
    pub(crate) first: usize,
    pub(crate) count: usize,
    /// Box in the frame of the body, rounded outward, mm.
    centre: Vec3,
    half: Vec3,
    /// Largest distance of a point from the origin of the body, rounded outward, mm.
    ball: f64,
    /// The scale of rounding errors, mm.
    span: f64,
}

impl Mover {
    /// Takes a shape apart.
    ///
    /// # Errors
    /// [`Flaw`] of the shape.
    pub fn new(shape: &Shape) -> Result<Mover, Flaw> {
        shape.check()?;
        let pieces = pieces_of(shape);
        let chunks = pieces.chunks(MOST_OF_A_GROUP).enumerate();
        let groups = chunks.map(|(index, chunk)| Group::of(index * MOST_OF_A_GROUP, chunk));
        Ok(Mover {
            groups: groups.collect(),
            interior: Interior::of(shape),
            pieces,
        })
    }

    /// True when the body holds space that others can be inside of without touching its triangles.
    pub(crate) fn is_hollow(&self) -> bool {
        self.interior
            .as_ref()
            .is_some_and(|interior| !interior.solids.is_empty())
    }

    /// The inside where the way begins.
    pub(crate) fn interior_at_start(&self, path: &Path) -> Interior {
        let (frame, position) = (path.start(), path.origin(0.0));
        match &self.interior {
            Some(interior) => interior.placed(frame, position),
            None => {
                let centres = self.pieces.iter().map(|piece| piece.centre);
                Interior::around(
                    centres
                        .map(|centre| add(frame.apply(centre), position))
                        .collect(),
                )
            }
        }
    }
}

impl Group {
    fn of(first: usize, pieces: &[Piece]) -> Group {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let (mut ball, mut span) = (0.0_f64, 0.0_f64);
        for piece in pieces {
            let bounds = piece.bounds();
            for axis in 0..3 {
                low[axis] = low[axis].min(bounds.0[axis]);
                high[axis] = high[axis].max(bounds.1[axis]);
            }
            ball = ball.max(reach_of(piece));
            span = span.max(piece.span + reach(piece.centre));
        }
        Group {
            first,
            count: pieces.len(),
            centre: [0, 1, 2].map(|axis: usize| 0.5 * (low[axis] + high[axis])),
            half: [0, 1, 2].map(|axis: usize| 0.5 * (high[axis] - low[axis])),
            ball,
            span,
        }
    }

    /// The box of the group on its way, rounded outward and widened by `margin` (mm).
    ///
    /// Of a turning group: the box of the ball it stays in, whatever the turn.
    #[inline]
    pub(crate) fn sweep(&self, path: &Path, margin: f64) -> Sweep {
        let noise = NOISE * (self.span + reach(path.origin(0.0)));
        let (centre, half) = self.box_at_start(path);
        let side =
            |sign: f64| [0, 1, 2].map(|axis: usize| centre[axis] + sign * (half[axis] + noise));
        path.sweep((side(-1.0), side(1.0)), margin)
    }

    #[inline]
    fn box_at_start(&self, path: &Path) -> (Vec3, Vec3) {
        if path.turn.is_some() {
            return (path.origin(0.0), [self.ball; 3]);
        }
        let frame = path.start();
        if frame.is_identity() {
            return (add(self.centre, path.origin(0.0)), self.half);
        }
        let half = [0, 1, 2].map(|axis: usize| {
            let images = [frame.x, frame.y, frame.z].map(|image| image[axis].abs());
            dot(images, self.half)
        });
        (add(frame.apply(self.centre), path.origin(0.0)), half)
    }
}

/// Largest distance of a point of the piece from the origin of its body, mm, rounded outward.
pub(crate) fn reach_of(piece: &Piece) -> f64 {
    (length(piece.centre) + piece.radius()) * (1.0 + 8.0 * f64::EPSILON)
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
