//! Cells of a spreadsheet: formats of numbers and instants.

use super::sheet::EPOCH_DAYS;
use crate::Moment;
use crate::columns::Cell;
use jiff::tz::TimeZone;
use jiff::{Timestamp, Unit};
use rust_xlsxwriter::{Format, Worksheet, XlsxError};

/// Formats of cells: an instant, and numbers with 0 to 9 decimals.
pub(super) struct Formats {
    time: Format,
    decimals: Vec<Format>,
}

impl Formats {
    /// Makes all formats.
    pub fn new() -> Self {
        let decimals = (0..10).map(|n| match n {
            0 => Format::new().set_num_format("0"),
            n => Format::new().set_num_format(format!("0.{}", "0".repeat(n))),
        });
        Self {
            time: Format::new().set_num_format("yyyy-mm-dd hh:mm:ss"),
            decimals: decimals.collect(),
        }
    }

    /// Writes a number. The cell keeps all digits and shows `decimals` decimals, or for `None` five significant digits
    /// as on paper.
    pub fn number(
        &self,
        to: &mut Worksheet,
        (row, column): (u32, u16),
        value: Option<f64>,
        decimals: Option<usize>,
    ) -> Result<(), XlsxError> {
        let Some(value) = value.filter(|it| it.is_finite()) else {
            return Ok(());
        };
        let significant = || match value == 0.0 {
            true => 0,
            false => (4.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize,
        };
        let decimals = decimals.unwrap_or_else(significant);
        to.write_number_with_format(row, column, value, &self.decimals[decimals])?;
        Ok(())
    }
}

/// Writes a cell; leaves it empty for an instant beyond the range of the calendar.
pub(super) fn written(
    to: &mut Worksheet,
    (row, column): (u32, u16),
    cell: &Cell<'_>,
    (zone, formats): (&TimeZone, &Formats),
) -> Result<(), XlsxError> {
    match cell {
        Cell::Empty => {}
        Cell::Text(text) if text.is_empty() => {}
        Cell::Text(text) => {
            to.write_string(row, column, text.as_ref())?;
        }
        Cell::Count(count) => {
            to.write_number(row, column, *count as f64)?;
        }
        Cell::Number(number) => formats.number(to, (row, column), Some(*number), None)?,
        Cell::Time(at) => {
            if let Some(at) = serial(*at, zone) {
                to.write_number_with_format(row, column, at, &formats.time)?;
            }
        }
    }
    Ok(())
}

/// Converts an instant to the serial date of a spreadsheet: local time in days, to the second; `None` beyond the range
/// of the calendar.
fn serial(at: Moment, zone: &TimeZone) -> Option<f64> {
    let stamp = Timestamp::from_microsecond(at.0).ok()?;
    let stamp = stamp.round(Unit::Second).ok()?;
    let local = stamp.as_second() + i64::from(zone.to_offset(stamp).seconds());
    Some(local as f64 / 86_400.0 + EPOCH_DAYS)
}
