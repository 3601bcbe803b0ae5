//! Reasons why a program of queries returns no values. None of them says anything about the part under test.

use super::reply::ReplyError;
use thiserror::Error;
use units::Span;

/// Reason why a program returns no values.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum Failure {
    /// No reply arrived in time.
    #[error("{command}: no reply within {} ms", limit.0 / 1000)]
    Timeout {
        /// Command that was sent.
        command: String,
        /// Time allowed.
        limit: Span,
    },
    /// There is no connection, or it was lost.
    #[error("no connection: {reason}")]
    Disconnected {
        /// Port or host, and the system's reason.
        reason: String,
    },
    /// The reply does not have the form that the query prescribes.
    #[error("{command}: {reason}")]
    Malformed {
        /// Command that was sent.
        command: String,
        /// Defect of the reply.
        reason: ReplyError,
    },
    /// The instrument reports an error.
    #[error("the instrument reports error {code}, {text:?}")]
    Instrument {
        /// Number of the error.
        code: i32,
        /// Error text of the instrument.
        text: String,
    },
    /// The error queue of the instrument has lost errors, or does not become empty.
    #[error("the error queue of the instrument has overflowed")]
    QueueOverflow,
    /// A result exceeds the range of the instrument.
    #[error("{command}: the result is over range")]
    OverRange {
        /// Command that was sent.
        command: String,
    },
    /// The instrument returned "not a number" as the result.
    #[error("{command}: the result is not a number")]
    NotANumber {
        /// Command that was sent.
        command: String,
    },
    /// The front panel controls the instrument.
    #[error("the instrument is in local mode: {text:?}")]
    Local {
        /// Text of the instrument.
        text: String,
    },
    /// The instrument that answers is another one than expected.
    #[error("found instrument {found:?}, expected {expected}")]
    Identity {
        /// Identity received.
        found: String,
        /// Maker and model, or the whole identity of the instrument that answered before.
        expected: String,
    },
    /// The instrument was switched off and on, which lost its set-up.
    #[error("the instrument was switched off and on")]
    PowerCycled,
    /// Replies and queries are out of step, so the values are not those of their queries.
    #[error("{command}: replies and queries are out of step")]
    OutOfStep {
        /// Command whose reply shows this.
        command: String,
    },
    /// A setting that the program read back differs from the expected one.
    #[error("{command}: found {found:?}, expected {expected:?}")]
    ReadBack {
        /// Query that reads the setting.
        command: String,
        /// Reply.
        found: String,
        /// Reply that was expected.
        expected: String,
    },
    /// The GPIB adapter addresses another instrument than that of the link, because another program uses the adapter.
    #[error("the adapter has GPIB address {found:?}, expected {expected}")]
    AdapterAddress {
        /// Address line from the adapter.
        found: String,
        /// GPIB address of the link.
        expected: String,
    },
    /// Bytes keep arriving without a query.
    #[error("the link never falls silent")]
    NeverSilent,
    /// The program did not end within its time.
    #[error("not finished within {} ms", limit.0 / 1000)]
    Overdue {
        /// Time allowed for the program, including the resynchronisation before it.
        limit: Span,
    },
    /// Several attempts failed to bring queries and replies into step.
    #[error("the link is down after {attempts} attempts: {last}")]
    Down {
        /// Number of attempts.
        attempts: u8,
        /// Failure of the last attempt.
        last: Box<Failure>,
    },
}

impl Failure {
    /// Every code, in the order of the variants.
    pub const CODES: [&'static str; 16] = [
        "timeout",
        "disconnected",
        "malformed",
        "instrument",
        "queue_overflow",
        "over_range",
        "not_a_number",
        "local",
        "wrong_identity",
        "power_cycled",
        "out_of_step",
        "read_back",
        "adapter_address",
        "never_silent",
        "overdue",
        "link_down",
    ];

    /// Returns the name of the failure, one of [`Failure::CODES`].
    pub const fn code(&self) -> &'static str {
        let at = match self {
            Self::Timeout { .. } => 0,
            Self::Disconnected { .. } => 1,
            Self::Malformed { .. } => 2,
            Self::Instrument { .. } => 3,
            Self::QueueOverflow => 4,
            Self::OverRange { .. } => 5,
            Self::NotANumber { .. } => 6,
            Self::Local { .. } => 7,
            Self::Identity { .. } => 8,
            Self::PowerCycled => 9,
            Self::OutOfStep { .. } => 10,
            Self::ReadBack { .. } => 11,
            Self::AdapterAddress { .. } => 12,
            Self::NeverSilent => 13,
            Self::Overdue { .. } => 14,
            Self::Down { .. } => 15,
        };
        Self::CODES[at]
    }

    /// Returns true when queries and replies may be out of step: the link then delivers nothing before a
    /// resynchronisation.
    pub const fn is_doubt(&self) -> bool {
        match self {
            Self::OverRange { .. } | Self::NotANumber { .. } | Self::Instrument { .. } => false,
            Self::ReadBack { .. } => false,
            Self::Timeout { .. } | Self::Disconnected { .. } | Self::Malformed { .. } => true,
            Self::QueueOverflow | Self::Local { .. } | Self::Identity { .. } => true,
            Self::PowerCycled | Self::OutOfStep { .. } | Self::AdapterAddress { .. } => true,
            Self::NeverSilent | Self::Overdue { .. } | Self::Down { .. } => true,
        }
    }
}
