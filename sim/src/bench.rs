//! Modules on a bench: one line of modules with fixed signals at their terminals, for any DCON client.

use std::collections::BTreeMap;
use std::path::Path;

use crate::config::{ConfigError, LineSpec};
use crate::error::SimError;
use crate::fault::LineFaults;
use crate::module::base::Commissioning;
use crate::module::tolerances::{self, Tolerances};
use crate::module::{Module, setting};
use crate::rig::Rig;
use crate::shared::check_targets;
use crate::table::Table;
use crate::terminal::{ModuleSpec, Plant};
use crate::truth::WorldRecord;

/// Name of the only line.
pub const LINE: &str = "bench";

/// Default time-out of an enabled watchdog, milliseconds.
const WATCHDOG_MS: f64 = 1_000.0;

/// Default and highest latency, milliseconds.
const LATENCY_MS: (f64, f64) = (2.0, 10_000.0);

/// Builds the bench of a file.
///
/// # Errors
/// Fails when the file cannot be read, has a key that the model does not know or a value that does not fit, or when a
/// fault has an unknown target.
pub fn build(file: &Path, faults: LineFaults) -> Result<Rig, SimError> {
    built(&Table::of_file(file)?, faults)
}

/// Builds a bench without faults from the text of a bench file.
///
/// # Errors
/// Fails as [`build`] does.
pub fn build_text(text: &str) -> Result<Rig, SimError> {
    built(&Table::parse(Path::new("-"), text)?, LineFaults::none(0))
}

fn built(keys: &Table, faults: LineFaults) -> Result<Rig, SimError> {
    let baud = setting::baud(keys)?.unwrap_or(115_200);
    let milliseconds = |key| setting::number(keys, key, 0.0..=LATENCY_MS.1);
    let latency_ms = milliseconds("latency_ms")?.unwrap_or(LATENCY_MS.0);
    let tolerances = Tolerances {
        latency_sd_us: milliseconds("latency_sd_ms")?.unwrap_or(0.0) * 1e3,
        ..Tolerances::exact(latency_ms * 1e3)
    };
    let mut signals = Signals::default();
    let mut modules = Vec::new();
    let tables: Vec<Table> = keys.get("module")?;
    keys.finish()?;
    for (number, keys) in tables.into_iter().enumerate() {
        let spec = spec(number, keys)?;
        let module = module(&spec, baud, &tolerances)?;
        signals.inputs.insert(spec.id, module.inputs().to_vec());
        modules.push(module);
    }
    let known = |target: &str| target == LINE || modules.iter().any(|it| it.id() == target);
    let expected = format!("a module of the file (module[0], module[1], ...) or the line {LINE}");
    check_targets(faults.targets(), &expected, known)?;
    let line = LineSpec {
        name: LINE.into(),
        baud,
        checksum: false,
    };
    Ok(Rig::new(Box::new(signals), modules, vec![line], faults))
}

fn spec(number: usize, keys: Table) -> Result<ModuleSpec, ConfigError> {
    Ok(ModuleSpec {
        id: format!("module[{number}]"),
        line: LINE.into(),
        address: keys.get("address")?,
        model: keys.get("model")?,
        settings: keys,
    })
}

/// Builds a module; refuses keys that its model does not know.
fn module(spec: &ModuleSpec, baud: u32, tolerances: &Tolerances) -> Result<Module, ConfigError> {
    let commissioning = Commissioning {
        baud: setting::baud(&spec.settings)?.unwrap_or(baud),
        checksum: false,
        host_watchdog_ms: WATCHDOG_MS,
    };
    let rng = tolerances::stream(0, &spec.id);
    let module = Module::new(spec, commissioning, tolerances.clone(), rng)?;
    spec.settings.finish()?;
    Ok(module)
}

/// Terminals with the constant signals of the bench file.
#[derive(Default)]
struct Signals {
    inputs: BTreeMap<String, Vec<f64>>,
}

impl Signals {
    fn input(&self, module: &str, channel: u8) -> Option<f64> {
        self.inputs.get(module)?.get(usize::from(channel)).copied()
    }
}

impl Plant for Signals {
    fn advance(&mut self, _t_us: u64) {}

    fn analog_in(&mut self, module: &str, channel: u8) -> f64 {
        self.input(module, channel).unwrap_or(f64::NAN)
    }

    fn analog_out(&mut self, _module: &str, _channel: u8, _volts: f64) {}

    /// Returns the levels that the bench file gives; a terminal that it omits is open and reads 1.
    fn digital_in(&mut self, module: &str) -> u16 {
        (0..16u8).fold(0, |levels, channel| {
            let open = self.input(module, channel).unwrap_or(1.0) != 0.0;
            levels | u16::from(open) << channel
        })
    }

    fn digital_out(&mut self, _module: &str, _bits: u16) {}

    fn edges(&mut self, _module: &str, _channel: u8) -> u64 {
        0
    }

    fn gate_open_us(&mut self, _module: &str, _channel: u8) -> f64 {
        0.0
    }

    fn reference_clock_hz(&self) -> f64 {
        0.0
    }
}

impl WorldRecord for Signals {}
