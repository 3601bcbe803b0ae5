//! Levels of analog outputs, in whole steps of the configured notation.

use super::fields::Fields;
use super::request::Request;
use super::{ReplyError, TypeCode};
use std::fmt;
use thiserror::Error;

/// Notation of the output levels of a module; it follows from model and configuration word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputForm {
    /// 7021, 7021P, 7022: `05.000`, steps of 0.001 V or 0.001 mA, without sign.
    Engineering,
    /// 7024: `+05.000`, steps of 0.001 V or 0.001 mA, with sign.
    EngineeringSigned,
    /// `+050.00`, steps of 0.01 %.
    Percent,
    /// 7021, 7022: `000` to `FFF`.
    Hex12,
    /// 7021P: `0000` to `FFFF`.
    Hex16,
}

/// Reason why no level represents a value.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LevelError {
    /// The range has no scale, or the value is NaN.
    #[error("{value} cannot be scaled to type code {range:02X}")]
    NoScale {
        /// Value requested, in the unit of the range.
        value: f64,
        /// Type code of the range.
        range: u8,
    },
    /// The value is out of range; the module would drive the output to the nearest limit.
    #[error("level {value} is outside {low} to {high}")]
    OutOfRange {
        /// Value requested, in the unit of the range.
        value: f64,
        /// Lower limit, in the same unit.
        low: f64,
        /// Upper limit, in the same unit.
        high: f64,
    },
}

/// A level as a whole number of steps of its notation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level {
    form: OutputForm,
    steps: i32,
}

impl OutputForm {
    /// Returns the least and the greatest number of steps that the notation can write.
    fn limits(self) -> (i32, i32) {
        match self {
            Self::Engineering => (0, 99_999),
            Self::EngineeringSigned => (-99_999, 99_999),
            Self::Percent => (-10_000, 10_000),
            Self::Hex12 => (0, 0xFFF),
            Self::Hex16 => (0, 0xFFFF),
        }
    }

    /// Returns the number of characters of a level in a request.
    pub(super) fn width(self) -> usize {
        match self {
            Self::Engineering => 6,
            Self::EngineeringSigned | Self::Percent => 7,
            Self::Hex12 => 3,
            Self::Hex16 => 4,
        }
    }
}

impl Level {
    /// Creates a level from steps; returns `None` for a number of steps that the notation cannot write.
    pub fn from_steps(form: OutputForm, steps: i32) -> Option<Self> {
        let (least, greatest) = form.limits();
        (least..=greatest)
            .contains(&steps)
            .then_some(Self { form, steps })
    }

    /// Returns the level nearest to `value`, which is in the unit of `range`. Both ends of the range are allowed.
    pub fn nearest(form: OutputForm, range: TypeCode, value: f64) -> Result<Self, LevelError> {
        let scale = range.full_scale().filter(|_| value.is_finite());
        let scale = scale.ok_or(LevelError::NoScale {
            value,
            range: range.0,
        })?;
        let (low, high) = (scale.low, scale.high);
        let outside = LevelError::OutOfRange { value, low, high };
        if !(low..=high).contains(&value) {
            return Err(outside);
        }
        let steps = match form {
            OutputForm::Engineering | OutputForm::EngineeringSigned => value * 1000.0,
            OutputForm::Percent => share(value, low, high) * 10_000.0,
            OutputForm::Hex12 => (value - low) / (high - low) * f64::from(0xFFF),
            OutputForm::Hex16 => (value - low) / (high - low) * f64::from(0xFFFF),
        };
        Self::from_steps(form, steps.round() as i32).ok_or(outside)
    }

    /// Returns the notation.
    pub fn form(self) -> OutputForm {
        self.form
    }

    /// Returns the number of steps; a step is 0.001 of the unit, 0.01 % or one bit.
    pub fn steps(self) -> i32 {
        self.steps
    }

