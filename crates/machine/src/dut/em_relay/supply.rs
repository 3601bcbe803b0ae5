//! The coil supply as three outputs that add up: level (steps), coarse ramp, fine ramp.
//!
//! [`Supply`] holds the last commanded voltage of each output, so that a stage can set their sum and keep the ramps of
//! the stage before: the coarse ramp rises once for operate and falls once for release.

use crate::dut::em_relay::Calibration;
use crate::dut::em_relay::act::Act;
use crate::dut::em_relay::calibration::OutputLine;
use crate::dut::em_relay::points::AnalogOut;
use units::{Span, Volt};

/// Rounding error of the sum of three outputs.
const ROUNDING: Volt = Volt(1e-9);
/// Longest time that an output takes to settle after its last refresh.
pub const RAMP_MARGIN: Span = Span::ms(4);

/// Voltage that each output contributes at the coil.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Supply {
    level: OutputLine,
    coarse: OutputLine,
    fine: OutputLine,
    coarse_v_per_s: f64,
    fine_v_per_s: f64,
    level_at: Volt,
    coarse_at: Volt,
    fine_at: Volt,
}

impl Supply {
    /// Returns a supply with all outputs at zero.
    pub fn new(calibration: &Calibration) -> Self {
        let (level, coarse, fine) = (calibration.level, calibration.coarse, calibration.fine);
        Self {
            level_at: level.delivers(Volt(0.0)),
            coarse_at: coarse.delivers(Volt(0.0)),
            fine_at: fine.delivers(Volt(0.0)),
            level,
            coarse,
            fine,
            coarse_v_per_s: calibration.coarse_v_per_s.value,
            fine_v_per_s: calibration.fine_v_per_s.value,
        }
    }

    /// Returns the sum of the three commanded voltages.
    pub fn total(&self) -> Volt {
        self.level_at + self.coarse_at + self.fine_at
    }

    /// Returns the voltage that the coarse output contributes at the end of its ramp.
    pub fn coarse(&self) -> Volt {
        self.coarse_at
    }

    /// Returns the voltage that the fine output contributes at the end of its ramp.
    pub fn fine(&self) -> Volt {
        self.fine_at
    }

    /// Returns true when the last commands take both ramps to their lowest voltage.
    pub fn ramps_are_down(&self) -> bool {
        let rests = |line: OutputLine, at: Volt| {
            let lowest = line.delivers(Volt(0.0)).0.max(0.0);
            at < Volt(lowest) + ROUNDING
        };
        rests(self.coarse, self.coarse_at) && rests(self.fine, self.fine_at)
    }

    /// Returns the act that steps the level so that the sum becomes `total`; the ramp outputs keep their voltage. If
    /// the ramp outputs alone exceed `total`, the level becomes 0.
    pub fn step_to(&mut self, total: Volt) -> Act {
        let wanted = total - self.coarse_at - self.fine_at;
        let command = Volt(self.level.command_for(wanted).0.max(0.0));
        self.level_at = self.level.delivers(command);
        let over = self.total() - total;
        assert!(
            command == Volt(0.0) || over < ROUNDING,
            "{over:?} over {total:?}"
        );
        Act::Supply(vec![(AnalogOut::SupplyLevel, command)])
    }

    /// Returns the act that starts the coarse ramp towards `volts`, and the duration of the ramp.
    pub fn ramp_coarse(&mut self, volts: Volt) -> (Act, Span) {
        let command = Volt(self.coarse.command_for(volts).0.max(0.0));
        let way = self.coarse.delivers(command) - self.coarse_at;
        self.coarse_at = self.coarse_at + way;
        let takes = Span::seconds(way.0.abs() / self.coarse_v_per_s) + RAMP_MARGIN;
        (Act::Supply(vec![(AnalogOut::SupplyCoarse, command)]), takes)
    }

    /// Returns the act that starts the fine ramp towards `volts`, and the duration of the ramp.
    pub fn ramp_fine(&mut self, volts: Volt) -> (Act, Span) {
        let command = Volt(self.fine.command_for(volts).0.max(0.0));
        let way = self.fine.delivers(command) - self.fine_at;
        self.fine_at = self.fine_at + way;
        let takes = Span::seconds(way.0.abs() / self.fine_v_per_s) + RAMP_MARGIN;
        (Act::Supply(vec![(AnalogOut::SupplyFine, command)]), takes)
    }
}

#[cfg(test)]
mod tests;
