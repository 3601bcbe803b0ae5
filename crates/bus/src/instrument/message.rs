//! Failures of SCPI instruments as messages of the catalogue.

use scpi::Failure;
use texts::Message;

/// Returns the message of a failure: family `instrument`, and its code. The argument `said` has words of the instrument
/// or of the system.
pub fn message(failure: &Failure) -> Message {
    let message = Message::new("instrument", failure.code());
    match failure {
        Failure::Timeout { command, limit } => message
            .with("command", command)
            .with("limit_ms", limit.0 / 1000),
        Failure::Disconnected { reason } => message.with("said", reason),
        Failure::Malformed { command, reason } => {
            message.with("command", command).with("said", reason)
        }
        Failure::Instrument { code, text } => message.with("number", code).with("said", text),
        Failure::OverRange { command }
        | Failure::NotANumber { command }
        | Failure::OutOfStep { command } => message.with("command", command),
        Failure::Local { text } => message.with("said", text),
        Failure::Identity { found, expected } | Failure::AdapterAddress { found, expected } => {
            message.with("found", found).with("expected", expected)
        }
        Failure::ReadBack {
            command,
            found,
            expected,
        } => message
            .with("command", command)
            .with("found", found)
            .with("expected", expected),
        Failure::Overdue { limit } => message.with("limit_ms", limit.0 / 1000),
        Failure::Down { attempts, last } => message.with("attempts", attempts).with("said", last),
        Failure::QueueOverflow | Failure::PowerCycled | Failure::NeverSilent => message,
    }
}
