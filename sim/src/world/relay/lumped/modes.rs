//! Modes of the unilateral elements (contacts, stops, suppression): a flag for each, and the gap function that sets it.
//!
//! The equations use the flag, never the sign of the gap function. An event occurs when that sign no longer matches the
//! flag, so rounding near a root cannot cause chatter.

use super::{State, V, W, X, Y};

/// An element that is either engaged or free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Element {
    /// Armature on its rest stop.
    Backstop,
    /// Armature on the pole.
    Seat,
    /// Normally closed contact.
    Nc,
    /// Normally open contact.
    No,
    /// Suppression that has stopped conducting after the coil was switched off.
    CoilBlocked,
}

impl Element {
    /// The four mechanical contacts and stops.
    pub const TOUCHING: [Element; 4] = [Element::Backstop, Element::Seat, Element::Nc, Element::No];

    /// Returns the name of the element in files.
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

/// A flag for each element: engaged, or free.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Modes([bool; 5]);

impl Modes {
    /// Checks whether an element is engaged.
    #[inline]
    pub fn is_engaged(self, element: Element) -> bool {
        self.0[element as usize]
    }

    /// Sets or clears the flag of an element.
    pub fn set(&mut self, element: Element, on: bool) {
        self.0[element as usize] = on;
    }
}

/// Positions of the stops, m.
#[derive(Debug, Clone, Copy)]
pub struct StopPositions {
    /// Seat: travel of the armature.
    pub seat: f64,
    /// Fixed NO contact.
    pub no: f64,
}

impl StopPositions {
    /// Returns the overlap at a stop, m; above zero while the bodies press.
    #[inline]
    pub fn overlap(self, element: Element, s: &State) -> f64 {
        match element {
            Element::Backstop => -s[X],
            Element::Seat => s[X] - self.seat,
            Element::Nc => -s[Y],
            Element::No => s[Y] - self.no,
            Element::CoilBlocked => 0.0,
        }
    }

    /// Returns the rate of change of the overlap of [`Self::overlap`], m/s.
    #[inline]
    pub fn rate(self, element: Element, s: &State) -> f64 {
        match element {
            Element::Backstop => -s[V],
            Element::Seat => s[V],
            Element::Nc => -s[W],
            Element::No => s[W],
            Element::CoilBlocked => 0.0,
        }
    }
}
