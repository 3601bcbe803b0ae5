//! Queries: programs that a procedure runs on SCPI instruments, and what the instruments deliver.

pub use crate::rig::instruments::Instrument;
use scpi::{Dialect, Reply, SamplesError, number};
use std::sync::Arc;

/// A program of an instrument's profile with its arguments.
#[derive(Debug, Clone, PartialEq)]
pub struct Query {
    /// Instrument that runs the program.
    pub instrument: Instrument,
    /// Name of the program in the profile.
    pub program: &'static str,
    /// Arguments by name; the name ends with the unit.
    pub arguments: Vec<(&'static str, f64)>,
    /// Quantities that the trace makes of the waveform; empty for a program that reads none.
    pub shows: Vec<Shown>,
}

/// A quantity that a waveform shows: `offset + factor * volts`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Name under which the trace keeps it.
    pub name: &'static str,
    /// Unit of the quantity.
    pub unit: &'static str,
    /// Resolution of stored values, in the unit of the quantity, above 0.
    pub step: f64,
    /// Units of the quantity per volt at the digitizer.
    pub factor: f64,
    /// Quantity at 0 V.
    pub offset: f64,
}

/// Voltages of a digitizer at equal intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct Waveform {
    /// Time of the first sample relative to the trigger, s.
    pub start_s: f64,
    /// Interval between two samples, s; above 0.
    pub step_s: f64,
    /// Voltages at the input of the digitizer.
    pub volts: Vec<f32>,
}

/// What a program has delivered: the numbers of its replies in their order, or a waveform.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Delivered {
    /// Numbers of all replies in their order; empty beside a waveform.
    pub numbers: Vec<f64>,
    /// Waveform of a program that reads one.
    pub waveform: Option<Arc<Waveform>>,
}

impl Delivered {
    /// Makes values of the replies to a program. A list of numbers (the preamble) followed by a block is a waveform; a
    /// text that is no number gives no value.
    ///
    /// # Errors
    /// Fails when a block has no preamble, or one that does not fit the dialect.
    pub fn of(dialect: Dialect, replies: &[Reply]) -> Result<Self, SamplesError> {
        let mut delivered = Self::default();
        let mut preamble: &[f64] = &[];
        for reply in replies {
            match reply {
                Reply::Number(number) => delivered.numbers.push(*number),
                Reply::Numbers(numbers) => {
                    preamble = numbers;
                    delivered.numbers.extend(numbers);
                }
                Reply::Line(text) => delivered.numbers.extend(number(text).ok()),
                Reply::Text(_) => {}
                Reply::Block(bytes) => {
                    let samples = scpi::samples(dialect, preamble, bytes)?;
                    delivered.waveform = Some(Arc::new(Waveform {
                        start_s: samples.start_s,
                        step_s: samples.step_s,
                        volts: samples.volts,
                    }));
                }
            }
        }
        if delivered.waveform.is_some() {
            delivered.numbers = Vec::new();
        }
        Ok(delivered)
    }
}

#[cfg(test)]
mod tests;
