//! Reads `config/` for the simulated rig.
//!
//! The rig file assigns signals to terminals; the world finds signals by their fixed names, so a
//! rewired `rig.toml` gives a rewired simulated rig. The world file ([`crate::world::table`]) holds
//! the true values of the rig and the parts. The controller reads the same files with its own code:
//! a shared reader would hide its mistakes from the tests.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::Deserialize;

pub use crate::files::Files;
use crate::terminal::ModuleSpec;
pub use crate::world::board::supply::SupplyRange;
pub use crate::world::table::{DeviceWorld, FaultSpec, WorldTable, read_world};

/// Reason why a configuration file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("{path}: cannot be read")]
    Read {
        /// The file.
        path: PathBuf,
        /// Reason that the operating system gives.
        source: std::io::Error,
    },
    /// The file is not TOML, or a key is unknown, missing or of the wrong type.
    #[error("{path}:{line}: {message}")]
    Content {
        /// The file.
        path: PathBuf,
        /// Line of the error, from 1; 0 when a key is missing.
        line: usize,
        /// Found and expected content.
        message: String,
    },
    /// A value has the right type but is impossible.
    #[error("{path}: {key}: {message}")]
    Value {
        /// The file.
        path: PathBuf,
        /// Key as a dotted path.
        key: String,
        /// Found and expected content.
        message: String,
    },
}

/// One serial line.
#[derive(Debug, Clone, PartialEq)]
pub struct LineSpec {
    /// Key of the table `[line.NAME]`.
    pub name: String,
    /// Bits per second.
    pub baud: u32,
    /// True when the modules of the line use a checksum.
    pub checksum: bool,
}

/// The screw terminal a named point is wired to.
#[derive(Debug, Clone, PartialEq)]
pub struct Terminal {
    /// Module identifier.
    pub module: String,
    /// Channel on the module.
    pub channel: u8,
    /// True when the terminal reads 0 while the signal is present.
    pub active_low: bool,
    /// For an input, volts at the terminal per unit of the quantity; for an output, units of the quantity per volt.
    pub gain: f64,
}

/// A sorting bin, with its place on the axis and its beam.
#[derive(Debug, Clone, PartialEq)]
pub struct Bin {
    /// Key of the table `[bin]`.
    pub name: String,
    /// Number in the point table of the axis.
    pub point: u8,
    /// Position along the axis, mm from the nest.
    pub x_mm: f64,
    /// Name of the digital input that monitors the chute.
    pub beam: String,
}

/// References on the interface board, with the values of their labels.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct References {
    /// Coil substitute, ohm.
    pub coil_ohm: f64,
    /// Half width of the tolerance of the coil substitute, percent.
    pub coil_tolerance_pct: f64,
    /// Contact substitute, milliohm.
    pub contact_mohm: f64,
    /// Half width of the tolerance of the contact substitute, percent.
    pub contact_tolerance_pct: f64,
    /// Voltage reference, volts.
    pub voltage_v: f64,
    /// Half width of the tolerance of the voltage reference, percent.
    pub voltage_tolerance_pct: f64,
    /// Length of the reference gate pulse, milliseconds.
    pub gate_pulse_ms: f64,
    /// Nominal clock of the gated counters, hertz.
    pub counter_clock_hz: f64,
}

/// References of a rig whose file has no `[reference]`: no test reads them, only the counter clock is used.
impl Default for References {
    fn default() -> Self {
        Self {
            coil_ohm: 400.0,
            coil_tolerance_pct: 0.0,
            contact_mohm: 50.0,
            contact_tolerance_pct: 0.0,
            voltage_v: 5.0,
            voltage_tolerance_pct: 0.0,
            gate_pulse_ms: 1.0,
            counter_clock_hz: 50_000.0,
        }
    }
}

/// Content of `rig.toml` that the simulated rig needs.
#[derive(Debug, Clone)]
pub struct RigFile {
    /// Serial lines in order of name.
    pub lines: Vec<LineSpec>,
    /// Modules in order of identifier.
    pub modules: Vec<ModuleSpec>,
    /// Time after the last host OK at which a watched module sets its safe outputs, milliseconds.
    pub host_watchdog_ms: f64,
    /// Analog inputs by point name.
    pub analog_in: BTreeMap<String, Terminal>,
    /// Analog outputs by point name.
    pub analog_out: BTreeMap<String, Terminal>,
    /// Ranges of the coil supply; empty for a rig with only one.
    pub supply_ranges: Vec<SupplyRange>,
    /// Digital inputs by point name.
    pub digital_in: BTreeMap<String, Terminal>,
    /// Digital outputs by point name.
    pub digital_out: BTreeMap<String, Terminal>,
    /// Gated counters by point name.
    pub counter: BTreeMap<String, Terminal>,
    /// RTD inputs by point name.
    pub temperature: BTreeMap<String, Terminal>,
    /// Named stops of the sort axis other than bins: number in the point table, and x in mm.
    pub axis: BTreeMap<String, (u8, f64)>,
    /// Bins in order of name.
    pub bins: Vec<Bin>,
    /// References on the interface board.
    pub reference: References,
}

