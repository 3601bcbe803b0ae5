//! What is asked of the model and what it answers.

use super::pose::Pose;

/// Name of an element inside one [`Model`](super::Model); never reused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementKey {
    pub(crate) slot: u32,
    pub(crate) generation: u32,
}

impl ElementKey {
    /// Blocker of an answer that blames no element: the move or the mover itself is not valid.
    /// [`Model::id`](super::Model::id) calls it `"(undecidable)"`.
    pub const UNDECIDABLE: ElementKey = ElementKey {
        slot: u32::MAX,
        generation: u32::MAX,
    };
}

/// A move of one mover: straight when both rotations agree, else position linear and rotation the
/// shortest turn.
#[derive(Debug, Clone, Copy)]
pub struct Move<'a> {
    /// Where the mover stands.
    pub from: Pose,
    /// Where it should go.
    pub to: Pose,
    /// Distance that must be exceeded during the whole move, mm, >= 0.
    pub margin_mm: f64,
    /// Elements that do not count.
    pub ignore: &'a [ElementKey],
}

impl Move<'_> {
    /// Whether it ends where it begins, bit by bit. (A way of no length is judged as well where this says no.)
    #[inline]
    pub(crate) fn goes_nowhere(&self) -> bool {
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
    /// The margin is reached, or nothing could be proven.
    Blocked(Contact),
}

/// Where a move first reaches its margin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// Fraction of the move, 0 to 1, never later than the true one.
    pub t_stop: f64,
    /// The element that is reached first.
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
    /// The element that is nearest.
    pub nearest: ElementKey,
    /// Fraction of the move at which it is nearest (one of them, if it is so for longer).
    pub t: f64,
}
