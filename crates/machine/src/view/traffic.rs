//! The last traffic of the lines, message by message.

use serde::Serialize;

/// Of one line.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct LineTraffic {
    /// As wired.
    pub line: String,
    /// Oldest first.
    pub entries: Vec<Message>,
}

/// What went over the wire at once.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Message {
    /// Rig time, microseconds since the run began.
    pub at_us: u64,
    /// `>` sent, `<` heard, `~` heard and thrown away.
    pub way: String,
    /// Its characters, those that cannot be printed as `\r` or `\xNN`.
    pub text: String,
    /// What was asked and answered, in words; empty for a question.
    pub meaning: String,
}
