//! Printable pages and spreadsheets. The functions here turn data into text or cells and open no file of their own.
//!
//! | page | file |
//! |---|---|
//! | lot report | [`lot`] |
//! | certificate of one part, with the line that says what was not tested | [`certificate`] |
//! | control charts | [`spc`] |
//! | alarm list | [`alarms`] |
//! | lots side by side | [`comparison`] |
//! | operation process card of a recipe | [`card`] |
//! | plan for tooling, with its drawings | [`plan`], [`plan_drawing`] |
//! | spreadsheet with native charts | [`sheet`] |
//!
//! A page is one self-contained HTML file for A4 ([`page`]), without scripts, fonts or external pictures; charts are
//! inline SVG. Pages are Chinese or English ([`words`]); texts typed by people are escaped.

pub mod alarms;
mod batch;
pub mod card;
pub mod certificate;
mod charts;
pub mod comparison;
mod curves;
mod data_matrix;
mod external;
pub mod lot;
mod page;
mod pareto;
pub mod plan;
pub mod plan_drawing;
mod plot;
pub mod sheet;
mod sheet_cells;
pub mod spc;
pub mod svg;
mod words;

pub use external::sentence as external_sentence;
pub use texts::Lang;
pub use words::significant;
pub(crate) use words::{figure, parameter, short_hash};

use crate::Moment;
use jiff::{Timestamp, tz::TimeZone};

/// Settings of a page.
#[derive(Debug, Clone)]
pub struct Paper {
    /// Language of the page.
    pub language: Lang,
    /// Time zone in which the page shows times; the history has UTC.
    pub zone: TimeZone,
    /// Text at the foot of the page: time and program version.
    pub made: String,
    /// True for parts of the simulated rig: SIMULATION goes across every page.
    pub simulated: bool,
}

impl Paper {
    /// Formats an instant as local time with offset, to the second.
    pub fn time(&self, at: Moment) -> String {
        match Timestamp::from_microsecond(at.0) {
            Ok(stamp) => {
                let local = stamp.to_zoned(self.zone.clone());
                local.strftime("%Y-%m-%d %H:%M:%S %:z").to_string()
            }
            Err(_) => at.to_string(),
        }
    }
}

#[cfg(test)]
mod tests;
