//! Samples from the rig, each with the origin of its bytes.

use super::point::{AnalogInput, DigitalInput, GatedCounter, Thermometer};
use super::wiring::{LineId, ModuleId};
use dcon::{Channel, Command};
use std::sync::Arc;
use units::RigTime;

/// Origin of a sample.
#[derive(Debug, Clone, PartialEq)]
pub struct Origin {
    /// The line.
    pub line: LineId,
    /// The module.
    pub module: ModuleId,
    /// The channel, from 0.
    pub channel: Channel,
    /// The command that read the sample.
    pub command: Command,
    /// The reply as received, with its leading character; with checksum and CR only if the line passes them on.
    pub raw: Arc<str>,
    /// Time of the request. The converted voltage may be older by the time of one conversion, and is never newer than
    /// the reply.
    pub at: RigTime,
}

impl Origin {
    /// Returns the request as sent, without checksum and CR.
    pub fn request(&self) -> String {
        let mut bytes = Vec::new();
        self.command.encode(false, &mut bytes);
        String::from_utf8_lossy(&bytes).trim_end().to_string()
    }
}

/// A point that gives analog samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum AnalogPoint {
    /// A voltage input.
    Input(AnalogInput),
    /// A thermometer.
    Temperature(Thermometer),
}

/// A point that gives counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CountPoint {
    /// A gated counter, modulo 2^32.
    Gate(GatedCounter),
    /// The event counter of a digital input, modulo 2^16.
    Events(DigitalInput),
}

/// Validity of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quality {
    /// The reading is a number.
    Good,
    /// At or above the upper end of the range.
    OverRange,
    /// At or below the lower end of the range.
    UnderRange,
    /// The channel is disabled.
    Blank,
}

/// One analog reading.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// The measured point.
    pub point: AnalogPoint,
    /// Value in the unit of the point (V, A, degrees Celsius), before correction; NaN unless the quality is good.
    pub value: f64,
    /// Volts at the terminal, for a thermometer degrees Celsius; NaN unless the quality is good.
    pub terminal_volts: f64,
    /// Validity of the value.
    pub quality: Quality,
    /// Origin of the value.
    pub origin: Origin,
}

impl Sample {
    /// Returns the value of a sample of good quality, else `None`.
    pub fn good(&self) -> Option<f64> {
        match self.quality {
            Quality::Good if self.value.is_finite() => Some(self.value),
            Quality::Good | Quality::OverRange | Quality::UnderRange | Quality::Blank => None,
        }
    }
}

/// One reading of a counter.
#[derive(Debug, Clone, PartialEq)]
pub struct CountSample {
    /// The counted point.
    pub point: CountPoint,
    /// The count.
    pub count: u32,
    /// Origin of the count.
    pub origin: Origin,
}

impl CountSample {
    /// Returns the counts since an earlier sample of the same point, across at most one wrap.
    pub fn since(&self, earlier: &CountSample) -> u32 {
        let difference = self.count.wrapping_sub(earlier.count);
        match self.point {
            CountPoint::Gate(_) => difference,
            CountPoint::Events(_) => difference & 0xFFFF,
        }
    }
}