    /// Converts the level to the unit of `range`; `None` when the range has no scale.
    pub fn in_units(self, range: TypeCode) -> Option<f64> {
        let scale = range.full_scale()?;
        let (low, span) = (scale.low, scale.high - scale.low);
        let steps = f64::from(self.steps);
        Some(match self.form {
            OutputForm::Engineering | OutputForm::EngineeringSigned => steps / 1000.0,
            OutputForm::Percent if low < 0.0 => steps / 10_000.0 * scale.high,
            OutputForm::Percent => low + steps / 10_000.0 * span,
            OutputForm::Hex12 => low + steps / f64::from(0xFFF) * span,
            OutputForm::Hex16 => low + steps / f64::from(0xFFFF) * span,
        })
    }

    pub(super) fn encode(self, request: &mut Request<'_>) {
        let magnitude = self.steps.unsigned_abs();
        match self.form {
            OutputForm::Hex12 => request.hex(magnitude, 3),
            OutputForm::Hex16 => request.hex(magnitude, 4),
            OutputForm::Engineering => split(request, magnitude, 2, 3),
            OutputForm::EngineeringSigned => split(request.text(sign(self.steps)), magnitude, 2, 3),
            OutputForm::Percent => split(request.text(sign(self.steps)), magnitude, 3, 2),
        };
    }

    /// Reads a level from a request; `None` unless `text` is exactly one level.
    pub(super) fn read(form: OutputForm, text: &[u8]) -> Option<Self> {
        let mut fields = Fields::new(text);
        let level = Self::decode(form, &mut fields).ok()?;
        fields.end().ok().map(|()| level)
    }

    pub(super) fn decode(form: OutputForm, fields: &mut Fields<'_>) -> Result<Self, ReplyError> {
        let at = fields.at();
        let steps = match form {
            OutputForm::Hex12 => fields.hex(3)? as i32,
            OutputForm::Hex16 => fields.hex(4)? as i32,
            OutputForm::Engineering => joined(fields, 2, 3)?,
            OutputForm::EngineeringSigned => signed(fields)? * joined(fields, 2, 3)?,
            OutputForm::Percent => signed(fields)? * joined(fields, 3, 2)?,
        };
        Self::from_steps(form, steps).ok_or(ReplyError::OutOfRange { at })
    }
}

impl fmt::Display for Level {
    /// Writes `5.000`, `50.00 %`, or hex digits with their share of the span: `7FFF (50.00 %)`. It writes no unit,
    /// because the unit depends on the range of the output.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let steps = f64::from(self.steps);
        let share = 100.0 * steps / f64::from(self.form.limits().1);
        match self.form {
            OutputForm::Engineering | OutputForm::EngineeringSigned => {
                write!(f, "{:.3}", steps / 1000.0)
            }
            OutputForm::Percent => write!(f, "{share:.2} %"),
            OutputForm::Hex12 => write!(f, "{:03X} ({share:.2} %)", self.steps),
            OutputForm::Hex16 => write!(f, "{:04X} ({share:.2} %)", self.steps),
        }
    }
}

/// Returns `value` as a fraction: of the span for one-sided ranges, of the upper end for two-sided ones.
fn share(value: f64, low: f64, high: f64) -> f64 {
    if low < 0.0 {
        value / high
    } else {
        (value - low) / (high - low)
    }
}

fn sign(steps: i32) -> &'static [u8] {
    if steps < 0 { b"-" } else { b"+" }
}

fn split<'r, 'a>(
    request: &'r mut Request<'a>,
    magnitude: u32,
    whole: u32,
    places: u32,
) -> &'r mut Request<'a> {
    let unit = 10u32.pow(places);
    request
        .decimal(magnitude / unit, whole)
        .text(b".")
        .decimal(magnitude % unit, places)
}

fn joined(fields: &mut Fields<'_>, whole: usize, places: usize) -> Result<i32, ReplyError> {
    let before = fields.decimal(whole, 999)?;
    fields.filler(".")?;
    let after = fields.decimal(places, 999)?;
    Ok((before * 10u32.pow(places as u32) + after) as i32)
}

fn signed(fields: &mut Fields<'_>) -> Result<i32, ReplyError> {
    let at = fields.at();
    match fields.take(1)? {
        b"+" => Ok(1),
        b"-" => Ok(-1),
        _ => Err(ReplyError::BadField {
            at,
            expected: "+ -",
        }),
    }
}
