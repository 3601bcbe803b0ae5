//! Reasons why a reply is not accepted.

use super::Address;
use super::describe::Description;
use std::fmt;

/// Reason why a reply is not accepted. [`ReplyError::is_answer`] distinguishes a refusal by the module from a damaged
/// reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReplyError {
    /// `?AA`, or `?` to an output: the module understood the command but refused it (no such channel, out of range,
    /// needs INIT*, an alarm controls the output).
    Refused,
    /// `!` alone: the host watchdog has tripped; outputs keep their safe values until its status is cleared.
    Ignored,
    /// The command is a broadcast, which has no reply.
    Broadcast,
    /// The frame has no characters before its end.
    Empty,
    /// The frame does not end in CR, and nothing else proves it complete.
    NotEnded,
    /// The frame is longer than any reply of the protocol.
    TooLong {
        /// Number of characters received.
        length: usize,
    },
    /// A byte is not printable ASCII.
    NotText {
        /// Position of the byte in the reply, from 0.
        at: usize,
        /// Value of the byte.
        byte: u8,
    },
    /// The frame is too short for a checksum, or does not end in two upper-case hex digits.
    ChecksumMissing,
    /// The checksum does not match the characters.
    ChecksumWrong {
        /// Checksum received.
        found: u8,
        /// Checksum computed.
        expected: u8,
    },
    /// The first character (lead) is that of another kind of reply.
    WrongLead {
        /// First character received.
        found: u8,
        /// First character of a valid reply.
        expected: u8,
    },
    /// Another module answered.
    WrongAddress {
        /// Address in the reply.
        found: Address,
        /// Address in the request.
        expected: Address,
    },
    /// The reply has more or fewer characters than this command allows.
    WrongLength {
        /// Number of characters received, without checksum and CR.
        found: usize,
    },
    /// A field does not have the form that the protocol prescribes.
    BadField {
        /// Position of the field in the reply, from 0.
        at: usize,
        /// Characters that the protocol allows in this field.
        expected: &'static str,
    },
    /// A field has the right form, but a value that the module cannot send.
    OutOfRange {
        /// Position of the field in the reply, from 0.
        at: usize,
    },
}

impl std::error::Error for ReplyError {}

impl fmt::Display for ReplyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.describe().fmt(f)
    }
}

impl ReplyError {
    /// Describes the reason by a code and its arguments.
    pub fn describe(self) -> Description {
        let one = Description::new;
        match self {
            Self::Refused => one("refused"),
            Self::Ignored => one("ignored"),
            Self::Broadcast => one("no_reply_to_all"),
            Self::Empty => one("empty"),
            Self::NotEnded => one("not_ended"),
            Self::TooLong { length } => one("too_long").with("length", length),
            Self::NotText { at, byte } => one("not_text")
                .with("position", at)
                .with("found", format_args!("{byte:02X}")),
            Self::ChecksumMissing => one("checksum_missing"),
            Self::ChecksumWrong { found, expected } => one("checksum_wrong")
                .with("found", format_args!("{found:02X}"))
                .with("expected", format_args!("{expected:02X}")),
            Self::WrongLead { found, expected } => one("wrong_lead")
                .with("found", char::from(found))
                .with("expected", char::from(expected)),
            Self::WrongAddress { found, expected } => one("wrong_address")
                .with("found", found)
                .with("expected", expected),
            Self::WrongLength { found } => one("wrong_length").with("length", found),
            Self::BadField { at, expected } => one("bad_field")
                .with("position", at)
                .with("expected", expected),
            Self::OutOfRange { at } => one("out_of_range").with("position", at),
        }
    }

    /// Returns true when the module understood the command and refused it: the line works, and a repetition changes
    /// nothing.
    pub fn is_answer(self) -> bool {
        matches!(self, Self::Refused | Self::Ignored)
    }

    /// Returns true when the checksum shows that characters were damaged.
    pub fn is_checksum(self) -> bool {
        matches!(self, Self::ChecksumMissing | Self::ChecksumWrong { .. })
    }
}
