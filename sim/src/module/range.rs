//! Ranges of analog inputs, and the text of a reading in the three data formats.
//!
//! A reading is a fraction of full scale after quantising: -1 to 1 (0 to 1 for a range without a negative side),
//! infinite outside the range. Plain voltage ranges saturate at their ends; current, thermocouple and RTD ranges show
//! `+9999.9` instead.

use crate::dcon;

/// Range of an analog input, selected by a type code TT.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Value at +FS, unit of the engineering format (V, mV, mA, C).
    pub full_scale: f64,
    /// Lowest value, unit of the engineering format.
    pub lowest: f64,
    /// Decimals of the engineering format; its width is always 7.
    pub decimals: usize,
    /// Factor from the terminal value (V, mA, C) to the engineering value: 1000 for mV ranges.
    pub per_terminal: f64,
    /// True when the range shows over-range text instead of saturating.
    pub shows_over: bool,
    /// True when hexadecimal codes have no sign.
    pub unipolar: bool,
}

/// Data format, the low two bits of FF.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Sign, five digits and a point.
    Engineering,
    /// Percent of full scale.
    Percent,
    /// Two's complement, four digits.
    Hex,
}

impl Format {
    /// Names in configuration files, in the order of their codes in FF.
    pub const NAMES: [&str; 3] = ["engineering", "percent", "hex"];

    /// Reads the format from FF; `None` for the invalid code 11.
    pub fn of(ff: u8) -> Option<Self> {
        match ff & 0b11 {
            0b00 => Some(Self::Engineering),
            0b01 => Some(Self::Percent),
            0b10 => Some(Self::Hex),
            _ => None,
        }
    }
}

impl Range {
    /// Returns the full-scale fraction of a terminal value; infinite outside the range.
    pub fn fraction(&self, terminal: f64) -> f64 {
        let value = terminal * self.per_terminal;
        let fraction = value / self.full_scale;
        if !self.shows_over {
            return fraction.clamp(self.lowest / self.full_scale, 1.0);
        }
        // Half a unit in the last place beyond the limit counts as the limit.
        let slack = 0.5 * 10f64.powi(-(self.decimals as i32));
        if value > self.full_scale + slack {
            f64::INFINITY
        } else if value < self.lowest - slack {
            f64::NEG_INFINITY
        } else {
            fraction.clamp(self.lowest / self.full_scale, 1.0)
        }
    }

    /// Appends the text of a reading in `format`.
    pub fn format_value(&self, fraction: f64, format: Format, text: &mut String) {
        use std::fmt::Write as _;
        let over = fraction.is_infinite();
        // Writing to a String cannot fail.
        let _ = match format {
            Format::Hex => {
                dcon::push_hex(text, u64::from(self.code(fraction)), 4);
                Ok(())
            }
            Format::Engineering if over => write!(text, "{:+07.1}", 9999.9 * fraction.signum()),
            Format::Percent if over => write!(text, "{:+07.2}", 999.99 * fraction.signum()),
            Format::Engineering => {
                let digits = self.decimals;
                let value = fraction * self.full_scale;
                write!(text, "{:+07.digits$}", without_minus_zero(value, digits))
            }
            Format::Percent => write!(text, "{:+07.2}", without_minus_zero(fraction * 100.0, 2)),
        };
    }

    /// Returns the hexadecimal code: 8000 to 7FFF, or 0000 to FFFF for a current range without a negative side. A
    /// temperature range without a negative side begins at 0000, with 8000 for under range and 7FFF for over range.
    pub fn code(&self, fraction: f64) -> u16 {
        if self.unipolar {
            return (fraction.clamp(0.0, 1.0) * 65_535.0).round() as u16;
        }
        let code = (fraction.clamp(-1.0, 1.0) * 32_768.0).round();
        code.clamp(-32_768.0, 32_767.0) as i16 as u16
    }
}

fn without_minus_zero(value: f64, decimals: usize) -> f64 {
    let half_step = 0.5 * 10f64.powi(-(decimals as i32));
    if value.abs() < half_step { 0.0 } else { value }
}

