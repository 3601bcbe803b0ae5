//! The machine as pages show it: PackML state with its buttons, actuators, places, signals, wear.

use super::{MotionView, RackView};
use crate::dut::prompt::Prompt;
use serde::Serialize;
use std::collections::BTreeMap;
use texts::Message;
use utoipa::ToSchema;

/// The PackML state of the rig, and everything that a page shows with it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct Machine {
    /// State by its PackML name, for example `Execute`.
    pub state: String,
    /// `production`, `maintenance`, `manual`.
    pub mode: String,
    /// Every button, enabled or with the reason why it is disabled.
    pub buttons: Vec<Button>,
    /// Actuators in the order of the line.
    pub actuators: Vec<ActuatorView>,
    /// Parts by place: `pocket`, `nest`, `gripper`, `falling`, on a rack `socket_1` and so on; empty places are absent.
    pub places: BTreeMap<String, Token>,
    /// Names of the bins in the order of the line, or of the lists by which a rack is unloaded.
    pub bins: Vec<String>,
    /// Digital inputs by name; null when unread or stale.
    pub inputs: BTreeMap<String, Option<bool>>,
    /// Commanded digital outputs by name.
    pub outputs: BTreeMap<String, bool>,
    /// Reaction time to the emergency-stop input.
    pub reaction: Reaction,
    /// Motions that an operator may jog now, each with the guard's decision; empty while jogging is off.
    pub jogs: Vec<MotionView>,
    /// The last motion that the guard refused; null once another motion begins.
    pub refused: Option<MotionView>,
    /// Wall time spent in each phase of the cycle but `record` since the program started, seconds.
    pub phases_s: BTreeMap<String, f64>,
    /// Counts of strokes, touches and bounces since the program started, by name.
    pub wear: BTreeMap<String, u64>,
    /// Resistance of the two force contacts of the coil in series, ohm, mean over the last parts of the lot; null
    /// before the first.
    pub probe_contact_ohm: Option<f64>,
    /// Serial numbers scanned for parts that have not come, the oldest first; null in a lot whose parts are not
    /// scanned.
    pub scans: Option<Vec<String>>,
    /// Prompt that waits for its answer; null without one.
    pub prompt: Option<Prompt>,
    /// Rack with its batch; null on a rig with a feeder.
    pub rack: Option<RackView>,
}

/// One order that a button sends.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, ToSchema)]
pub struct Button {
    /// Name of the order, as in `POST /api/orders`.
    pub order: String,
    /// Motion, mode or alarm that the order names; empty without one.
    pub with: String,
    /// True when the station would accept the order now.
    pub enabled: bool,
    /// Reason for the refusal, English; empty when enabled.
    pub why_en: String,
    /// Reason for the refusal, Chinese; empty when enabled.
    pub why_zh: String,
    /// The reason as code and arguments; null when enabled.
    pub why: Option<Message>,
}

/// Possible positions of an actuator, from its sensors.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct ActuatorView {
    /// Name as in `config/scene.toml`.
    pub name: String,
    /// Lowest possible position, mm from the rest end.
    pub from_mm: f64,
    /// Highest possible position, mm; equal to `from_mm` when the actuator is known to rest there.
    pub to_mm: f64,
    /// True while the actuator moves.
    pub moving: bool,
}

/// A part in a place.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, ToSchema)]
pub struct Token {
    /// `lot` or `golden` (reference part); `unnumbered` before the nest.
    pub kind: String,
    /// Number in the lot, or serial number.
    pub name: String,
    /// Bin of the part; empty before its verdict.
    pub bin: String,
    /// Reason why the test was interrupted; empty without an interruption.
    pub interrupted: String,
    /// Serial number of a part of the lot; empty without one.
    pub serial: String,
}

/// Reaction time to the emergency-stop input, milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, ToSchema)]
pub struct Reaction {
    /// Worst case derived from `config/rig.toml`.
    pub bound_ms: f64,
    /// Longest reaction that the plant accepts.
    pub accepted_ms: f64,
    /// Longest age of the emergency-stop input since the program started.
    pub worst_age_ms: f64,
}
