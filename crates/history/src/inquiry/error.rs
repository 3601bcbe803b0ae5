//! Why a question has no answer.

use crate::HistoryError;

/// What was asked cannot be meant, is not there, or could not be read.
#[derive(Debug, thiserror::Error)]
pub enum InquiryError {
    /// A member of the question that cannot be meant.
    #[error("{field}: {reason}")]
    Member {
        /// Its name: an option of the command line, a key of the query string.
        field: &'static str,
        /// Found and expected.
        reason: String,
    },
    /// The lot, recipe or part asked for never was.
    #[error("{what}")]
    NotThere {
        /// What is not there.
        what: String,
    },
    /// The history could not be read.
    #[error(transparent)]
    History(#[from] HistoryError),
    /// The answer could not be handed on.
    #[error("writing the answer")]
    Write(#[from] std::io::Error),
    /// The spreadsheet could not be made.
    #[error("making the spreadsheet")]
    Sheet(#[from] rust_xlsxwriter::XlsxError),
}

/// Shorthand of this module.
pub type Result<T> = std::result::Result<T, InquiryError>;

impl InquiryError {
    /// Found and expected of one member of a question.
    pub fn member(field: &'static str, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self::Member { field, reason }
    }

    /// What never was.
    pub fn not_there(what: impl Into<String>) -> Self {
        Self::NotThere { what: what.into() }
    }
}
