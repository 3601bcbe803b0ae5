//! The last traffic of the lines, frame by frame.

use serde::Serialize;
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// Traffic of one line.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, ToSchema)]
pub struct LineTraffic {
    /// Name in the wiring.
    pub line: String,
    /// Frames, oldest first.
    pub entries: Vec<Message>,
}

/// Message on a line, at most one frame.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = TrafficMessage)]
pub struct Message {
    /// Rig time, microseconds since the run began.
    pub at_us: u64,
    /// `>` sent, `<` reply, `~` discarded.
    pub way: String,
    /// Characters; non-printable ones as `\r` or `\xNN`.
    pub text: String,
    /// Meaning of the reply, with its request, in English; empty for a request, unless it goes to all modules.
    pub meaning: String,
    /// Meaning of the reply in Chinese.
    pub meaning_zh: String,
    /// Digital signals that the reply reads or confirms, by their names in the wiring; true while present.
    pub signals: BTreeMap<String, bool>,
}
