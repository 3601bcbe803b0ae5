//! The last traffic of the lines, frame by frame.

use serde::Serialize;

/// Traffic of one line.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct LineTraffic {
    /// Name in the wiring.
    pub line: String,
    /// Frames, oldest first.
    pub entries: Vec<Message>,
}

/// Message on a line, at most one frame.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Message {
    /// Rig time, microseconds since the run began.
    pub at_us: u64,
    /// `>` sent, `<` reply, `~` discarded.
    pub way: String,
    /// Characters; non-printable ones as `\r` or `\xNN`.
    pub text: String,
    /// Meaning of the reply and its request, in words; empty when the frame is a request.
    pub meaning: String,
}
