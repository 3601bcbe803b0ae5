//! The machine as a screen shows it: outer state with its buttons, actuators, places, signals, stops, wear.

use super::MotionView;
use serde::Serialize;
use std::collections::BTreeMap;
use texts::Message;

/// Outer machine and what may be asked of it.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Machine {
    /// State by its PackML name, `Execute`.
    pub state: String,
    /// `production`, `maintenance`, `manual`.
    pub mode: String,
    /// Every button, live or with the reason why not.
    pub buttons: Vec<Button>,
    /// Actuators in the order of the line.
    pub actuators: Vec<ActuatorView>,
    /// Parts by place: `pocket`, `nest`, `gripper`, `falling`; a place without a part is not named.
    pub places: BTreeMap<String, Token>,
    /// Digital inputs by name; null while not read or stale.
    pub inputs: BTreeMap<String, Option<bool>>,
    /// Digital outputs by name, as asked for.
    pub outputs: BTreeMap<String, bool>,
    /// Reaction to the emergency-stop input.
    pub reaction: Reaction,
    /// Motions that may be jogged now, each as the guard judges it; empty while none may.
    pub jogs: Vec<MotionView>,
    /// The motion that the guard refused last; null once another one was driven.
    pub refused: Option<MotionView>,
    /// Wall seconds that the cycle has spent in each phase of its turns since the start.
    pub phases_s: BTreeMap<String, f64>,
    /// Strokes and touches since the start of the program, by name.
    pub wear: BTreeMap<String, u64>,
    /// Force contacts of the coil in series, ohm, mean over the last parts of the lot; null before the first.
    pub probe_contact_ohm: Option<f64>,
}

/// One order that a button gives.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Button {
    /// Word of the order.
    pub order: String,
    /// Motion, mode or alarm that goes with it, empty when none does.
    pub with: String,
    /// It would be taken now.
    pub enabled: bool,
    /// Why not, English; empty when enabled.
    pub why_en: String,
    /// Why not, Chinese; empty when enabled.
    pub why_zh: String,
    /// The same as code and arguments; null when enabled.
    pub why: Option<Message>,
}

/// Where an actuator is, as far as its sensors tell.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ActuatorView {
    /// Name as in `config/scene.toml`.
    pub name: String,
    /// Lowest position it may have, mm from its rest end.
    pub from_mm: f64,
    /// Highest; equal to `from_mm` when it is known to stand there.
    pub to_mm: f64,
    /// A motion of it is under way.
    pub moving: bool,
}

/// A part in a place.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Token {
    /// `lot` or `golden`; `unnumbered` before the nest.
    pub kind: String,
    /// Number in the lot, or serial.
    pub name: String,
    /// Bin it belongs to, empty before it was judged.
    pub bin: String,
    /// Why it is not tested, empty when nothing interrupted it.
    pub interrupted: String,
}

/// Reaction to the emergency-stop input, milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Reaction {
    /// Worst case derived from `config/rig.toml`.
    pub bound_ms: f64,
    /// What the plant accepts.
    pub accepted_ms: f64,
    /// Longest age of the emergency-stop input seen since the start.
    pub worst_age_ms: f64,
}
