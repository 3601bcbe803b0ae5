//! The screw terminals: the boundary between the modules and the world that they measure and drive.
//!
//! Modules have bytes, converters and registers; the world has coils, cylinders and contacts. The two exchange volts,
//! logic levels and gate times, at whole microseconds of rig time that never run backwards. A module reads and writes
//! only after [`Plant::advance`] has brought the world to that instant.

use crate::scpi::circuit::Circuit;
use crate::table::Table;

/// One module as `config/rig.toml` describes it (identifier, line, address and commissioning).
#[derive(Debug, Clone)]
pub struct ModuleSpec {
    /// Key of the table `[module.ID]`.
    pub id: String,
    /// Name of its line.
    pub line: String,
    /// Address on that line.
    pub address: u8,
    /// Model name as printed on the housing, for example `I-7017F`.
    pub model: String,
    /// The whole table of the module in the configuration, including the keys of the fields above.
    pub settings: Table,
}

/// The world behind the terminals; it knows modules by their identifiers in `config/rig.toml`.
pub trait Plant {
    /// Brings the world to `t_us`; all other methods refer to that instant.
    fn advance(&mut self, t_us: u64);

    /// Returns the volts at the terminals of an analog input (RTD input: degrees Celsius with the errors of the
    /// sensor); NaN when nothing is connected.
    fn analog_in(&mut self, module: &str, channel: u8) -> f64;

    /// Sets the output of an analog channel to `volts`; while the channel slews, at every refresh.
    fn analog_out(&mut self, module: &str, channel: u8, volts: f64);

    /// Returns the electrical levels of all digital inputs, bit n = channel n; 1 is open (no signal).
    fn digital_in(&mut self, module: &str) -> u16;

    /// Sets all digital outputs of a module, bit n = channel n; 1 is on.
    fn digital_out(&mut self, module: &str, bits: u16);

    /// Returns the number of falling edges so far at a digital input; only low levels of at least 5 ms count.
    fn edges(&mut self, module: &str, channel: u8) -> u64;

    /// Returns the total open time of a counter's gate so far, microseconds, gate delay included.
    fn gate_open_us(&mut self, module: &str, channel: u8) -> f64;

    /// Returns the circuit to which instruments connect; `None` where there is none.
    fn circuit(&mut self) -> Option<&mut dyn Circuit> {
        None
    }

    /// Returns the true frequency of the reference clock at both counter inputs, hertz.
    fn reference_clock_hz(&self) -> f64;
}
