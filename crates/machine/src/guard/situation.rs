//! The situation that the guard judges: positions of the actuators and places of the parts.

use super::actuator::{Actuator, Position};

/// Places that hold a part now. Name each part in one place only: two places mean two parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct PartPlaces {
    /// In the pocket.
    pub pocket: bool,
    /// In front of the pusher, between pocket and nest.
    pub on_pusher: bool,
    /// In the nest. A gripped part stays here, not in the gripper, until the jaws are open.
    pub nest: bool,
    /// In the gripper.
    pub gripper: bool,
}

/// Size of the part under test, from the recipe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PartSize {
    /// Body along x, y and z, mm, > 0.
    pub body_mm: [f64; 3],
    /// How far the pins reach below the body, mm, >= 0.
    pub pin_length_mm: f64,
}

impl PartSize {
    /// Returns true for finite sizes with body > 0 and pins >= 0.
    pub(super) fn is_sane(&self) -> bool {
        let body = self.body_mm.iter().all(|mm| mm.is_finite() && *mm > 0.0);
        body && self.pin_length_mm.is_finite() && self.pin_length_mm >= 0.0
    }
}

/// All inputs of a decision besides the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Situation {
    positions: [Option<Position>; 8],
    /// Places that hold a part.
    pub parts: PartPlaces,
    /// Size of a part, the same in every place of `parts`.
    pub part_size: PartSize,
    /// Bit n is set while the input of interlock n is on.
    pub(super) granted: u16,
}

impl Situation {
    /// Greatest number of interlocks.
    pub(super) const INTERLOCKS: usize = u16::BITS as usize;

    /// Returns a situation in which no position is known and no input is on: each actuator occupies its whole stroke.
    pub fn unknown(part_size: PartSize) -> Situation {
        Situation {
            positions: [None; 8],
            parts: PartPlaces::default(),
            part_size,
            granted: 0,
        }
    }

    /// Returns a situation with every actuator at its rest end and no part.
    pub fn at_rest(part_size: PartSize) -> Situation {
        Situation {
            positions: [Some(Position::At(0.0)); 8],
            ..Situation::unknown(part_size)
        }
    }

    /// Returns the situation with `actuator` at `position`.
    #[must_use]
    pub fn with(mut self, actuator: Actuator, position: Position) -> Situation {
        self.set(actuator, position);
        self
    }

    /// Sets the position of `actuator`.
    pub fn set(&mut self, actuator: Actuator, position: Position) {
        self.positions[actuator.index()] = Some(position);
    }

    /// Marks the position of `actuator` as unknown.
    pub fn forget(&mut self, actuator: Actuator) {
        self.positions[actuator.index()] = None;
    }

    /// Records that the input of the interlock with this number is on.
    pub fn grant(&mut self, interlock: usize) {
        self.granted |= 1 << interlock;
    }

    /// Returns true when the input of the interlock with this number is on.
    pub(super) fn is_granted(&self, interlock: usize) -> bool {
        self.granted >> interlock & 1 == 1
    }

    /// Returns the position of `actuator`; `None` when unknown.
    pub fn position(&self, actuator: Actuator) -> Option<Position> {
        self.positions[actuator.index()]
    }
}
