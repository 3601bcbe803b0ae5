//! The path of a mover: a straight translation, or a linear change of position with the shortest turn.

use super::answer::Move;
use super::mover::Orientation;
use super::piece::{Piece, is_exact_sum};
use super::pose::{Frame, Turn};
use super::vector::{Vec3, along, negate, reach, sub};

/// A path between two checked poses; the fraction `t` runs from 0 to 1.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    /// Origin of the mover at the start, mm.
    pub(crate) from: Vec3,
    to: Vec3,
    /// Total displacement of the origin, mm.
    pub(crate) displacement: Vec3,
    /// Orientation at the start; `None` for the identity.
    turned: Option<Frame>,
    /// The turn; `None` for a translation. Boxed because most moves are translations.
    pub(crate) turn: Option<Box<Turn>>,
}

impl Path {
    /// Converts a move. Returns `None` when a number is not finite or the margin is invalid: no check can then decide
    /// the move.
    pub(crate) fn of(way: &Move) -> Option<Path> {
        if !(way.margin_mm >= 0.0 && way.margin_mm <= f64::MAX) {
            return None;
        }
        let (from, to) = (&way.from, &way.to);
        let is_turned = from.rotation != to.rotation;
        if !(from.is_sound() && to.is_placed() && (!is_turned || to.is_sound())) {
            return None;
        }
        let turn = if is_turned {
            Turn::between(from.rotation, to.rotation).map(Box::new)
        } else {
            None
        };
        Some(Path {
            from: from.position,
            to: to.position,
            displacement: sub(to.position, from.position),
            turned: (!from.is_unturned()).then(|| Frame::of(from.rotation)),
            turn,
        })
    }

    /// Returns the origin of the mover at fraction `t`, mm.
    #[inline]
    pub(crate) fn origin(&self, t: f64) -> Vec3 {
        along(self.from, t, self.displacement)
    }

    /// Returns a piece of the mover at its place at fraction `t`.
    pub(crate) fn piece_at(&self, local: &Piece, t: f64) -> Piece {
        match &self.turn {
            None => local.placed(self.start(), self.origin(t)),
            Some(turn) => local.placed(&turn.frame_at(t), self.origin(t)),
        }
    }

    /// Returns the sum of the magnitudes of everything that enters a position on the path, mm.
    pub(crate) fn span(&self) -> f64 {
        reach(self.from) + reach(self.displacement)
    }

    /// Returns true when the displacement is the exact difference of both ends, without rounding.
    #[inline]
    pub(crate) fn is_exact(&self) -> bool {
        is_exact_sum(self.to, negate(self.from))
    }

    /// Returns the orientation of the mover at the start; `None` for the identity.
    #[inline]
    pub(crate) fn turned(&self) -> Option<&Frame> {
        self.turned.as_ref()
    }

    /// Returns the orientation of the mover along the path.
    pub(crate) fn orientation(&self) -> Orientation<'_> {
        match (&self.turn, &self.turned) {
            (Some(_), _) => Orientation::Turning,
            (None, None) => Orientation::Unturned,
            (None, Some(frame)) => frame.yaw().map_or(Orientation::Tilted(frame), |yaw| {
                Orientation::Yawed(yaw.rough())
            }),
        }
    }

    /// Returns the orientation of the mover at the start, also when it is the identity.
    pub(crate) fn start(&self) -> &Frame {
        self.turned.as_ref().unwrap_or(&Frame::IDENTITY)
    }
}
