//! Errors of inquiries.

use crate::HistoryError;

/// Reason why an inquiry has no answer.
#[derive(Debug, thiserror::Error)]
pub enum InquiryError {
    /// A member of the filter is invalid.
    #[error("{field}: {reason}")]
    Member {
        /// Name of the option, or of the key in the query string.
        field: &'static str,
        /// What was found and what was expected.
        reason: String,
    },
    /// The lot, recipe or part does not exist.
    #[error("{what}")]
    Missing {
        /// Description of the missing thing.
        what: String,
    },
    /// The history could not be read.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// The answer could not be written.
    #[error("writing the answer")]
    Write(#[from] std::io::Error),
    /// The spreadsheet could not be made.
    #[error("making the spreadsheet")]
    Sheet(#[from] rust_xlsxwriter::XlsxError),
}

/// Result of an inquiry.
pub type Result<T> = std::result::Result<T, InquiryError>;

impl InquiryError {
    /// Makes the error about an invalid member.
    pub fn member(field: &'static str, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self::Member { field, reason }
    }

    /// Makes the error about a missing lot, recipe or part.
    pub fn missing(what: impl Into<String>) -> Self {
        Self::Missing { what: what.into() }
    }
}
