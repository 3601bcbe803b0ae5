//! Paper: what is printed, hung up or handed on. Pure: data in, text out; the command line writes files.
//!
//! | page | file |
//! |---|---|
//! | lot report | [`lot`] |
//! | certificate of one part, with the line that says what was not tested | [`certificate`] |
//! | control charts | [`spc`] |
//! | alarm list | [`alarms`] |
//! | operation process card of a recipe | [`card`] |
//! | spreadsheet with native charts | [`sheet`] |
//!
//! Every page is one HTML file for A4, complete in itself ([`page`]): no script, no font, no picture from
//! elsewhere, charts as SVG inside. Chinese or English ([`words`]); texts of operators are escaped, never
//! interpreted.

pub mod alarms;
pub mod card;
pub mod certificate;
mod charts;
pub mod lot;
mod page;
mod plot;
pub mod sheet;
pub mod spc;
pub mod svg;
mod words;

pub use texts::Lang;

use crate::Moment;
use jiff::{Timestamp, tz::TimeZone};

/// What all pages need to know beside their data.
#[derive(Debug, Clone)]
pub struct Paper {
    /// Lang of the words.
    pub language: Lang,
    /// Zone of the times; the history keeps UTC.
    pub zone: TimeZone,
    /// Foot of the page: when and by which program it was made.
    pub made: String,
}

impl Paper {
    /// Local time with its offset, to the second.
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
