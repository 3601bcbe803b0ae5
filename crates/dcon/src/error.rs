//! Reasons why a reply is not accepted.

use super::Address;
use thiserror::Error;

/// Reason why a reply is not accepted. [`ReplyError::is_answer`] distinguishes a refusal by the module from a damaged
/// reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum ReplyError {
    /// `?AA`: the module understood the command but refused it (no such channel, out of range, needs INIT*, an
    /// alarm controls the output).
    #[error("the module refused the command")]
    Refused,
    /// `!` alone: the host watchdog has tripped; outputs keep their safe values until its status is cleared.
    #[error("the module ignored the output: its host watchdog has tripped")]
    Ignored,
    /// The command is a broadcast, which has no reply.
    #[error("a broadcast has no reply")]
    Broadcast,
    /// The frame has no characters before its end.
    #[error("empty reply")]
    Empty,
    /// The frame does not end in CR, and only the CR could prove it complete.
    #[error("the reply does not end in CR")]
    NotEnded,
    /// The frame is longer than any reply of the protocol.
    #[error("{length} characters, more than any reply has")]
    TooLong {
        /// Number of characters received.
        length: usize,
    },
    /// A byte is not printable ASCII.
    #[error("byte {byte:#04x} at position {at} is not a printable ASCII character")]
    NotText {
        /// Position of the byte in the reply, from 0.
        at: usize,
        /// Value of the byte.
        byte: u8,
    },
    /// The frame is too short for a checksum, or does not end in two upper-case hex digits.
    #[error("no checksum at the end of the reply")]
    ChecksumMissing,
    /// The checksum does not match the characters.
    #[error("checksum {found:02X} received, {expected:02X} computed")]
    ChecksumWrong {
        /// Checksum received.
        found: u8,
        /// Checksum computed.
        expected: u8,
    },
    /// The first character (lead) is that of another kind of reply.
    #[error("lead `{}` received, `{}` expected", *found as char, *expected as char)]
    WrongLead {
        /// First character received.
        found: u8,
        /// First character of a valid reply.
        expected: u8,
    },
    /// Another module answered.
    #[error("reply from address {found}, expected {expected}")]
    WrongAddress {
        /// Address in the reply.
        found: Address,
        /// Address in the request.
        expected: Address,
    },
    /// The reply has more or fewer characters than this command allows.
    #[error("{found} characters before the checksum, not a valid length of this reply")]
    WrongLength {
        /// Number of characters received, without checksum and CR.
        found: usize,
    },
    /// A field does not have the form that the protocol prescribes.
    #[error("no {expected} at position {at}")]
    BadField {
        /// Position of the field in the reply, from 0.
        at: usize,
        /// Name of the expected field.
        expected: &'static str,
    },
    /// A field has the right form, but a value that the module cannot send.
    #[error("{what} out of range at position {at}")]
    OutOfRange {
        /// Position of the field in the reply, from 0.
        at: usize,
        /// Quantity that the field holds.
        what: &'static str,
    },
}

impl ReplyError {
    /// Returns true when the module understood and refused: the line works, and a repetition changes nothing.
    pub fn is_answer(self) -> bool {
        matches!(self, Self::Refused | Self::Ignored)
    }

    /// Returns true when the checksum shows that characters were damaged.
    pub fn is_checksum(self) -> bool {
        matches!(self, Self::ChecksumMissing | Self::ChecksumWrong { .. })
    }
}
