//! Inquiry: what may be asked of the history, answered alike for command line, screens and sheets.
//!
//! | question | file |
//! |---|---|
//! | is this filter meant as it stands? | [`checks`] |
//! | figures of one parameter | [`figures`] |
//! | control charts of a parameter, or of the share of every bin | [`charts`] |
//! | lot report, certificate, list of alarms | [`paper`] |
//! | how the time of a lot was used | [`use_of_time`] |
//! | calibrations with their due dates, golden parts | [`instruments`] |
//! | what another recipe would have said of a lot | [`rejudge`] |
//! | all parts of a filter as CSV or spreadsheet | [`export`] |
//!
//! Between the history (rows), quality (arithmetic) and report (pages): each answer is put together here
//! once, so that a figure on the screen, on paper and in `--json` is the same figure. Nothing is written.

pub mod charts;
pub mod checks;
mod error;
pub mod export;
pub mod figures;
pub mod instruments;
pub mod paper;
pub mod rejudge;
mod use_of_time;

pub use error::{InquiryError, Result};

#[cfg(test)]
mod tests;
