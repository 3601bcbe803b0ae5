//! The eight actuators of the rig and their known positions.
//!
//! Strokes count in mm from the actuator's rest end (`At(0.0)`): escapement holding, pusher
//! retracted, jaws open, probes down, axis at the nest, sort z up, gripper open.

use serde::Deserialize;
use std::fmt;

/// An actuator that the guard knows, in the order of [`Actuator::ALL`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Actuator {
    /// Lets one part from the magazine track into the pocket.
    Escapement,
    /// Brings the part from the pocket to the nest.
    Pusher,
    /// The nest's jaw on the +y side; a scene may also call it `clamp_left`.
    #[serde(alias = "clamp_left")]
    JawLeft,
    /// The nest's jaw on the -y side; a scene may also call it `clamp_right`.
    #[serde(alias = "clamp_right")]
    JawRight,
    /// Lifts the Kelvin pin block to the relay's pins.
    ProbeLift,
    /// The electric slide along x; its stroke is x relative to the nest.
    SortAxis,
    /// Lowers the gripper.
    SortZ,
    /// Closes the two fingers.
    Gripper,
}

impl Actuator {
    /// Every actuator once.
    pub const ALL: [Actuator; 8] = [
        Actuator::Escapement,
        Actuator::Pusher,
        Actuator::JawLeft,
        Actuator::JawRight,
        Actuator::ProbeLift,
        Actuator::SortAxis,
        Actuator::SortZ,
        Actuator::Gripper,
    ];

    /// Other ids that a scene may give the jaws.
    pub const OTHER_NAMES: [&'static str; 2] = ["clamp_left", "clamp_right"];

    /// Returns the id in `scene.toml`.
    pub const fn name(self) -> &'static str {
        match self {
            Actuator::Escapement => "escapement",
            Actuator::Pusher => "pusher",
            Actuator::JawLeft => "jaw_left",
            Actuator::JawRight => "jaw_right",
            Actuator::ProbeLift => "probe_lift",
            Actuator::SortAxis => "sort_axis",
            Actuator::SortZ => "sort_z",
            Actuator::Gripper => "gripper",
        }
    }

    /// Returns the ids of all actuators, in the order of [`Actuator::ALL`].
    pub fn names() -> [&'static str; 8] {
        Self::ALL.map(Actuator::name)
    }

    /// Returns the actuator with this id.
    pub fn from_name(name: &str) -> Option<Actuator> {
        Self::ALL.into_iter().find(|a| a.name() == name)
    }

    /// Returns the index in [`Actuator::ALL`] and in every table by actuator.
    pub const fn index(self) -> usize {
        self as usize
    }
}

impl fmt::Display for Actuator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Known position of an actuator, mm from its rest end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Position {
    /// At rest here, confirmed by a sensor or the drive.
    At(f64),
    /// Moving or not exactly known: its bodies occupy the whole span.
    Between {
        /// Low end of the span.
        from_mm: f64,
        /// High end of the span.
        to_mm: f64,
    },
}

impl Position {
    /// Returns the low and high end, mm.
    pub fn span_mm(self) -> (f64, f64) {
        match self {
            Position::At(mm) => (mm, mm),
            Position::Between { from_mm, to_mm } => (from_mm.min(to_mm), from_mm.max(to_mm)),
        }
    }

    /// Returns the smallest span that holds this position and the point `mm`.
    pub fn reaching(self, mm: f64) -> Position {
        let (low, high) = self.span_mm();
        if low == mm && high == mm {
            return self;
        }
        Position::Between {
            from_mm: low.min(mm),
            to_mm: high.max(mm),
        }
    }
}
