//! Models and ranges of analog outputs, and the text format of output values.

use super::range::Format;
use crate::dcon;

/// Differences between the models.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Model {
    pub(super) channels: u8,
    pub(super) bits: i32,
    /// True when data must contain a sign (7024).
    pub(super) signed: bool,
    /// True when data may contain a sign.
    pub(super) takes_sign: bool,
    /// True when commands contain a channel digit.
    pub(super) numbered: bool,
    /// True when each channel has a type and a slew rate of its own (7022).
    pub(super) own_slew: bool,
    /// True when `$AA8` returns a measurement at the terminals.
    pub(super) true_readback: bool,
}

/// Limits of an output range, and whether it is a current.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Span {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) is_current: bool,
}

/// Returns the range of a type code; `None` when the model does not have it.
pub(super) fn span(model: Model, type_code: u8) -> Option<Span> {
    let (low, high, is_current) = match type_code {
        0x30 => (0.0, 20.0, true),
        0x31 => (4.0, 20.0, true),
        0x32 => (0.0, 10.0, false),
        0x33 if model.signed => (-10.0, 10.0, false),
        0x34 if model.signed => (0.0, 5.0, false),
        0x35 if model.signed => (-5.0, 5.0, false),
        _ => return None,
    };
    Some(Span {
        low,
        high,
        is_current,
    })
}

/// Returns the model with this number.
pub(super) fn model(number: &str) -> Model {
    let one = Model {
        channels: 1,
        bits: 12,
        signed: false,
        takes_sign: false,
        numbered: false,
        own_slew: false,
        true_readback: true,
    };
    let several = Model {
        numbered: true,
        true_readback: false,
        ..one
    };
    match number {
        "7021P" => Model { bits: 16, ..one },
        "7022" => Model {
            channels: 2,
            own_slew: true,
            ..several
        },
        "7024" => Model {
            channels: 4,
            bits: 14,
            signed: true,
            ..several
        },
        _ => one,
    }
}

/// Parses the data of an output command.
pub(super) fn read(model: Model, format: Format, span: Span, data: &[u8]) -> Data {
    match format {
        Format::Hex => {
            let digits = if model.bits > 12 { 4 } else { 3 };
            match dcon::hex(data) {
                Some(code) if data.len() == digits => {
                    let top = 16f64.powi(digits as i32) - 1.0;
                    Data::Value(span.low + f64::from(code) / top * (span.high - span.low))
                }
                Some(_) => Data::WrongWidth,
                None => Data::Nonsense,
            }
        }
        Format::Percent => match fixed(data, true, 3, 2) {
            Data::Value(percent) => {
                Data::Value(span.low + percent / 100.0 * (span.high - span.low))
            }
            other => other,
        },
        Format::Engineering => match data {
            [b'+' | b'-', _, b'.', _, _, _] if model.takes_sign => fixed(data, true, 1, 3),
            _ => fixed(data, model.signed, 2, 3),
        },
    }
}

/// Formats a value of the output.
pub(super) fn format_value(model: Model, format: Format, span: Span, value: f64) -> String {
    let fraction = (value - span.low) / (span.high - span.low);
    match format {
        Format::Hex => {
            let digits: u32 = if model.bits > 12 { 4 } else { 3 };
            let top = 16f64.powi(digits as i32) - 1.0;
            let mut text = String::new();
            let code = (fraction.clamp(0.0, 1.0) * top).round() as u64;
            dcon::push_hex(&mut text, code, digits);
            text
        }
        Format::Percent => format!("{:+07.2}", (fraction * 100.0).max(0.0)),
        Format::Engineering if model.signed => format!("{value:+07.3}"),
        Format::Engineering => format!("{:06.3}", value.max(0.0)),
    }
}

/// Parsed data of an output command.
pub(super) enum Data {
    Value(f64),
    WrongWidth,
    Nonsense,
}

/// Parses `ddd.dd` and similar forms, with or without a leading sign.
fn fixed(data: &[u8], signed: bool, whole: usize, decimals: usize) -> Data {
    let alphabet = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'+' | b'-' | b'.');
    if data.is_empty() || !data.iter().all(alphabet) {
        return Data::Nonsense;
    }
    let (sign, digits) = match data {
        [b'+', rest @ ..] if signed => (1.0, rest),
        [b'-', rest @ ..] if signed => (-1.0, rest),
        rest if !signed => (1.0, rest),
        _ => return Data::WrongWidth,
    };
    let form = digits.len() == whole + 1 + decimals
        && digits.iter().enumerate().all(|(place, byte)| {
            (*byte == b'.') == (place == whole) && !matches!(byte, b'+' | b'-')
        });
    match std::str::from_utf8(digits)
        .ok()
        .and_then(|text| text.parse::<f64>().ok())
    {
        Some(value) if form => Data::Value(sign * value),
        _ => Data::WrongWidth,
    }
}
