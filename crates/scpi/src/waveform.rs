//! Waveforms of digitizers: a preamble with the scales, then the samples as a block.

use serde::Deserialize;
use thiserror::Error;

/// How an instrument codes waveforms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Dialect {
    /// No waveforms.
    Scpi,
    /// Rigol: origin and reference of a voltage are both codes.
    Rigol,
    /// Keysight: the origin of a voltage is volts.
    Keysight,
}

/// Samples of a waveform at equal intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Time of the first sample relative to the trigger, s.
    pub start_s: f64,
    /// Interval between two samples, s; above 0.
    pub step_s: f64,
    /// Voltages at the input.
    pub volts: Vec<f32>,
}

/// Reason why a block is no waveform.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SamplesError {
    /// Instruments of this dialect have no waveforms.
    #[error("found a block, expected none from an instrument without waveforms")]
    NoWaveforms,
    /// The preamble does not have [`PREAMBLE`] numbers.
    #[error("the preamble of a waveform: found {found} numbers, expected {PREAMBLE}")]
    Preamble {
        /// Count of the numbers received.
        found: usize,
    },
    /// A number of the preamble has no meaning.
    #[error("the preamble of a waveform, number {at}: found {found}, expected {expected}")]
    Scale {
        /// Position in the preamble, from 0.
        at: usize,
        /// Number found.
        found: f64,
        /// Numbers that would be accepted.
        expected: &'static str,
    },
    /// The block does not have the samples that the preamble announces.
    #[error("a waveform: found {found} bytes, expected {expected}")]
    Length {
        /// Bytes received.
        found: usize,
        /// Bytes that the preamble announces.
        expected: usize,
    },
}

/// Count of the numbers of a preamble: format, kind, points, averages, then step, origin and reference of the time,
/// then those of the voltage.
const PREAMBLE: usize = 10;

/// Returns the samples of a block: bytes (format 0), or words with the low byte first (format 1).
///
/// # Errors
/// Fails when the preamble or the length of the block is not that of a waveform.
pub fn samples(dialect: Dialect, preamble: &[f64], block: &[u8]) -> Result<Samples, SamplesError> {
    let found = preamble.len();
    let &[
        format,
        _,
        points,
        _,
        dx,
        x0,
        x_reference,
        dy,
        y0,
        y_reference,
    ] = preamble
    else {
        return Err(SamplesError::Preamble { found });
    };
    let wrong = |at, expected| {
        let found = preamble[at];
        Err(SamplesError::Scale {
            at,
            found,
            expected,
        })
    };
    let width = match format {
        0.0 => 1,
        1.0 => 2,
        _ => return wrong(0, "0 for bytes or 1 for words"),
    };
    if dx <= 0.0 {
        return wrong(4, "a step of the time above 0");
    }
    if points.fract() != 0.0 || !(1.0..=1e9).contains(&points) {
        return wrong(2, "a whole number of points from 1");
    }
    let (found, expected) = (block.len(), points as usize * width);
    if found != expected {
        return Err(SamplesError::Length { found, expected });
    }
    let volts = |code: f64| match dialect {
        Dialect::Scpi => None,
        Dialect::Rigol => Some(((code - y0 - y_reference) * dy) as f32),
        Dialect::Keysight => Some(((code - y_reference) * dy + y0) as f32),
    };
    let code = |bytes: &[u8]| {
        let whole = bytes.iter().rev();
        let whole = whole.fold(0_u16, |sum, byte| sum << 8 | u16::from(*byte));
        volts(f64::from(whole))
    };
    let volts: Option<Vec<f32>> = block.chunks_exact(width).map(code).collect();
    Ok(Samples {
        start_s: x0 - x_reference * dx,
        step_s: dx,
        volts: volts.ok_or(SamplesError::NoWaveforms)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dialects_scale_voltages_in_their_ways() {
        let rigol = [0.0, 2.0, 2.0, 1.0, 1e-6, -2e-6, 0.0, 0.5, 4.0, 128.0];
        let volts = samples(Dialect::Rigol, &rigol, &[132, 134]);
        assert_eq!(volts.map(|it| it.volts), Ok(vec![0.0, 1.0]));
        let keysight = [1.0, 0.0, 2.0, 1.0, 1e-6, -2e-6, 0.0, 0.5, 4.0, 256.0];
        let words = samples(Dialect::Keysight, &keysight, &[0, 1, 2, 1]);
        let words = words.map(|it| (it.start_s, it.step_s, it.volts));
        assert_eq!(words, Ok((-2e-6, 1e-6, vec![4.0, 5.0])));
    }

    #[test]
    fn a_block_of_another_length_is_refused() {
        let preamble = [0.0, 2.0, 3.0, 1.0, 1e-6, 0.0, 0.0, 0.5, 0.0, 128.0];
        let refused = samples(Dialect::Rigol, &preamble, &[1, 2]);
        let (found, expected) = (2, 3);
        assert_eq!(refused, Err(SamplesError::Length { found, expected }));
    }

    #[test]
    fn a_preamble_without_meaning_is_refused() {
        let good = [0.0, 2.0, 1.0, 1.0, 1e-6, 0.0, 0.0, 0.5, 0.0, 128.0];
        for (at, value) in [(0, 4.0), (2, 0.5), (2, 0.0), (4, 0.0)] {
            let mut wrong = good;
            wrong[at] = value;
            let refused = samples(Dialect::Rigol, &wrong, &[1]);
            assert!(matches!(refused, Err(SamplesError::Scale { .. })), "{at}");
        }
        let short = samples(Dialect::Rigol, &good[..9], &[1]);
        assert_eq!(short, Err(SamplesError::Preamble { found: 9 }));
        let scpi = samples(Dialect::Scpi, &good, &[1]);
        assert_eq!(scpi, Err(SamplesError::NoWaveforms));
    }
}
