//! Operating point of the input of a relay at a source.

use super::truth::Truth;
use crate::scpi::circuit::{Drive, Reading};

impl Truth {
    /// Returns voltage and current at the input, with the part at `celsius`.
    pub fn at_input(&self, drive: Drive, celsius: f64) -> Reading {
        let at_voltage = |volts: f64, source_ohm: f64| {
            let amps = self.input_a(volts, source_ohm, celsius);
            let volts = volts - amps * source_ohm;
            Reading { volts, amps }
        };
        let at_current = |amps: f64| Reading {
            volts: self.input_v(amps, celsius),
            amps,
        };
        match drive {
            Drive::Voltage {
                volts,
                limit_a,
                source_ohm,
            } => {
                let free = at_voltage(volts, source_ohm);
                match free.amps.abs() > limit_a {
                    true => at_current(limit_a.copysign(free.amps)),
                    false => free,
                }
            }
            Drive::Current { amps, limit_v } => {
                let free = at_current(amps);
                match free.volts.abs() > limit_v {
                    true => at_voltage(limit_v.copysign(amps), 0.0),
                    false => free,
                }
            }
            Drive::Open | Drive::Sine { .. } | Drive::Pulses(_) => Reading::default(),
        }
    }
}
