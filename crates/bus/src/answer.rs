//! The request that a line takes, the answer that it returns, and the reasons why there is no reply.

use super::{PortError, words};
use dcon::{Command, Reply, ReplyError};
use std::fmt;
use std::io;
use texts::{Lang, Message};
use units::{RigTime, Span};

/// A command for the line to carry out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Request {
    /// Number chosen by the caller; the answer repeats it.
    pub ticket: u64,
    /// The command to send.
    pub command: Command,
    /// Greatest number of tries, the first one included; at least 1. The line never repeats a command that changes
    /// something.
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

/// A transaction without a valid reply. Its message names line, module, command and failure in one sentence, because
/// alarms and pages show only the message.
#[derive(Debug, Clone, PartialEq)]
pub struct LineError {
    /// Name of the line.
    pub line: String,
    /// Command that was sent, or was to be sent.
    pub command: Command,
    /// Reason why there is no valid reply.
    pub failure: Failure,
}

/// Reason why there is no valid reply.
#[derive(Debug, Clone, PartialEq)]
pub enum Failure {
    /// No complete reply arrived within this time.
    TimeOut(Span),
    /// The module refused the command, or the bytes received are not a reply to it.
    Reply(ReplyError),
    /// The line received its own request: the converter does not mute its receiver while it sends.
    Echo,
    /// Characters followed the reply. Two modules share the address, or another module replied late; the line rejects
    /// the reply either way.
    SecondReply,
    /// The reply may belong to an earlier request that timed out, and the module did not confirm it.
    OutOfStep,
    /// After a damaged reply from this address, the repeated reads disagree: two modules share the address, the line
    /// is disturbed, or the quantity changes faster than the line reads it.
    Contradicted,
    /// Bytes without a request kept arriving after earlier trouble: the line has only waited for silence, and sent
    /// nothing.
    NeverSilent,
    /// The port was lost, or could not be opened.
    PortLost(PortError),
}

impl Failure {
    /// Returns true when the module understood the command and refused it, so that a repetition changes nothing.
    pub fn is_answer(&self) -> bool {
        matches!(self, Self::Reply(reason) if reason.is_answer())
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        let kind = error.kind();
        Self::PortLost(PortError::Broken { kind })
    }
}

impl std::error::Error for LineError {}

impl fmt::Display for LineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message().say(Lang::En))
    }
}

impl LineError {
    /// Returns the message of family `transaction`, which names line, module, request and failure.
    pub fn message(&self) -> Message {
        let address = self.command.address();
        let address = address.map_or("**".to_owned(), |it| it.to_string());
        let of = |code| {
            Message::new("transaction", code)
                .with("line", &self.line)
                .with("address", &address)
                .with_inner("request", &words::request(&self.command))
        };
        match &self.failure {
            Failure::TimeOut(limit) => of("no_reply").with("limit_ms", limit.0 as f64 / 1000.0),
            Failure::Reply(why) => of("rejected").with_inner("rejection", &words::rejection(*why)),
            Failure::Echo => of("echo"),
            Failure::SecondReply => of("second_reply"),
            Failure::OutOfStep => of("out_of_step"),
            Failure::Contradicted => of("contradicted"),
            Failure::NeverSilent => of("never_silent"),
            Failure::PortLost(why @ PortError::Taken { .. }) => {
                of("port_lost").with("said", why).case("taken")
            }
            Failure::PortLost(why) => of("port_lost").with("said", why),
        }
    }
}
