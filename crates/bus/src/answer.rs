//! What goes into a line and what comes out of it.

use super::PortError;
use dcon::{Command, Reply, ReplyError};
use thiserror::Error;
use units::{RigTime, Span};

/// One command to be carried out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Comes back in the answer.
    pub ticket: u64,
    /// What to send.
    pub command: Command,
    /// Most tries, the first included; commands that change something have one whatever this says.
    pub tries: u8,
}

/// What became of a request.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Of the request.
    pub ticket: u64,
    /// Of the request.
    pub command: Command,
    /// The reply, or why there is none.
    pub outcome: Result<Reply, LineError>,
    /// The characters heard, CR left off; empty when none were.
    pub raw: String,
    /// When the first character of the last try was sent.
    pub asked_at: RigTime,
    /// When the reply was whole, or given up.
    pub answered_at: RigTime,
    /// At least 1.
    pub tries_used: u8,
}

/// Why a transaction brought no reply that can be believed. Each says line, module, command and cause in one sentence:
/// alarms and screens show nothing else.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LineError {
    /// Nothing, or no end, in time.
    #[error("line {line}, {command}: no whole reply within {} ms", limit.0 as f64 / 1000.0)]
    TimeOut {
        /// Name of the line.
        line: String,
        /// What was asked.
        command: Command,
        /// Time that the reply had.
        limit: Span,
    },
    /// The module declined, or what came is no reply to this command.
    #[error("line {line}, {command}: {reason}")]
    Reply {
        /// Name of the line.
        line: String,
        /// What was asked.
        command: Command,
        /// What is the matter with it.
        reason: ReplyError,
    },
    /// The request came back: the converter does not mute its receiver while it sends.
    #[error("line {line}, {command}: the line echoes the request")]
    Echo {
        /// Name of the line.
        line: String,
        /// What was asked.
        command: Command,
    },
    /// Characters followed the reply: two modules at one address, or a late neighbour. Neither is believed.
    #[error("line {line}, {command}: more characters behind the reply")]
    SecondReply {
        /// Name of the line.
        line: String,
        /// What was asked.
        command: Command,
    },
    /// A module that was given up may have said this; the one that was asked did not confirm it.
    #[error(
        "line {line}, {command}: not believed, a late reply of another question may be on the line"
    )]
    OutOfStep {
        /// Name of the line.
        line: String,
        /// What was asked.
        command: Command,
    },
    /// A reply of this address was damaged before; asked again, the module said something else each time. Two modules at
    /// one address, a disturbed line, or a quantity that changes faster than it is asked.
    #[error(
        "line {line}, {command}: not believed, another value when asked again after damaged replies"
    )]
    Contradicted {
        /// Name of the line.
        line: String,
        /// What was asked.
        command: Command,
    },
    /// Somebody talks without being asked, and does not stop. Nothing was sent.
    #[error("line {line}, {command}: not sent, the line does not fall silent")]
    NeverSilent {
        /// Name of the line.
        line: String,
        /// What should have been asked.
        command: Command,
    },
    /// There is no port.
    #[error("line {line}, {command}: port lost: {reason}")]
    PortLost {
        /// Name of the line.
        line: String,
        /// What was, or should have been, asked.
        command: Command,
        /// Why it cannot be used; names its path.
        reason: PortError,
    },
}
