//! The text of `config/rig.toml` as types, before names are resolved to modules and channels.
//!
//! [`super::wiring::Wiring::resolve`] turns these types into the wiring; no other code needs them.

use serde::Deserialize;
use std::collections::BTreeMap;

/// Sections of `config/rig.toml` that describe lines, modules, points and mechanism.
#[derive(Debug, Clone, Deserialize)]
pub struct RigSettings {
    /// Bus lines by name.
    pub line: BTreeMap<String, LineSettings>,
    /// Times and counts that hold for every line.
    pub bus: BusSettings,
    /// Demands of the plant on the emergency stop.
    pub safety: SafetySettings,
    /// Modules by name.
    pub module: BTreeMap<String, ModuleSettings>,
    /// SCPI instruments by name; none on many rigs.
    #[serde(default)]
    pub instrument: BTreeMap<String, InstrumentSettings>,
    /// Analog inputs by point name.
    #[serde(default)]
    pub analog_in: BTreeMap<String, AnalogInSettings>,
    /// Thermometers by point name.
    #[serde(default)]
    pub temperature: BTreeMap<String, ChannelSettings>,
    /// Analog outputs by point name.
    #[serde(default)]
    pub analog_out: BTreeMap<String, AnalogOutSettings>,
    /// Ranges of the coil supply by name; empty where the supply has only one range.
    #[serde(default)]
    pub supply_range: BTreeMap<String, SupplyRangeSettings>,
    /// Gated counters by point name.
    #[serde(default)]
    pub counter: BTreeMap<String, ChannelSettings>,
    /// Digital inputs by point name.
    pub digital_in: BTreeMap<String, DigitalInSettings>,
    /// Digital outputs by point name.
    pub digital_out: BTreeMap<String, ChannelSettings>,
    /// Longest time of a stroke, by actuator; empty without a feeder.
    #[serde(default)]
    pub actuator: BTreeMap<String, ActuatorSettings>,
    /// Stations of the sort axis that are not bins; empty without a feeder.
    #[serde(default)]
    pub axis: BTreeMap<String, StationSettings>,
    /// Bins by name; empty without a feeder.
    #[serde(default)]
    pub bin: BTreeMap<String, BinSettings>,
    /// The rack of a rig that a person loads and unloads; `None` on a rig with a feeder.
    pub rack: Option<RackSettings>,
    /// Sockets of the rack by number.
    #[serde(default)]
    pub socket: BTreeMap<String, SocketSettings>,
}

/// One RS-485 line, always 8N1.
#[derive(Debug, Clone, Deserialize)]
pub struct LineSettings {
    /// Path of the serial port.
    pub port: String,
    /// Bits per second.
    pub baud: u32,
    /// True when the modules of this line use checksums.
    pub checksum: bool,
}

/// Times and counts common to all lines.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct BusSettings {
    /// Time that a digital, counter or analog output module may take to reply, ms; excludes the time on the wire.
    pub digital_allowance_ms: f64,
    /// Time that an analog input module may take to reply, ms; excludes the time on the wire.
    pub analog_allowance_ms: f64,
    /// Most tries of a repeatable command.
    pub tries: u8,
    /// Period of the broadcast "host OK", which feeds the host watchdogs, ms.
    pub heartbeat_ms: f64,
    /// Time-out of the output modules' host watchdog, ms; the modules count tenths of a second.
    pub host_watchdog_ms: f64,
    /// Pause between two scans of the motion line, ms; 0 polls without a pause.
    pub scan_period_ms: f64,
}

/// Demands of the plant on the emergency stop.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct SafetySettings {
    /// Longest accepted time from the opening of the emergency-stop contact to the reply of the last command that
    /// switches an output off, ms.
    pub estop_reaction_ms: f64,
}

