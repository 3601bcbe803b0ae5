//! An order as a page, a script or the command line gives it.

use crate::handling::Move;
use crate::station::orders::{JOG_NAMES, jog};
use crate::station::packml::{Command, Mode};
use serde::{Deserialize, Serialize};
use texts::Message;
use utoipa::ToSchema;

/// Makes a module for values that an order gives by name: serde functions and a schema that lists `$names`.
macro_rules! by_name {
    ($module:ident, $kind:ty, $names:expr, $name:expr, $named:expr) => {
        mod $module {
            use super::*;
            use serde::de::Error;
            use serde::{Deserializer, Serializer};
            use utoipa::openapi::schema::Type;
            use utoipa::openapi::{Object, ObjectBuilder};

            pub(super) fn serialize<S: Serializer>(it: &$kind, out: S) -> Result<S::Ok, S::Error> {
                out.serialize_str($name(*it))
            }

            pub(super) fn deserialize<'de, D: Deserializer<'de>>(
                input: D,
            ) -> Result<$kind, D::Error> {
                let word = String::deserialize(input)?;
                $named(&word).ok_or_else(|| D::Error::unknown_variant(&word, $names))
            }

            pub(super) fn schema() -> Object {
                let words = Some($names.iter().copied());
                ObjectBuilder::new()
                    .schema_type(Type::String)
                    .enum_values(words)
                    .build()
            }
        }
    };
}
by_name!(mode, Mode, Mode::NAMES, Mode::name, Mode::from_name);
by_name!(motion, Move, &JOG_NAMES, Move::code, jog);

/// An order: its word and the members that belong to it; parsing refuses any other member.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "order", rename_all = "snake_case", deny_unknown_fields)]
pub enum Order {
    /// Makes the machine ready.
    Reset {},
    /// Begins the named lot; without a lot, continues the lot under way.
    Start {
        /// Name of the lot.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schema(nullable = false, example = "L-1123")]
        lot: Option<String>,
        /// Name of the recipe of the lot; needs `lot`. Without it, a lot keeps the recipe with which it began.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schema(nullable = false, example = "jzc-22f-012")]
        recipe: Option<String>,
        /// Number of parts, from 1; needs `lot`. Without it, the lot continues until an order ends it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schema(nullable = false, example = 100, minimum = 1)]
        count: Option<u64>,
        /// Name of the person who agreed to test parts a second time; needs `lot`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schema(nullable = false, example = "zhao")]
        retest: Option<String>,
    },
    /// Finishes the parts inside and stops.
    Stop {},
    /// Pauses for a reason inside the machine.
    Hold {},
    /// Continues after a hold.
    Unhold {},
    /// Pauses for a reason outside the machine.
    Suspend {},
    /// Continues after a suspension.
    Unsuspend {},
    /// Stops at once.
    Abort {},
    /// Clears an abort once its causes are gone.
    Clear {},
    /// Ends the run once the parts inside are finished.
    Complete {},
    /// Changes the mode.
    Mode {
        /// The new mode.
        #[serde(with = "mode")]
        #[schema(schema_with = mode::schema)]
        mode: Mode,
    },
    /// Drives one motion by hand.
    Jog {
        /// The motion.
        #[serde(with = "motion")]
        #[schema(schema_with = motion::schema)]
        motion: Move,
    },
    /// Drives the next motion of the sequence, in mode `maintenance`.
    Step {},
    /// Lights all lamps and sounds the buzzer briefly.
    LampTest {},
    /// Acknowledges an alarm.
    Acknowledge {
        /// Code of the alarm; without it all alarms.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schema(nullable = false, example = "door_open")]
        alarm: Option<String>,
    },
    /// Names the part that a person is about to load by its serial number, in a lot whose parts are scanned.
    Scan {
        /// Serial number as scanned, printable ASCII.
        #[schema(example = "L-1122-000017", min_length = 1, max_length = 64)]
        serial: String,
    },
    /// Forgets the newest scan whose part has not come.
    Unscan {},
    /// Answers the prompt that waits at the rig.
    Answer {
        /// Name of the prompt.
        #[schema(example = "load_reference_parts")]
        prompt: String,
        /// Name of one of its choices.
        #[schema(example = "loaded")]
        choice: String,
    },
    /// Hides an alarm for a number of minutes.
    Shelve {
        /// Code of the alarm.
        #[schema(example = "door_open")]
        alarm: String,
        /// Time, minutes; 30 if absent.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schema(nullable = false, example = 60, minimum = 1, maximum = 480)]
        minutes: Option<u32>,
        /// Reason for hiding the alarm.
        #[schema(example = "the sensor is on its way")]
        reason: String,
    },
    /// Forbids runs of the lot until an order `release_lot`.
    HoldLot {
        /// Name of the lot.
        #[schema(example = "L-1122")]
        lot: String,
        /// Reason for the hold.
        #[schema(example = "wrong label on the reel")]
        reason: String,
    },
    /// Allows runs of the lot again.
    ReleaseLot {
        /// Name of the lot.
        #[schema(example = "L-1122")]
        lot: String,
        /// Reason for the release.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schema(nullable = false, example = "label was corrected")]
        reason: Option<String>,
    },
    /// Closes the lot, even if parts are missing.
    CloseLot {
        /// Name of the lot.
        #[schema(example = "L-1122")]
        lot: String,
        /// Reason for closing.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schema(nullable = false, example = "rest of the reel returned")]
        reason: Option<String>,
    },
    /// Allows runs of a complete lot again.
    ReopenLot {
        /// Name of the lot.
        #[schema(example = "L-1122")]
        lot: String,
        /// Reason for reopening.
        #[schema(example = "forty parts were found")]
        reason: String,
    },
    /// Resets the wear counter of a part of the machine after its replacement.
    Replaced {
        /// Name of the counter.
        #[schema(example = "probe_touches")]
        counter: String,
    },
}

impl Order {
    /// Returns the word of the order, as JSON has it.
    pub fn word(&self) -> String {
        let json = serde_json::to_value(self).unwrap_or_default();
        json["order"].as_str().unwrap_or_default().to_owned()
    }
}

impl From<Command> for Order {
    fn from(command: Command) -> Self {
        match command {
            Command::Reset => Self::Reset {},
            Command::Start => Self::Start {
                lot: None,
                recipe: None,
                count: None,
                retest: None,
            },
            Command::Stop => Self::Stop {},
            Command::Hold => Self::Hold {},
            Command::Unhold => Self::Unhold {},
            Command::Suspend => Self::Suspend {},
            Command::Unsuspend => Self::Unsuspend {},
            Command::Abort => Self::Abort {},
            Command::Clear => Self::Clear {},
            Command::Complete => Self::Complete {},
        }
    }
}

/// Person who gives an order, and the network address from which it comes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct By {
    /// Name at login.
    pub who: String,
    /// Role at login.
    pub role: String,
    /// Network address of the browser or script.
    pub origin: String,
}

/// An order with its outcome, for the audit trail.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AnsweredOrder {
    /// The order as the person gave it.
    pub order: Order,
    /// The person who gave the order.
    pub by: By,
    /// The refusal; `None` for an accepted order.
    pub refused: Option<Message>,
}
