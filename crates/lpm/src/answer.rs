//! Moves that the model checks, and its answers.

use super::pose::Pose;

/// Key of an element inside one [`Model`](super::Model); never reused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementKey {
    pub(crate) slot: u32,
    pub(crate) generation: u32,
}

impl ElementKey {
    /// Reported as blocker when the move or the mover itself is invalid, so that no element is to blame.
    /// [`Model::id`](super::Model::id) returns `"(undecidable)"` for it.
    pub const UNDECIDABLE: ElementKey = ElementKey {
        slot: u32::MAX,
        generation: u32::MAX,
    };
}

/// A move of one mover: a straight translation when both rotations agree, else the position changes linearly and
/// the rotation along the shortest turn.
#[derive(Debug, Clone, Copy)]
pub struct Move<'a> {
    /// Pose of the mover at the start.
    pub from: Pose,
    /// Pose of the mover at the end.
    pub to: Pose,
    /// Distance that the mover must exceed during the whole move, mm, >= 0.
    pub margin_mm: f64,
    /// Elements that the check leaves out.
    pub ignore: &'a [ElementKey],
}

impl Move<'_> {
    /// Whether start and end agree bit by bit. (0 and -0 differ; such a move is checked as a path of length zero.)
    #[inline]
    pub(crate) fn is_at_rest(&self) -> bool {
        let (from, to) = (&self.from, &self.to);
        let places = from.position.iter().zip(&to.position);
        let turns = from.rotation.iter().zip(&to.rotation);
        let differing = |(a, b): (&f64, &f64)| a.to_bits() ^ b.to_bits();
        places
            .chain(turns)
            .map(differing)
            .fold(0, |all, bits| all | bits)
            == 0
    }
}

/// Answer to a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Answer {
    /// Proven: the distance stays above the margin during the whole move.
    Clear,
    /// The mover reaches the margin, or no proof of the opposite was found.
    Blocked(Contact),
}

/// Where a move first reaches its margin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Fraction of the move, 0 to 1, never later than the true contact.
    pub t_stop: f64,
    /// The element that the mover reaches first.
    pub blocker: ElementKey,
    /// Nearest point of the blocker at `t_stop`, mm.
    pub at: [f64; 3],
    /// Unit vector from the blocker to the mover at `t_stop`.
    pub normal: [f64; 3],
    /// Distance at `t_stop`, mm; 0 when the bodies meet.
    pub distance_mm: f64,
}

/// Least distance over a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clearance {
    /// Least distance, mm; 0 when the bodies meet. Above the true one by at most 1e-9 mm for straight
    /// moves and 5e-4 mm for turning ones.
    pub distance_mm: f64,
    /// The nearest element.
    pub nearest: ElementKey,
    /// Fraction of the move at which the element is nearest; one such fraction when there are several.
    pub t: f64,
}
