//! Reads `config/` for the simulated rig.
//!
//! The rig file assigns signals to terminals; the world finds signals by their fixed names, so a
//! rewired `rig.toml` gives a rewired simulated rig. The world file ([`crate::world::table`]) holds
//! the true values of the rig and the parts. The controller reads the same files with its own code:
//! a shared reader would hide its mistakes from the tests.

use std::collections::BTreeMap;
use std::path::PathBuf;

pub use crate::files::Files;
use crate::module::setting;
use crate::table::{Entry, Read, Table, read_fields};
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
    /// The file is not TOML.
    #[error("{path}:{line}: {message}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Line of the error, from 1.
        line: usize,
        /// Found and expected content.
        message: String,
    },
    /// A key is unknown or missing, or its value is unfit.
    #[error("{path}:{line}: {key}: found {found}, expected {expected}")]
    Value {
        /// The file.
        path: PathBuf,
        /// Line of the key, from 1; line of its table when the key is missing.
        line: usize,
        /// Key as a dotted path.
        key: String,
        /// Value as the file has it.
        found: String,
        /// Expected form and range.
        expected: String,
    },
    /// A fault does not fit the rig.
    #[error("{path}: {key}: {message}")]
    Fault {
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
#[derive(Debug, Clone, Copy, PartialEq)]
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

/// References of a rig whose file has no `[reference]`: only the counter clock is in use, because no test reads the
/// others.
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

/// Name of the line of the code reader.
pub const READER: &str = "serial_reader";

/// The code reader at the pocket.
#[derive(Debug, Clone, PartialEq)]
pub struct CodeReader {
    /// Bits per second.
    pub baud: u32,
    /// Text that the reader sends when it finds no code; empty when it then sends nothing.
    pub no_code: String,
}

/// Content of `rig.toml` that the simulated rig needs.
#[derive(Debug, Clone)]
pub struct RigFile {
    /// Serial lines in order of name, then the line of the code reader.
    pub lines: Vec<LineSpec>,
    /// Code reader, if the rig has one.
    pub code_reader: Option<CodeReader>,
    /// Modules in order of identifier.
    pub modules: Vec<ModuleSpec>,
    /// Time after the last host OK until a watched module sets its safe outputs, milliseconds.
    pub host_watchdog_ms: f64,
    /// Analog inputs by point name.
    pub analog_in: BTreeMap<String, Terminal>,
    /// Analog outputs by point name.
    pub analog_out: BTreeMap<String, Terminal>,
    /// Instruments by name, each with its `link`.
    pub instruments: BTreeMap<String, Table>,
    /// Ranges of the coil supply; empty for a supply with one fixed range.
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
    /// Sockets of a rack in order of number; empty for a rig with a nest.
    pub sockets: Vec<Socket>,
    /// Certificate of the rack.
    pub certificate: RackCertificate,
}

/// A socket of a rack.
#[derive(Debug, Clone, PartialEq)]
pub struct Socket {
    /// Number on the rack, which is its key in `[socket]`.
    pub number: u64,
    /// Input of its contact.
    pub terminal: Terminal,
    /// Number at the multiplexer.
    pub select: u8,
}

/// Difference of the air to ambient for which [`RackCertificate`] states the offsets of sockets, kelvin.
pub const OFFSETS_AT_K: f64 = 75.0;

/// Certificate of a rack; all zero and empty without one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RackCertificate {
    /// Mean error of the reference sensor, kelvin.
    pub error_k: f64,
    /// Temperature of each socket less that of the air, where the air is [`OFFSETS_AT_K`] above ambient, kelvin.
    pub offsets_k: Vec<f64>,
}

/// Reads `rig.toml`.
///
/// # Errors
/// Fails when the file cannot be read, is not TOML, or lacks a required key.
pub fn read_rig(files: &Files) -> Result<RigFile, ConfigError> {
    let rig = files.read("rig.toml")?;
    let ranges: BTreeMap<String, SupplyRange> = rig.get_or("supply_range", BTreeMap::new())?;
    let code_reader: Option<CodeReader> = rig.get(READER)?;
    let mut lines = named(rig.get("line")?, line)?;
    lines.extend(code_reader.as_ref().map(|reader| LineSpec {
        name: READER.into(),
        baud: reader.baud,
        checksum: false,
    }));
    Ok(RigFile {
        lines,
        code_reader,
        modules: named(rig.get("module")?, module)?,
        host_watchdog_ms: rig.get::<Table>("bus")?.get("host_watchdog_ms")?,
        instruments: rig.get_or("instrument", BTreeMap::new())?,
        analog_in: rig.get("analog_in")?,
        analog_out: rig.get_or("analog_out", BTreeMap::new())?,
        supply_ranges: ranges.into_values().collect(),
        digital_in: rig.get("digital_in")?,
        digital_out: rig.get("digital_out")?,
        counter: rig.get_or("counter", BTreeMap::new())?,
        temperature: rig.get("temperature")?,
        sockets: sockets(&rig)?,
        certificate: certificate(files, &rig)?,
        axis: named(rig.get_or("axis", Tables::new())?, |name, stop| {
            Ok((name, (stop.get("point")?, stop.get("x_mm")?)))
        })?
        .into_iter()
        .collect(),
        bins: named(rig.get_or("bin", Tables::new())?, bin)?,
        reference: rig.get_or("reference", References::default())?,
    })
}