/// One module of `config/rig.toml`.
#[derive(Debug, Clone, Deserialize)]
pub struct ModuleSettings {
    /// Name of the line.
    pub line: String,
    /// Two hexadecimal digits.
    pub address: String,
    /// Name of the model, for example `I-7017F`.
    pub model: String,
    /// Type code TT of the configuration word, two hexadecimal digits.
    #[serde(rename = "type")]
    pub type_code: String,
    /// `hex`, `engineering` or `percent`; analog modules only.
    pub format: Option<String>,
    /// Fast mode of an analog input module.
    pub fast: Option<bool>,
    /// Enabled channels of an analog input module, two hexadecimal digits.
    pub mask: Option<String>,
    /// Slew code of an analog output module, one hexadecimal digit.
    pub slew: Option<String>,
    /// True when the host watchdog of this module must be on.
    pub watchdog: Option<bool>,
    /// Safe value of an analog output, V at its terminal.
    pub safe: Option<f64>,
    /// Safe value of digital outputs, four hexadecimal digits.
    pub safe_outputs: Option<String>,
}

/// One SCPI instrument of `config/rig.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct InstrumentSettings {
    /// Name of its profile.
    pub profile: String,
    /// Where it is, in a form of [`scpi::LinkAddress`].
    pub link: String,
}

/// An analog input point.
#[derive(Debug, Clone, Deserialize)]
pub struct AnalogInSettings {
    /// Name of the module.
    pub module: String,
    /// Channel, from 0.
    pub channel: u8,
    /// Unit of the quantity: `V` or `A`.
    pub unit: String,
    /// Volts at the terminal per unit of the quantity.
    pub gain: f64,
}

/// An analog output point.
#[derive(Debug, Clone, Deserialize)]
pub struct AnalogOutSettings {
    /// Name of the module.
    pub module: String,
    /// Channel, from 0; a 7021 has only channel 0.
    #[serde(default)]
    pub channel: u8,
    /// Volts of the coil supply per volt at the module's terminal; 1 for an output that feeds no coil supply.
    #[serde(default = "AnalogOutSettings::no_gain")]
    pub gain: f64,
}

impl AnalogOutSettings {
    fn no_gain() -> f64 {
        1.0
    }
}

/// One range of the supply.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct SupplyRangeSettings {
    /// Bits of the two outputs that select the range; the two inputs read back the same bits.
    pub code: u8,
    /// Factor by which the range multiplies the gains of the sources and divides the gains of the inputs behind the
    /// amplifier.
    pub factor: f64,
    /// Highest voltage of the supply, V.
    pub max_v: f64,
    /// Largest current of the supply, mA.
    pub max_ma: f64,
}

/// A point with a module and a channel.
#[derive(Debug, Clone, Deserialize)]
pub struct ChannelSettings {
    /// Name of the module.
    pub module: String,
    /// Channel, from 0.
    pub channel: u8,
}

/// A digital input point.
#[derive(Debug, Clone, Deserialize)]
pub struct DigitalInSettings {
    /// Name of the module.
    pub module: String,
    /// Channel, from 0.
    pub channel: u8,
    /// `low` when the bit reads 0 while the signal is present, else `high`.
    pub active: String,
}

/// Supervision of an actuator's strokes.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct ActuatorSettings {
    /// Longest time of a stroke before an alarm, ms.
    pub timeout_ms: f64,
    /// Name of the input that a stroke to rest needs.
    pub to_rest_needs: Option<String>,
    /// Name of the input that a stroke away from rest needs.
    pub to_end_needs: Option<String>,
}

/// A point of the sort axis.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct StationSettings {
    /// Number in the point table of the slide.
    pub point: u8,
    /// Position relative to the nest, mm.
    pub x_mm: f64,
}

/// A bin: a point of the axis with a beam in its chute.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct BinSettings {
    /// Number in the point table of the slide.
    pub point: u8,
    /// Position relative to the nest, mm.
    pub x_mm: f64,
    /// Digital input whose event counter counts falling parts.
    pub beam: String,
}

/// The rack of a rig that a person loads and unloads.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct RackSettings {
    /// Temperature of the rack below which the door may be unlocked, C.
    pub unlock_below_c: f64,
    /// Unloading lists, in the order in which a person unloads them.
    pub lists: Vec<String>,
}

/// A socket of the rack.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct SocketSettings {
    /// Module that reads the contact of the part in the socket.
    pub module: String,
    /// Channel, from 0.
    pub channel: u8,
    /// `low` when the bit reads 0 while the contact is closed; `high` when it reads 1.
    pub active: String,
    /// Number of the socket at the multiplexer.
    pub select: u8,
    /// Row on the plan of the rack, from 1.
    pub row: u8,
    /// Column on that plan, from 1.
    pub column: u8,
}
