//! The request that a line takes, the answer that it returns, and the reasons why there is no reply.

use super::PortError;
use dcon::{Command, Reply, ReplyError};
use thiserror::Error;
use units::{RigTime, Span};

/// A command for the line to carry out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Number chosen by the caller; the answer repeats it.
    pub ticket: u64,
    /// The command to send.
    pub command: Command,
    /// Most tries, the first included, at least 1. A command that changes something is sent once, whatever this says.
    pub tries: u8,
}

/// The outcome of a request.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Ticket of the request.
    pub ticket: u64,
    /// Command of the request.
    pub command: Command,
    /// The decoded reply, or why there is none.
    pub outcome: Result<Reply, LineError>,
    /// Characters received, without CR; empty when none came.
    pub raw: String,
    /// Time at which the first character of the last try was sent.
    pub requested_at: RigTime,
    /// Time at which the reply was complete, or the line gave it up.
    pub answered_at: RigTime,
    /// Number of tries, at least 1.
    pub tries_used: u8,
}

/// Why a transaction brought no valid reply. Each message names line, module, command and cause in one sentence,
/// because alarms and pages show only the message.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LineError {
    /// No complete reply arrived in time.
    #[error("line {line}, {command}: no whole reply within {} ms", limit.0 as f64 / 1000.0)]
    TimeOut {
        /// Name of the line.
        line: String,
        /// Command that was sent.
        command: Command,
        /// Time allowed for the reply.
        limit: Span,
    },
    /// The module declined, or the bytes are no reply to this command.
    #[error("line {line}, {command}: {reason}")]
    Reply {
        /// Name of the line.
        line: String,
        /// Command that was sent.
        command: Command,
        /// Defect of the reply, or the module's refusal.
        reason: ReplyError,
    },
    /// The line received its own request: the converter does not mute its receiver while it sends.
    #[error("line {line}, {command}: the line received its own request (echo)")]
    Echo {
        /// Name of the line.
        line: String,
        /// Command that was sent.
        command: Command,
    },
    /// Characters followed the reply: two modules share the address, or another module replied late. The line rejects
    /// both.
    #[error("line {line}, {command}: more characters follow the reply")]
    SecondReply {
        /// Name of the line.
        line: String,
        /// Command that was sent.
        command: Command,
    },
    /// An earlier, timed-out request may have caused this reply, and the module did not confirm it.
    #[error("line {line}, {command}: reply rejected, it may be a late reply to an earlier request")]
    OutOfStep {
        /// Name of the line.
        line: String,
        /// Command that was sent.
        command: Command,
    },
    /// After a damaged reply from this address, the repeated reads disagree: two modules share the address, the line
    /// is disturbed, or the quantity changes faster than the line reads it.
    #[error(
        "line {line}, {command}: reply rejected, repeated reads disagree after damaged replies"
    )]
    Contradicted {
        /// Name of the line.
        line: String,
        /// Command that was sent.
        command: Command,
    },
    /// A module sends without a request and does not stop; the line sent nothing.
    #[error("line {line}, {command}: not sent, the line never falls silent")]
    NeverSilent {
        /// Name of the line.
        line: String,
        /// Command that was not sent.
        command: Command,
    },
    /// The port is lost or never opened.
    #[error("line {line}, {command}: port lost: {reason}")]
    PortLost {
        /// Name of the line.
        line: String,
        /// Command that was sent, or was to be sent.
        command: Command,
        /// Why the port is unusable; names its path.
        reason: PortError,
    },
}
