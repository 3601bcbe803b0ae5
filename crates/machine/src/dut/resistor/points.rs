//! Points that a resistor needs: level and drive of the coil board, and one current channel.
//!
//! `em_relay` declares them as points of its board, under the same names.

use crate::rig::point::{AnalogInput, AnalogOutput, DigitalOutput, MissingPoint};
use crate::rig::wiring::Wiring;

/// Points as this rig has wired them.
#[derive(Debug, Clone, Copy)]
pub struct Points {
    /// Output that connects the supply to the two pins.
    pub drive: DigitalOutput,
    /// Output that sets the voltage of the supply.
    pub level: AnalogOutput,
    /// Input that reads the current through the part.
    pub current: AnalogInput,
}

impl Points {
    /// Resolves every point.
    ///
    /// # Errors
    /// Fails with the first point that the rig lacks.
    pub fn resolve(wiring: &Wiring) -> Result<Self, MissingPoint> {
        let missing = |section, name| MissingPoint { section, name };
        let (drive, level, current) = ("coil_drive", "supply_level", "coil_current_fine");
        Ok(Self {
            drive: wiring
                .digital_output(drive)
                .ok_or(missing("digital_out", drive))?,
            level: wiring
                .analog_output(level)
                .ok_or(missing("analog_out", level))?,
            current: wiring
                .analog_input(current)
                .ok_or(missing("analog_in", current))?,
        })
    }
}
