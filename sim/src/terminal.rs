//! The screw terminals: where the modules of a line meet the world they measure and drive.
//!
//! A module knows bytes, converters and registers; the world knows coils, cylinders and contacts.
//! They meet here in volts, logic levels and gate times, at integer microseconds of rig time that
//! never run backwards. A module asks and writes only after [`Plant::advance`] has brought the
//! world to that instant.

use std::collections::BTreeMap;

/// One module as `config/rig.toml` describes it (identifier, line, address and commissioning).
#[derive(Debug, Clone, PartialEq)]
pub struct ModuleSpec {
    /// Key of the table `[module.ID]`.
    pub id: String,
    /// Name of the line it hangs on.
    pub line: String,
    /// Address on that line.
    pub address: u8,
    /// Model name as printed on the housing, `I-7017F`.
    pub model: String,
    /// The other keys of its table (type, format, fast, mask, slew, watchdog, safe ...).
    pub settings: BTreeMap<String, toml::Value>,
}

/// What is behind the terminals. Modules are named by their identifier in `config/rig.toml`.
pub trait Plant {
    /// Brings the world to `t_us`; everything else below speaks of that instant.
    fn advance(&mut self, t_us: u64);

    /// Volts between the terminals of an analog input (an RTD input: degrees Celsius at the sensor,
    /// errors of the sensor included). NaN: nothing connected.
    fn analog_in(&mut self, module: &str, channel: u8) -> f64;

    /// The output stage of an analog output now stands at `volts` (called at every refresh of a slew).
    fn analog_out(&mut self, module: &str, volts: f64);

    /// Electrical levels of all digital inputs, bit n = channel n; 1 is open, no signal.
    fn digital_in(&mut self, module: &str) -> u16;

    /// All digital outputs of a module, bit n = channel n; 1 is on.
    fn digital_out(&mut self, module: &str, bits: u16);

    /// Falling edges seen so far at a digital input whose low level lasted at least 5 ms.
    fn edges(&mut self, module: &str, channel: u8) -> u64;

    /// Total time the gate of a counter has been open so far, in microseconds (gate delay included).
    fn gate_open_us(&mut self, module: &str, channel: u8) -> f64;

    /// True frequency of the reference clock at both counter inputs, hertz.
    fn reference_clock_hz(&self) -> f64;
}