/// Reads `rig.toml`.
///
/// # Errors
/// Fails when the file cannot be read, is not TOML, or lacks a required key.
pub fn read_rig(files: &Files) -> Result<RigFile, ConfigError> {
    Ok(resolve(files.read("rig.toml")?.parse()?))
}

#[derive(Deserialize)]
struct RawRig {
    line: BTreeMap<String, RawLine>,
    bus: RawBus,
    module: BTreeMap<String, RawModule>,
    analog_in: BTreeMap<String, RawPoint>,
    analog_out: BTreeMap<String, RawPoint>,
    #[serde(default)]
    supply_range: BTreeMap<String, SupplyRange>,
    digital_in: BTreeMap<String, RawPoint>,
    digital_out: BTreeMap<String, RawPoint>,
    counter: BTreeMap<String, RawPoint>,
    temperature: BTreeMap<String, RawPoint>,
    axis: BTreeMap<String, RawStop>,
    bin: BTreeMap<String, RawStop>,
    #[serde(default)]
    reference: References,
}

#[derive(Deserialize)]
struct RawBus {
    host_watchdog_ms: f64,
}

#[derive(Deserialize)]
struct RawLine {
    baud: u32,
    #[serde(default)]
    checksum: bool,
}

#[derive(Deserialize)]
struct RawModule {
    line: String,
    #[serde(deserialize_with = "hex_address")]
    address: u8,
    model: String,
    #[serde(flatten)]
    settings: BTreeMap<String, toml::Value>,
}

#[derive(Deserialize)]
struct RawPoint {
    module: String,
    #[serde(default)]
    channel: u8,
    #[serde(default)]
    active: Active,
    #[serde(default = "unity")]
    gain: f64,
}

#[derive(Deserialize, Default, PartialEq)]
#[serde(rename_all = "lowercase")]
enum Active {
    #[default]
    High,
    Low,
}

#[derive(Deserialize)]
struct RawStop {
    point: u8,
    x_mm: f64,
    #[serde(default)]
    beam: String,
}

fn unity() -> f64 {
    1.0
}

fn hex_address<'de, D: serde::Deserializer<'de>>(d: D) -> Result<u8, D::Error> {
    let text = String::deserialize(d)?;
    u8::from_str_radix(&text, 16).map_err(|_| {
        serde::de::Error::custom(format!("found address \"{text}\", expected two hex digits"))
    })
}

fn resolve(raw: RawRig) -> RigFile {
    RigFile {
        lines: raw.line.into_iter().map(line_spec).collect(),
        modules: raw.module.into_iter().map(module_spec).collect(),
        host_watchdog_ms: raw.bus.host_watchdog_ms,
        analog_in: points(raw.analog_in),
        analog_out: points(raw.analog_out),
        supply_ranges: raw.supply_range.into_values().collect(),
        digital_in: points(raw.digital_in),
        digital_out: points(raw.digital_out),
        counter: points(raw.counter),
        temperature: points(raw.temperature),
        axis: raw
            .axis
            .into_iter()
            .map(|(name, s)| (name, (s.point, s.x_mm)))
            .collect(),
        bins: raw.bin.into_iter().map(bin).collect(),
        reference: raw.reference,
    }
}

fn line_spec((name, raw): (String, RawLine)) -> LineSpec {
    LineSpec {
        name,
        baud: raw.baud,
        checksum: raw.checksum,
    }
}

fn module_spec((id, raw): (String, RawModule)) -> ModuleSpec {
    let RawModule {
        line,
        address,
        model,
        settings,
    } = raw;
    ModuleSpec {
        id,
        line,
        address,
        model,
        settings,
    }
}

fn bin((name, raw): (String, RawStop)) -> Bin {
    Bin {
        name,
        point: raw.point,
        x_mm: raw.x_mm,
        beam: raw.beam,
    }
}

fn points(raw: BTreeMap<String, RawPoint>) -> BTreeMap<String, Terminal> {
    let terminal = |p: RawPoint| Terminal {
        module: p.module,
        channel: p.channel,
        active_low: p.active == Active::Low,
        gain: p.gain,
    };
    raw.into_iter()
        .map(|(name, p)| (name, terminal(p)))
        .collect()
}