/// Returns the range of a 7017 or 7018 with this type code; `None` for a code that they lack.
pub fn voltage_range(type_code: u8) -> Option<Range> {
    let (full_scale, decimals, per_terminal) = match type_code {
        0x00 => (15.0, 3, 1e3),
        0x01 => (50.0, 3, 1e3),
        0x02 => (100.0, 2, 1e3),
        0x03 | 0x0B => (500.0, 2, 1e3),
        0x04 | 0x0A => (1.0, 4, 1.0),
        0x05 => (2.5, 4, 1.0),
        0x08 => (10.0, 3, 1.0),
        0x09 => (5.0, 4, 1.0),
        0x0C => (150.0, 2, 1e3),
        0x1B => (150.0, 2, 1.0),
        0x1C => (50.0, 3, 1.0),
        _ => return current_range(type_code).or_else(|| thermocouple_range(type_code)),
    };
    Some(Range {
        full_scale,
        lowest: -full_scale,
        decimals,
        per_terminal,
        shows_over: false,
        unipolar: false,
    })
}

fn current_range(type_code: u8) -> Option<Range> {
    let lowest = match type_code {
        0x06 | 0x0D => -20.0,
        0x07 => 4.0,
        0x1A => 0.0,
        _ => return None,
    };
    Some(Range {
        full_scale: 20.0,
        lowest,
        decimals: 3,
        per_terminal: 1.0,
        shows_over: true,
        unipolar: lowest >= 0.0,
    })
}

/// Checks whether a type code of a 7018 is for a thermocouple.
pub fn is_thermocouple(type_code: u8) -> bool {
    thermocouple_range(type_code).is_some()
}

fn thermocouple_range(type_code: u8) -> Option<Range> {
    let (full_scale, lowest) = match type_code {
        0x0E => (760.0, -210.0),
        0x0F => (1372.0, -270.0),
        0x10 => (400.0, -270.0),
        0x11 => (1000.0, -270.0),
        0x12 | 0x13 => (1768.0, 0.0),
        0x14 => (1820.0, 0.0),
        0x15 => (1300.0, -270.0),
        0x16 => (2320.0, 0.0),
        0x17 => (800.0, -200.0),
        0x18 => (100.0, -200.0),
        0x19 => (900.0, -200.0),
        _ => return None,
    };
    Some(Range {
        full_scale,
        lowest,
        decimals: 1,
        per_terminal: 1.0,
        shows_over: true,
        unipolar: false,
    })
}

/// Returns the range of the RTD module with this type code, degrees Celsius; `None` for a code that it lacks.
pub fn rtd_range(type_code: u8) -> Option<Range> {
    let (full_scale, lowest) = match type_code {
        0x20 | 0x24 => (100.0, -100.0),
        0x21 | 0x25 => (100.0, 0.0),
        0x22 | 0x26 => (200.0, 0.0),
        0x23 | 0x27 => (600.0, 0.0),
        _ => return None,
    };
    Some(Range {
        full_scale,
        lowest,
        decimals: 2,
        per_terminal: 1.0,
        shows_over: true,
        unipolar: false,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn formatted(range: Range, terminal: f64, format: Format) -> String {
        let mut text = String::new();
        range.format_value(range.fraction(terminal), format, &mut text);
        text
    }

    #[test]
    fn ten_volts_read_in_all_three_formats() {
        let range = voltage_range(0x08).unwrap();
        assert_eq!(formatted(range, 5.0, Format::Engineering), "+05.000");
        assert_eq!(formatted(range, 5.0, Format::Percent), "+050.00");
        assert_eq!(formatted(range, 10.0, Format::Hex), "7FFF");
        assert_eq!(formatted(range, -10.0, Format::Hex), "8000");
        assert_eq!(formatted(range, -0.0001, Format::Engineering), "+00.000");
    }

    #[test]
    fn voltage_saturates_and_current_shows_over_range() {
        assert_eq!(
            formatted(voltage_range(0x08).unwrap(), 13.0, Format::Engineering),
            "+10.000"
        );
        let current = voltage_range(0x0D).unwrap();
        assert_eq!(formatted(current, 21.0, Format::Engineering), "+9999.9");
        assert_eq!(formatted(current, -21.0, Format::Percent), "-999.99");
        assert_eq!(formatted(current, 21.0, Format::Hex), "7FFF");
    }

    #[test]
    fn every_engineering_field_is_seven_characters_wide() {
        for code in 0..=0x27 {
            let Some(range) = voltage_range(code).or(rtd_range(code)) else {
                continue;
            };
            let full = range.full_scale / range.per_terminal;
            assert_eq!(
                formatted(range, full, Format::Engineering).len(),
                7,
                "type {code:02X}"
            );
        }
    }
}
