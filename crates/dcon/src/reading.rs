//! Readings of analog inputs: the characters as sent, and their meaning.
//!
//! A reading is a number, or one of three states that must never become a number: over range, under range, and blank
//! (the channel is disabled). The end values of the hex notation (7FFF, 8000) count as over and under range, because
//! the true value may lie anywhere beyond them.

use super::fields::Fields;
use super::frame::hex_number;
use super::{DataFormat, InputForm, ReplyError, TypeCode};

/// Value of a channel, in the notation of the module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// Value in the unit of the range.
    Engineering(f64),
    /// Value in percent of full scale.
    Percent(f64),
    /// Value in two's complement, 32768 = full scale.
    Hex(i16),
    /// Value of a range that begins at zero: 0 = lower end, 65535 = upper end.
    HexUnipolar(u16),
    /// At or above the upper end of the notation.
    OverRange,
    /// At or below the lower end of the notation.
    UnderRange,
    /// The channel is disabled.
    Blank,
}

impl Value {
    /// Converts the value to the unit of `range`; `None` for a state that is not a number, and for a range without a
    /// scale.
    pub fn in_units(self, range: TypeCode) -> Option<f64> {
        let scale = range.full_scale()?;
        let span = scale.high - scale.low;
        match self {
            Self::Engineering(value) => Some(value),
            Self::Percent(percent) if range.unipolar_input() => {
                Some(scale.low + percent / 100.0 * span)
            }
            Self::Percent(percent) => Some(percent / 100.0 * scale.high),
            Self::Hex(steps) => Some(f64::from(steps) / 32768.0 * scale.high),
            Self::HexUnipolar(steps) => Some(scale.low + f64::from(steps) / 65535.0 * span),
            Self::OverRange | Self::UnderRange | Self::Blank => None,
        }
    }
}

/// Reading of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// The decoded value.
    pub value: Value,
    text: [u8; 7],
    length: u8,
}

impl Reading {
    /// Returns the characters as sent.
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.text[..usize::from(self.length)]).unwrap_or_default()
    }

    /// Decodes the characters that come next as one reading.
    pub(super) fn decode(
        form: InputForm,
        width: usize,
        fields: &mut Fields<'_>,
    ) -> Result<Self, ReplyError> {
        let at = fields.at();
        let field = fields.take(width)?;
        let value = if field.iter().all(|byte| *byte == b' ') {
            Value::Blank
        } else {
            match form.format {
                DataFormat::Hex => hex(field, form.range).ok_or(ReplyError::BadField {
                    at,
                    expected: "0-9 A-F",
                }),
                DataFormat::Engineering => engineering(field, form.range, at),
                DataFormat::Percent => percent(field, at),
            }?
        };
        let mut text = [0; 7];
        text[..width].copy_from_slice(field);
        Ok(Self {
            value,
            text,
            length: width as u8,
        })
    }
}

/// Returns the number of characters of one reading.
pub(super) fn width(format: DataFormat) -> usize {
    match format {
        DataFormat::Engineering | DataFormat::Percent => 7,
        DataFormat::Hex => 4,
    }
}

/// Readings of all channels of a module, channel 0 first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Readings {
    list: [Option<Reading>; 8],
}

impl Readings {
    pub(super) fn decode(form: InputForm, fields: &mut Fields<'_>) -> Result<Self, ReplyError> {
        let mut list = [None; 8];
        for slot in list.iter_mut().take(usize::from(form.channels())) {
            *slot = Some(Reading::decode(form, width(form.format), fields)?);
        }
        Ok(Self { list })
    }

    /// Returns one reading; `None` when the module has no such channel.
    pub fn get(&self, channel: usize) -> Option<Reading> {
        self.list.get(channel).copied().flatten()
    }

    /// Iterates in the order of the channels.
    pub fn iter(&self) -> impl Iterator<Item = &Reading> {
        self.list.iter().flatten()
    }
}

fn hex(field: &[u8], range: TypeCode) -> Option<Value> {
    let steps = hex_number(field)? as u16;
    if range.is_warm() {
        // Nothing below the lower end exists here; some makers send FFFF and 0000 for a broken and a shorted wire.
        return Some(match steps {
            0x7FFF | 0xFFFF => Value::OverRange,
            0 | 0x8000..=0xFFFE => Value::UnderRange,
            1..=0x7FFE => Value::Hex(steps as i16),
        });
    }
    Some(match (range.unipolar_input(), steps) {
        (true, 0xFFFF) | (false, 0x7FFF) => Value::OverRange,
        (false, 0x8000) => Value::UnderRange,
        (true, steps) => Value::HexUnipolar(steps),
        (false, steps) => Value::Hex(steps as i16),
    })
}

fn engineering(field: &[u8], range: TypeCode, at: usize) -> Result<Value, ReplyError> {
    let number = match decimal(field) {
        Some(Decimal::Number(number)) => number,
        Some(Decimal::Nines { negative }) => return Ok(beyond(negative)),
        None => {
            return Err(ReplyError::BadField {
                at,
                expected: "±00.000",
            });
        }
    };
    // Inputs saturate slightly above full scale, by less than the permitted quarter of the span.
    let plausible = range.full_scale().is_none_or(|scale| {
        let slack = (scale.high - scale.low) / 4.0;
        (scale.low - slack..=scale.high + slack).contains(&number)
    });
    if plausible {
        Ok(Value::Engineering(number))
    } else {
        Err(ReplyError::OutOfRange { at })
    }
}

fn percent(field: &[u8], at: usize) -> Result<Value, ReplyError> {
    match decimal(field) {
        Some(Decimal::Nines { negative }) => Ok(beyond(negative)),
        Some(Decimal::Number(number)) if number.abs() > 125.0 => Err(ReplyError::OutOfRange { at }),
        Some(Decimal::Number(number)) if field.get(4) == Some(&b'.') => Ok(Value::Percent(number)),
        Some(Decimal::Number(_)) | None => Err(ReplyError::BadField {
            at,
            expected: "±000.00",
        }),
    }
}

fn beyond(negative: bool) -> Value {
    if negative {
        Value::UnderRange
    } else {
        Value::OverRange
    }
}

enum Decimal {
    Number(f64),
    /// Digits that are all nines: the code of the module for over or under range.
    Nines {
        negative: bool,
    },
}

/// Parses five digits with a decimal point among them, after a sign. Only an over-range reading may lack the sign.
fn decimal(field: &[u8]) -> Option<Decimal> {
    let (negative, digits) = match field {
        [b'+', rest @ ..] => (false, rest),
        [b'-', rest @ ..] => (true, rest),
        b"9999.9" => return Some(Decimal::Nines { negative: false }),
        _ => return None,
    };
    let point = digits.iter().position(|byte| *byte == b'.')?;
    let places = digits.len() - 1 - point;
    if digits.len() != 6 || point == 0 || places == 0 {
        return None;
    }
    let mut whole = 0u32;
    for byte in digits.iter().filter(|byte| **byte != b'.') {
        whole = whole * 10 + u32::from(byte.checked_sub(b'0').filter(|digit| *digit <= 9)?);
    }
    if digits.iter().filter(|byte| **byte == b'.').count() != 1 {
        return None;
    }
    if whole == 99_999 {
        return Some(Decimal::Nines { negative });
    }
    let magnitude = f64::from(whole) / 10f64.powi(places as i32);
    Some(Decimal::Number(if negative {
        -magnitude
    } else {
        magnitude
    }))
}