/// Reads the certificate of the rack, if `rig.toml` names one.
fn certificate(files: &Files, rig: &Table) -> Result<RackCertificate, ConfigError> {
    let calibration: Option<Table> = rig.get("calibration")?;
    let name: Option<String> = calibration.map_or(Ok(None), |it| it.get("rack"))?;
    let Some(name) = name else {
        return Ok(RackCertificate::default());
    };
    let file = files.read(&name)?;
    let points: Vec<Table> = file.get::<Table>("chain")?.get("points")?;
    let error = |it: &Table| -> Result<f64, ConfigError> {
        Ok(it.get::<f64>("reading_c")? - it.get::<f64>("true_c")?)
    };
    let errors: Vec<f64> = points.iter().map(error).collect::<Result<_, _>>()?;
    let map: Table = file.get("map")?;
    let scale = OFFSETS_AT_K / map.get::<f64>("excess_k")?;
    let offsets_k: Vec<f64> = map.get("offset_k")?;
    Ok(RackCertificate {
        error_k: errors.iter().sum::<f64>() / errors.len().max(1) as f64,
        offsets_k: offsets_k.into_iter().map(|it| it * scale).collect(),
    })
}

/// Tables below a key, by name.
type Tables = BTreeMap<String, Table>;

/// Reads tables in order of name.
fn named<T>(
    tables: Tables,
    read: impl Fn(String, Table) -> Result<T, ConfigError>,
) -> Result<Vec<T>, ConfigError> {
    let each = tables.into_iter();
    each.map(|(name, keys)| read(name, keys)).collect()
}

/// Reads the sockets, in order of number.
fn sockets(rig: &Table) -> Result<Vec<Socket>, ConfigError> {
    let mut all = named(rig.get_or("socket", Tables::new())?, |number, keys| {
        Ok(Socket {
            number: number
                .parse()
                .map_err(|_| keys.wrong_name("the number of the socket"))?,
            terminal: Terminal::of(&keys)?,
            select: keys.get("select")?,
        })
    })?;
    all.sort_by_key(|socket| socket.number);
    Ok(all)
}

fn line(name: String, keys: Table) -> Result<LineSpec, ConfigError> {
    Ok(LineSpec {
        name,
        baud: setting::baud(&keys)?.ok_or_else(|| keys.wrong("baud", "bits per second"))?,
        checksum: keys.get_or("checksum", false)?,
    })
}

fn module(id: String, keys: Table) -> Result<ModuleSpec, ConfigError> {
    let address: String = keys.get("address")?;
    Ok(ModuleSpec {
        id,
        line: keys.get("line")?,
        address: u8::from_str_radix(&address, 16)
            .map_err(|_| keys.wrong("address", "two hexadecimal digits"))?,
        model: keys.get("model")?,
        settings: keys,
    })
}

fn bin(name: String, keys: Table) -> Result<Bin, ConfigError> {
    Ok(Bin {
        name,
        point: keys.get("point")?,
        x_mm: keys.get("x_mm")?,
        beam: keys.get_or("beam", String::new())?,
    })
}

impl Read for Terminal {
    const FORM: &'static str = "a table";

    fn read(entry: &Entry) -> Result<Self, ConfigError> {
        Self::of(entry.table()?)
    }
}

impl Terminal {
    fn of(keys: &Table) -> Result<Self, ConfigError> {
        Ok(Self {
            module: keys.get("module")?,
            channel: keys.get_or("channel", 0)?,
            active_low: match keys.get::<Option<String>>("active")?.as_deref() {
                None | Some("high") => false,
                Some("low") => true,
                Some(_) => return Err(keys.wrong("active", "high or low")),
            },
            gain: keys.get_or("gain", 1.0)?,
        })
    }
}

impl Read for CodeReader {
    const FORM: &'static str = "a table";

    fn read(entry: &Entry) -> Result<Self, ConfigError> {
        let keys = entry.table()?;
        Ok(Self {
            baud: setting::baud(keys)?.ok_or_else(|| keys.wrong("baud", "bits per second"))?,
            no_code: keys.get_or("no_code", String::new())?,
        })
    }
}

read_fields!(References {
    coil_ohm,
    coil_tolerance_pct,
    contact_mohm,
    contact_tolerance_pct,
    voltage_v,
    voltage_tolerance_pct,
    gate_pulse_ms,
    counter_clock_hz,
});
