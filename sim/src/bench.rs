//! Modules on a bench: fixed signals at the terminals of one line, for any DCON client.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;

use crate::config::LineSpec;
use crate::error::SimError;
use crate::fault::LineFaults;
use crate::module::base::Commissioning;
use crate::module::tolerances::{self, Tolerances};
use crate::module::{Module, setting};
use crate::rig::Rig;
use crate::terminal::{ModuleSpec, Plant};
use crate::truth::WorldRecord;

/// Name of the only line.
pub const LINE: &str = "bench";

/// Default time-out of an enabled watchdog, milliseconds.
const WATCHDOG_MS: f64 = 1_000.0;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BenchFile {
    #[serde(default = "default_baud")]
    baud: u32,
    #[serde(default = "default_latency")]
    latency_ms: f64,
    #[serde(default)]
    latency_sd_ms: f64,
    module: Vec<BenchModule>,
}

#[derive(Deserialize)]
struct BenchModule {
    address: u8,
    model: String,
    #[serde(flatten)]
    settings: BTreeMap<String, toml::Value>,
}

fn default_baud() -> u32 {
    115_200
}

fn default_latency() -> f64 {
    2.0
}

/// Keys of a bench module besides `address` and `model`.
const KEYS: [&str; 32] = [
    "checksum",
    "format",
    "range",
    "type",
    "inputs",
    "name",
    "firmware",
    "outputs",
    "counts",
    "latches",
    "enabled",
    "mask",
    "fast",
    "slew",
    "preset",
    "gate",
    "safe",
    "power_on",
    "watchdog",
    "init",
    "reset_seen",
    "response_delay_ms",
    "maximum",
    "filter",
    "filter_us",
    "threshold",
    "input_mode",
    "overflow",
    "led",
    "baud",
    "signed",
    "refusal",
];

/// Builds the bench of a file.
///
/// # Errors
/// Fails when the file cannot be read, or a module has an unknown key or an unfit value.
pub fn build(file: &Path, faults: LineFaults) -> Result<Rig, SimError> {
    let text = std::fs::read_to_string(file).map_err(|error| bench(file, error.to_string()))?;
    parse(&text)
        .map_err(|why| bench(file, why.to_string().trim().to_owned()))?
        .build(faults)
        .map_err(|error| match error {
            SimError::Bench { why, .. } => bench(file, why),
            other => bench(file, other.to_string()),
        })
}

/// Builds a bench without faults from the text of a bench file.
///
/// # Errors
/// Fails as [`build`] does.
pub fn build_text(text: &str) -> Result<Rig, SimError> {
    parse(text)
        .map_err(|why| bench(Path::new("-"), why.to_string().trim().to_owned()))?
        .build(LineFaults::none(0))
}

fn parse(text: &str) -> Result<BenchFile, toml::de::Error> {
    toml::from_str(text)
}

fn bench(file: &Path, why: String) -> SimError {
    SimError::Bench {
        file: file.to_path_buf(),
        why,
    }
}

impl BenchFile {
    fn build(self, faults: LineFaults) -> Result<Rig, SimError> {
        let mut signals = Signals::default();
        let mut modules = Vec::new();
        for (number, module) in self.module.into_iter().enumerate() {
            let spec = module.spec(number)?;
            let commissioning = Commissioning {
                baud: setting::number(&spec, "baud")?.map_or(self.baud, |baud| baud as u32),
                checksum: false,
                host_watchdog_ms: WATCHDOG_MS,
            };
            signals
                .inputs
                .insert(spec.id.clone(), setting::numbers(&spec, "inputs")?);
            let tolerances = Tolerances {
                latency_sd_us: self.latency_sd_ms * 1e3,
                ..Tolerances::exact(self.latency_ms * 1e3)
            };
            let rng = tolerances::stream(0, &spec.id);
            modules.push(Module::new(&spec, commissioning, tolerances, rng)?);
        }
        let line = LineSpec {
            name: LINE.into(),
            baud: self.baud,
            checksum: false,
        };
        let known =
            |target: &str| target == LINE || modules.iter().any(|module| module.id() == target);
        if let Some(target) = faults.targets().find(|target| !known(target)) {
            return Err(SimError::FaultValue {
                name: "target".into(),
                found: target.into(),
                expected: format!(
                    "a module of the file (module[0], module[1], ...) or the line {LINE}"
                ),
            });
        }
        Ok(Rig::new(Box::new(signals), modules, vec![line], faults))
    }
}

impl BenchModule {
    fn spec(self, number: usize) -> Result<ModuleSpec, SimError> {
        let id = format!("module[{number}]");
        if let Some(key) = self
            .settings
            .keys()
            .find(|key| !KEYS.contains(&key.as_str()))
        {
            return Err(bench(
                Path::new("-"),
                format!(
                    "{id}: key `{key}` is unknown, expected one of {}",
                    KEYS.join(", ")
                ),
            ));
        }
        Ok(ModuleSpec {
            id,
            line: LINE.into(),
            address: self.address,
            model: self.model,
            settings: self.settings,
        })
    }
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

    fn analog_out(&mut self, _module: &str, _volts: f64) {}

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
