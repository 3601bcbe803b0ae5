//! Inquiries into the history; command line, page and exports get the same answers.
//!
//! | answer | file |
//! |---|---|
//! | whether the values of a filter are valid | [`checks`] |
//! | statistics of one parameter | [`figures`] |
//! | control charts of a parameter, or of the share of every bin | [`charts`] |
//! | lot report, certificate, list of alarms | [`paper`] |
//! | reasons of rejects and alarms, the most frequent first | [`pareto`] |
//! | lots side by side, with tests of equality | [`comparison`] |
//! | readings of a gauge study | [`gauge`] |
//! | use of the time of a lot (OEE) | [`use_of_time`] |
//! | calibrations with their due dates, reference parts | [`instruments`] |
//! | verdicts of another recipe on a lot | [`rejudge`] |
//! | what the rigs of a database do and made | [`rigs`] |
//! | all parts of a filter as CSV or spreadsheet | [`export`] |
//!
//! An inquiry combines rows of the history with the arithmetic of crate `quality`, so page, paper and `--json` show the
//! same figure. Inquiries write nothing.

pub mod charts;
pub mod checks;
pub mod comparison;
mod error;
pub mod export;
pub mod figures;
pub mod gauge;
pub mod instruments;
pub mod paper;
pub mod pareto;
pub mod rejudge;
pub mod rigs;
pub mod shifts;
mod use_of_time;

pub use error::{InquiryError, Result};

#[cfg(test)]
mod tests;
