//! What the guard must be told: where every actuator stands and where parts are.

use super::actuator::{Actuator, Position};

/// Where there is a part at this moment. One part may be named in one place only; two places mean
/// two parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct PartPlaces {
    /// Waiting in the pocket.
    pub pocket: bool,
    /// In front of the pusher, somewhere between pocket and nest.
    pub on_pusher: bool,
    /// Standing in the nest. Name it here, not in the gripper, until the jaws are open.
    pub nest: bool,
    /// Held by the gripper.
    pub gripper: bool,
}

/// Size of the part being made, from the recipe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartSize {
    /// Body along x, y and z, mm, > 0.
    pub body_mm: [f64; 3],
    /// How far the pins reach below the body, mm, >= 0.
    pub pin_length_mm: f64,
}

impl PartSize {
    /// Finite, body > 0, pins >= 0.
    pub(super) fn is_sane(&self) -> bool {
        let body = self.body_mm.iter().all(|mm| mm.is_finite() && *mm > 0.0);
        body && self.pin_length_mm.is_finite() && self.pin_length_mm >= 0.0
    }
}

/// Everything a decision depends on beside the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Situation {
    positions: [Option<Position>; 8],
    /// Where parts are.
    pub parts: PartPlaces,
    /// How big they are.
    pub part_size: PartSize,
}

impl Situation {
    /// Nothing known of any actuator: each occupies its whole stroke until told otherwise.
    pub fn unknown(part_size: PartSize) -> Situation {
        Situation {
            positions: [None; 8],
            parts: PartPlaces::default(),
            part_size,
        }
    }

    /// Every actuator at its rest end, no part anywhere.
    pub fn at_rest(part_size: PartSize) -> Situation {
        Situation {
            positions: [Some(Position::At(0.0)); 8],
            ..Situation::unknown(part_size)
        }
    }

    /// The same with `actuator` at `position`.
    #[must_use]
    pub fn with(mut self, actuator: Actuator, position: Position) -> Situation {
        self.set(actuator, position);
        self
    }

    /// Says where `actuator` is.
    pub fn set(&mut self, actuator: Actuator, position: Position) {
        self.positions[actuator.index()] = Some(position);
    }

    /// Says that nothing is known of `actuator`.
    pub fn forget(&mut self, actuator: Actuator) {
        self.positions[actuator.index()] = None;
    }

    /// What is known of `actuator`; `None` is nothing.
    pub fn position(&self, actuator: Actuator) -> Option<Position> {
        self.positions[actuator.index()]
    }
}
