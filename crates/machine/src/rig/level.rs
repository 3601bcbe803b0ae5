//! Converts volts of the coil supply to the level of an analog output, with the calibration of that output.

use super::point::AnalogOutput;
use super::wiring::{Module, Wiring};
use dcon::{Level, LevelError};
use thiserror::Error;
use units::Volt;

/// Calibration of an analog output: volts at the terminal = `gain` x level written + `offset_v`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Gain, close to 1.
    pub gain: f64,
    /// Offset, close to 0, V at the terminal.
    pub offset_v: f64,
}

impl Correction {
    /// No correction: the value before any calibration.
    pub const NONE: Self = Self {
        gain: 1.0,
        offset_v: 0.0,
    };
}

/// Reason why an output cannot give its share of the coil supply.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SupplyError {
    /// The module of this point has no analog output.
    #[error("{point} is not wired to an analog output")]
    NotAnOutput {
        /// The output.
        point: &'static str,
    },
    /// The share lies outside the range of the output, or is NaN.
    #[error("{point} cannot give {supply}")]
    Level {
        /// The output.
        point: &'static str,
        /// The share requested, V of the coil supply.
        supply: Volt,
        /// Limit of the module.
        source: LevelError,
    },
}

/// Greatest distance below zero, V at the terminal, at which the output gets zero instead: the offset of the output
/// asks for it, and the output cannot go below zero. A lower level is an error.
const UNREACHABLE_OFFSET_V: f64 = 0.02;

impl Wiring {
    /// Checks that a source can give this share of the supply, V at the supply.
    ///
    /// # Errors
    /// Fails with the limit of the source.
    pub fn reaches(&self, point: AnalogOutput, supply: Volt) -> Result<(), SupplyError> {
        let terminal = self.analog_out(point);
        let (name, module) = (self.source_name(point), self.module(terminal.module));
        nearest_level(name, module, terminal.gain, supply, Correction::NONE).map(|_| ())
    }
}

/// Returns the level nearest to a share of the supply, and the share that this level gives. `gain`: supply volts per
/// terminal volt.
pub(super) fn nearest_level(
    point: &'static str,
    module: &Module,
    gain: f64,
    supply: Volt,
    correction: Correction,
) -> Result<(Level, Volt), SupplyError> {
    let form = module
        .output_form()
        .ok_or(SupplyError::NotAnOutput { point })?;
    let wanted = (supply.0 / gain - correction.offset_v) / correction.gain;
    let reachable = if (-UNREACHABLE_OFFSET_V..0.0).contains(&wanted) {
        0.0
    } else {
        wanted
    };
    let level =
        Level::nearest(form, module.type_code, reachable).map_err(|source| SupplyError::Level {
            point,
            supply,
            source,
        })?;
    let written = level
        .in_units(module.type_code)
        .ok_or(SupplyError::NotAnOutput { point })?;
    Ok((
        level,
        Volt((written * correction.gain + correction.offset_v) * gain),
    ))
}
