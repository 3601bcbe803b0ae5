//! What came from the rig, with everything needed to trace it back to its bytes.

use super::point::{AnalogInput, DigitalInput, GatedCounter, Thermometer};
use super::wiring::{LineId, ModuleId};
use dcon::{Channel, Command};
use std::sync::Arc;
use units::RigTime;

/// Where a sample came from.
#[derive(Debug, Clone, PartialEq)]
pub struct Origin {
    /// The line.
    pub line: LineId,
    /// The module.
    pub module: ModuleId,
    /// The channel, from 0.
    pub channel: Channel,
    /// What was asked.
    pub command: Command,
    /// The reply as it came, lead included, check sum and CR excluded or not as the line hands it over.
    pub raw: Arc<str>,
    /// When the module was asked: the conversion may be older by its conversion time, never newer than the reply.
    pub at: RigTime,
}

impl Origin {
    /// The request as sent, without check sum and end.
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

/// Whether a reading is a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quality {
    /// It is.
    Good,
    /// At or above the upper end of the range.
    OverRange,
    /// At or below the lower end.
    UnderRange,
    /// The channel is disabled.
    Blank,
}

/// One analog reading.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample {
    /// What was measured.
    pub point: AnalogPoint,
    /// In the unit of the point (V, A, degrees Celsius), before correction; NaN unless the quality is good.
    pub value: f64,
    /// Volts at the terminal (degrees Celsius of a thermometer); NaN unless the quality is good.
    pub terminal_volts: f64,
    /// Whether it is a number at all.
    pub quality: Quality,
    /// Its bytes.
    pub origin: Origin,
}

impl Sample {
    /// The value, when it is one.
    pub fn good(&self) -> Option<f64> {
        match self.quality {
            Quality::Good if self.value.is_finite() => Some(self.value),
            Quality::Good | Quality::OverRange | Quality::UnderRange | Quality::Blank => None,
        }
    }
}

/// One count.
#[derive(Debug, Clone, PartialEq)]
pub struct CountSample {
    /// What was counted.
    pub point: CountPoint,
    /// The count.
    pub count: u32,
    /// Its bytes.
    pub origin: Origin,
}

impl CountSample {
    /// Counts since an earlier sample of the same point, across one wrap.
    pub fn since(&self, earlier: &CountSample) -> u32 {
        let difference = self.count.wrapping_sub(earlier.count);
        match self.point {
            CountPoint::Gate(_) => difference,
            CountPoint::Events(_) => difference & 0xFFFF,
        }
    }
}
