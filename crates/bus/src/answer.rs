//! The request that a line takes, the answer that it returns, and the reasons why it has no reply.

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
    /// Greatest number of tries, the first one included; at least 1. A command that changes something is sent only
    /// once.
    pub tries: u8,
}

/// The outcome of a request.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Ticket of the request.
    pub ticket: u64,
    /// Command of the request.
    pub command: Command,
    /// The decoded reply, or the reason why there is none.
    pub outcome: Result<Reply, LineError>,
    /// Characters received, without the CR; empty when none came.
    pub raw: String,
    /// Time at which the first character of the last try was sent.
    pub requested_at: RigTime,
    /// Time at which the reply was complete, or at which the line gave up.
    pub answered_at: RigTime,
    /// Number of tries, at least 1.
    pub tries_used: u8,
}

/// Reason why a transaction brought no valid reply. Each message names line, module, command and cause in one sentence,
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
    /// The module refused the command, or the bytes received are not a reply to it.
    #[error("line {line}, {command}: {reason}")]
    Reply {
        /// Name of the line.
        line: String,
        /// Command that was sent.
        command: Command,
        /// What is wrong with the reply, or the refusal of the module.
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
    /// Characters followed the reply. Two modules share the address, or another module replied late; the line rejects
    /// the reply either way.
    #[error("line {line}, {command}: more characters follow the reply")]
    SecondReply {
        /// Name of the line.
        line: String,
        /// Command that was sent.
        command: Command,
    },
    /// The reply may belong to an earlier request that timed out, and the module did not confirm it.
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
    /// Bytes kept arriving without a request since earlier trouble, so the line did not send the command.
    #[error("line {line}, {command}: not sent, the line never falls silent")]
    NeverSilent {
        /// Name of the line.
        line: String,
        /// Command that was not sent.
        command: Command,
    },
    /// The port was lost, or could not be opened.
    #[error("line {line}, {command}: port lost: {reason}")]
    PortLost {
        /// Name of the line.
        line: String,
        /// Command that was sent, or was to be sent.
        command: Command,
        /// Reason why the port is unusable; its text names the path.
        reason: PortError,
    },
}
