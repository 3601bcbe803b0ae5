//! Which of the unilateral parts are engaged: a mode flag each, and the gap function that decides.
//!
//! The right-hand side goes by the flag, never by the sign of the gap; an event is the sign of a
//! gap function that no longer agrees with its flag. So rounding at a root cannot chatter.

use super::{State, V, W, X, Y};

/// A part that is engaged or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The armature on its rest stop.
    Backstop,
    /// The armature on the pole.
    Seat,
    /// The normally closed contact.
    Nc,
    /// The normally open contact.
    No,
    /// The clamp of a coil that was switched off has stopped conducting.
    CoilBlocked,
}

impl Kind {
    /// The four that touch.
    pub const TOUCHING: [Kind; 4] = [Kind::Backstop, Kind::Seat, Kind::Nc, Kind::No];

    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Backstop => "backstop",
            Self::Seat => "seat",
            Self::Nc => "NC",
            Self::No => "NO",
            Self::CoilBlocked => "coil_blocked",
        }
    }
}

/// A flag for each kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Modes([bool; 5]);

impl Modes {
    /// Whether a kind is engaged.
    #[inline]
    pub fn is(self, kind: Kind) -> bool {
        self.0[kind as usize]
    }

    /// Engages or releases a kind.
    pub fn put(&mut self, kind: Kind, on: bool) {
        self.0[kind as usize] = on;
    }
}

/// Where the four stops stand, m.
#[derive(Debug, Clone, Copy)]
pub struct Places {
    /// Travel of the armature.
    pub seat: f64,
    /// The fixed NO contact.
    pub no: f64,
}

impl Places {
    /// Overlap at a stop: above zero while the bodies press.
    #[inline]
    pub fn overlap(self, kind: Kind, s: &State) -> f64 {
        match kind {
            Kind::Backstop => -s[X],
            Kind::Seat => s[X] - self.seat,
            Kind::Nc => -s[Y],
            Kind::No => s[Y] - self.no,
            Kind::CoilBlocked => 0.0,
        }
    }

    /// Rate of that overlap, m/s.
    #[inline]
    pub fn rate(self, kind: Kind, s: &State) -> f64 {
        match kind {
            Kind::Backstop => -s[V],
            Kind::Seat => s[V],
            Kind::Nc => -s[W],
            Kind::No => s[W],
            Kind::CoilBlocked => 0.0,
        }
    }
}
