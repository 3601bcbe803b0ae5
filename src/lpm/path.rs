//! The way of a mover: a straight translation, or position linear and rotation the shortest turn.

use super::piece::{Piece, is_exact_sum};
use super::pose::{Frame, Pose, Turn};
use super::vector::{Vec3, along, negate, reach, sub};

/// A move between two checked poses; `t` runs from 0 to 1.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    /// Origin where the way begins, mm.
    pub(crate) from: Vec3,
    to: Vec3,
    /// Whole displacement of the origin, mm.
    pub(crate) displacement: Vec3,
    start: Frame,
    is_unturned: bool,
    is_at_rest: bool,
    /// `None`: the move is a translation. (Apart: most are.)
    pub(crate) turn: Option<Box<Turn>>,
}

impl Path {
    /// `None` when a number is not finite: nothing can be said about such a move.
    #[inline(always)]
    pub(crate) fn between(from: &Pose, to: &Pose) -> Option<Path> {
        let is_turned = !same(&from.rotation, &to.rotation);
        let stays = same(&from.position, &to.position);
        if !(from.is_sound() && (stays || to.is_placed()) && (!is_turned || to.is_sound())) {
            return None;
        }
        let turn = if is_turned {
            Turn::between(from.rotation, to.rotation).map(Box::new)
        } else {
            None
        };
        let [_, x, y, z] = from.rotation;
        let is_unturned = (x == 0.0) & (y == 0.0) & (z == 0.0);
        let path = Path {
            from: from.position,
            to: to.position,
            displacement: sub(to.position, from.position),
            is_at_rest: stays && turn.is_none(),
            start: if is_unturned {
                Frame::IDENTITY
            } else {
                Frame::of(from.rotation)
            },
            is_unturned,
            turn,
        };
        Some(path)
    }

    /// Whether the move goes nowhere.
    #[inline]
    pub(crate) fn is_at_rest(&self) -> bool {
        self.is_at_rest
    }

    /// Origin of the mover at `t`.
    #[inline]
    pub(crate) fn origin(&self, t: f64) -> Vec3 {
        along(self.from, t, self.displacement)
    }

    /// A piece of the mover where it stands at `t`.
    pub(crate) fn piece_at(&self, local: &Piece, t: f64) -> Piece {
        match &self.turn {
            None => local.placed(&self.start, self.origin(t)),
            Some(turn) => local.placed(&turn.frame_at(t), self.origin(t)),
        }
    }

    /// The sum of magnitudes of everything that enters a position on the way, mm.
    pub(crate) fn span(&self) -> f64 {
        reach(self.from) + reach(self.displacement)
    }

    /// Whether nothing was rounded between both ends and the displacement.
    #[inline]
    pub(crate) fn is_exact(&self) -> bool {
        is_exact_sum(self.to, negate(self.from))
    }

    /// Whether the frame of the mover is the common one at the start.
    #[inline]
    pub(crate) fn is_unturned(&self) -> bool {
        self.is_unturned
    }

    /// Orientation of the mover at the start.
    #[inline]
    pub(crate) fn start(&self) -> &Frame {
        &self.start
    }
}

/// Equality of all members at once, which here is sooner than one after the other.
#[inline]
fn same<const N: usize>(a: &[f64; N], b: &[f64; N]) -> bool {
    a.iter().zip(b).fold(true, |same, (a, b)| same & (a == b))
}
