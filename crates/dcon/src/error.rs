//! Why a reply was not taken for a value.

use super::Address;
use thiserror::Error;

/// The reason. [`ReplyError::is_answer`] tells a module that said no from a line that garbled its words.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum ReplyError {
    /// `?AA`: understood but refused (no such channel, out of range, needs INIT*, an alarm owns the output).
    #[error("the module refused the command")]
    Refused,
    /// Bare `!`: the host watchdog has tripped, outputs stay at their safe values until the status is cleared.
    #[error("the module ignored the output: its host watchdog has tripped")]
    Ignored,
    /// The command is a broadcast; whatever was heard is no reply to it.
    #[error("a broadcast has no reply")]
    NotAsked,
    /// Nothing between the ends of the frame.
    #[error("empty reply")]
    Empty,
    /// The frame does not end in CR although only the CR can tell that it is whole.
    #[error("the reply does not end in CR")]
    NotEnded,
    /// Longer than any reply of the protocol.
    #[error("{length} characters, more than any reply has")]
    TooLong {
        /// Characters heard.
        length: usize,
    },
    /// A byte that is no printable ASCII.
    #[error("byte {byte:#04x} at position {at} is no character of the protocol")]
    NotText {
        /// Position from the lead.
        at: usize,
        /// The byte.
        byte: u8,
    },
    /// Too short to hold a checksum, or no two upper-case hex digits where it belongs.
    #[error("no checksum at the end of the reply")]
    ChecksumMissing,
    /// The characters do not add up.
    #[error("checksum {found:02X} where the characters add up to {expected:02X}")]
    ChecksumWrong {
        /// As sent.
        found: u8,
        /// As computed.
        expected: u8,
    },
    /// Another kind of reply than this command has.
    #[error("lead `{}` where `{}` was expected", *found as char, *expected as char)]
    WrongLead {
        /// As sent.
        found: u8,
        /// Of a good reply.
        expected: u8,
    },
    /// Another module's answer.
    #[error("address {found} answered, {asked} was asked")]
    WrongAddress {
        /// In the reply.
        found: Address,
        /// In the request.
        asked: Address,
    },
    /// More or fewer characters than the reply to this command has.
    #[error("{found} characters before the checksum, which is no length of this reply")]
    WrongLength {
        /// Characters from the lead, checksum and CR left out.
        found: usize,
    },
    /// A field that does not follow its grammar.
    #[error("no {expected} at position {at}")]
    BadField {
        /// Position from the lead.
        at: usize,
        /// What should have been there.
        expected: &'static str,
    },
    /// Well formed, but beyond what the module can say.
    #[error("{what} out of range at position {at}")]
    OutOfRange {
        /// Position from the lead.
        at: usize,
        /// The quantity.
        what: &'static str,
    },
}

impl ReplyError {
    /// True when the module understood and declined: the line is in order and asking again changes nothing.
    pub fn is_answer(self) -> bool {
        matches!(self, Self::Refused | Self::Ignored)
    }

    /// True when the characters themselves were damaged.
    pub fn is_checksum(self) -> bool {
        matches!(self, Self::ChecksumMissing | Self::ChecksumWrong { .. })
    }
}
