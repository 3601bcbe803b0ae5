//! Moves for the model to check, and its answers.

use super::pose::Pose;

/// Key of an element inside one [`Model`](super::Model); keys are never reused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementKey {
    pub(crate) slot: u32,
    pub(crate) generation: u32,
}

impl ElementKey {
    /// Blocker of a move that no element blocks, because the move or the mover itself is invalid.
    /// [`Model::id`](super::Model::id) returns `"(undecidable)"` for this key.
    pub const UNDECIDABLE: ElementKey = ElementKey {
        slot: u32::MAX,
        generation: u32::MAX,
    };

    /// Returns the place of the element in the model. Elements of [`Model::of`](super::Model::of) have places from 0 in
    /// their order; an element inserted later gets the place of a removed one, or the next free place.
    pub fn place(self) -> usize {
        self.slot as usize
    }
}

/// A move of one mover: with equal rotations at start and end, a straight translation; otherwise the position changes
/// linearly while the mover turns along the shortest way.
#[derive(Debug, Clone, Copy)]
pub struct Move<'a> {
    /// Pose of the mover at the start.
    pub from: Pose,
    /// Pose of the mover at the end.
    pub to: Pose,
    /// Margin, mm, >= 0: the distance to every element must exceed this margin during the whole move.
    pub margin_mm: f64,
    /// Elements that the check leaves out.
    pub ignore: &'a [ElementKey],
}

impl Move<'_> {
    /// Returns true when start and end are bitwise equal. (0 and -0 differ; such a move is checked as a path of length
    /// 0.)
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
    /// The mover comes within the margin of an element, or the check could not prove the opposite.
    Blocked(Contact),
}

/// The first point of a move that is within the margin of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Fraction of the move, 0 to 1; never later than the true contact.
    pub t_stop: f64,
    /// Element that the mover reaches first.
    pub blocker: ElementKey,
    /// Nearest point of the blocker at `t_stop`, mm.
    pub at: [f64; 3],
    /// Unit vector from the blocker to the mover at `t_stop`.
    pub normal: [f64; 3],
    /// Distance of mover and blocker at `t_stop`, mm; 0 when they meet.
    pub distance_mm: f64,
}

/// Least distance from the mover to any element over a move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clearance {
    /// Least distance, mm; 0 when the bodies meet. The value exceeds the true distance by at most 1e-9 mm for straight
    /// moves, and by at most 5e-4 mm for turning moves.
    pub distance_mm: f64,
    /// Element with this distance.
    pub nearest: ElementKey,
    /// Fraction of the move, 0 to 1, at which `nearest` has this distance; any such fraction when there are several.
    pub t: f64,
}
