//! Refusals of motions, in numbers and in words for a mechanic.

use super::actuator::Actuator;
use super::motion::Stroke;
use std::fmt;
use texts::Message;

/// Refusal of a motion: a normal result, not a program error.
#[derive(Debug, Clone, PartialEq)]
pub enum Refusal {
    /// Two bodies would come too near.
    Blocked(Box<Blocked>),
    /// A position lies outside the actuator's stroke, or is NaN.
    OutOfStroke {
        /// The actuator.
        actuator: Actuator,
        /// The invalid position, mm.
        found_mm: f64,
        /// Low and high end of the stroke, mm.
        stroke_mm: (f64, f64),
    },
    /// An input that the motion needs is off, or was not read recently.
    Interlock {
        /// The actuator.
        actuator: Actuator,
        /// Name of the input.
        input: String,
    },
    /// The part's size is invalid.
    PartSize {
        /// Body and pin length as given, mm.
        found_mm: [f64; 4],
    },
}

/// Two bodies that would come too near, the place, and the remedy.
#[derive(Debug, Clone, PartialEq)]
pub struct Blocked {
    /// The refused stroke.
    pub stroke: Stroke,
    /// The body that moves: an id of the scene or of a part (`part_nest`).
    pub mover: String,
    /// The body in its way.
    pub blocker: String,
    /// Least distance between the two bodies during the motion, mm; 0 when they meet.
    pub distance_mm: f64,
    /// Distance that the two bodies must exceed, mm; 0 where they may touch.
    pub margin_mm: f64,
    /// Fraction of the motion at which the margin is reached, 0 to 1; 0 when the start is unknown.
    pub at_fraction: f64,
    /// Place of the contact, mm.
    pub at: [f64; 3],
    /// The last clear pose, mm of the stroke: the guard clears the stroke up to here, and refuses it at most a
    /// hundredth of a millimetre beyond. An actuator that can stop on its way may move to this pose, and one that has
    /// stopped beyond it may return to it. `None` when the start is blocked or unknown.
    pub last_clear_mm: Option<f64>,
    /// Action that would make the motion possible, for example "raise sort z".
    pub would_help: String,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Refusal::Blocked(blocked) => blocked.fmt(f),
            Refusal::OutOfStroke {
                actuator,
                found_mm,
                stroke_mm: (low, high),
            } => write!(
                f,
                "{}: {found_mm} mm is not on its stroke of {low} to {high} mm",
                words(actuator.name())
            ),
            Refusal::Interlock { actuator, input } => write!(
                f,
                "{}: {} is not confirmed",
                words(actuator.name()),
                words(input)
            ),
            Refusal::PartSize {
                found_mm: [x, y, z, pins],
            } => {
                write!(
                    f,
                    "a part of {x} x {y} x {z} mm with pins of {pins} mm cannot be placed"
                )
            }
        }
    }
}

impl std::error::Error for Refusal {}

impl Refusal {
    /// Returns the refusal as a message of family `detail`, for alarms and refused orders.
    pub fn message(&self) -> Message {
        let it = match self {
            Self::Blocked(it) => it,
            Self::Interlock { actuator, input } => {
                return Message::new("detail", "interlock")
                    .with("actuator", actuator.name())
                    .with("input", input);
            }
            Self::OutOfStroke { .. } | Self::PartSize { .. } => {
                return Message::detail("impossible_motion", self);
            }
        };
        let mm = |value: f64| format!("{value:.1}");
        let message = Message::detail("collision", self)
            .with("actuator", it.stroke.actuator.name())
            .with("to_mm", mm(it.stroke.to_mm))
            .with("mover", &it.mover)
            .with("blocker", &it.blocker)
            .with("at_mm", it.at.map(mm).join(", "));
        match it.last_clear_mm {
            Some(clear) => message
                .with("clear_mm", format!("{clear:.2}"))
                .case("clear_up_to"),
            None => message,
        }
    }
}

impl fmt::Display for Blocked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.at;
        write!(
            f,
            "{} to {:.1} mm refused: {} would {} {} at x {x:.1}, y {y:.1}, z {z:.1} mm, {:.0} % of the way; {}{}",
            words(self.stroke.actuator.name()),
            self.stroke.to_mm,
            words(&self.mover),
            self.nearness(),
            words(&self.blocker),
            100.0 * self.at_fraction,
            self.offer(),
            self.would_help,
        )
    }
}

impl Blocked {
    fn offer(&self) -> String {
        self.last_clear_mm
            .map_or_else(String::new, |mm| format!("clear up to {mm:.2} mm; "))
    }

    fn nearness(&self) -> String {
        if self.distance_mm > 0.0 {
            return format!(
                "come within {:.2} mm (more than {:.2} mm needed) of",
                self.distance_mm, self.margin_mm
            );
        }
        "run into".to_owned()
    }
}

/// Returns the shop-floor words for the body with this id.
pub(super) fn words(id: &str) -> String {
    match id {
        "part_feed" => "the part coming from the magazine".to_owned(),
        "part_pocket" => "the part in the pocket".to_owned(),
        "part_pusher" => "the part before the pusher".to_owned(),
        "part_nest" => "the part in the nest".to_owned(),
        "part_gripper" => "the part in the gripper".to_owned(),
        other => other.replace('_', " "),
    }
}
