//! Builds a rig from its files and shares it between lines.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use crate::bench;
use crate::config::{ConfigError, Files, LineSpec, RigFile, WorldTable, read_rig, read_world};
use crate::error::SimError;
use crate::fault::{self, FaultInfo, LineFaults};
use crate::module::Module;
use crate::module::base::Commissioning;
use crate::module::tolerances::{self, Tolerances};
use crate::rig::{Reply, Rig};
use crate::scpi::of_rig;
use crate::terminal::ModuleSpec;
use crate::truth::{BodyTruth, ContactMove, Overdrive};
use crate::world::{self, WorldOptions};

/// Choice of rig, lot and faults.
#[derive(Debug, Clone)]
pub struct Options {
    /// Files `rig.toml`, `scene.toml`, `sim.toml`, `golden.toml`, `recipes/`.
    pub files: Files,
    /// World file in place of `sim.toml`.
    pub world: Option<PathBuf>,
    /// Seed of the rig's errors and of the lot.
    pub seed: u64,
    /// Recipe of the parts in the magazine.
    pub recipe: String,
    /// Number of lot parts in the magazine; `None` never runs out.
    pub parts: Option<u64>,
    /// True when reference parts precede the lot.
    pub reference_parts: bool,
    /// Faults as `NAME` or `NAME=VALUE`.
    pub faults: Vec<String>,
}

/// A rig that its lines share; a clone refers to the same rig.
#[derive(Clone)]
pub struct SharedRig(Arc<Mutex<Rig>>);

impl std::fmt::Debug for SharedRig {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("SharedRig").finish_non_exhaustive()
    }
}

impl Options {
    fn of_world(&self, faults: Vec<(String, f64)>) -> WorldOptions {
        WorldOptions {
            files: self.files.clone(),
            world_file: self.world.clone(),
            seed: self.seed,
            recipe: self.recipe.clone(),
            parts: self.parts,
            reference_parts: self.reference_parts,
            faults,
        }
    }
}

/// Builds the rig that its files describe; the seed draws its errors and parts.
///
/// # Errors
/// Fails when a file is missing or wrong, a module is not simulated, or a fault is unknown or has an unfit value.
pub fn build(options: &Options) -> Result<SharedRig, SimError> {
    let file = read_rig(&options.files)?;
    let table = read_world(&options.files, options.world.as_deref())?;
    let mut faults = LineFaults::none(options.seed);
    let (seed, files) = (options.seed, &options.files);
    let mut instruments = of_rig::build(&file.instruments, &table.instrument, files, seed)?;
    let mut world_faults = Vec::new();
    for text in &options.faults {
        let (name, value) = split(text);
        let of_instruments = instruments.as_mut().map(|it| it.faults.add(name, value));
        if !faults.add(name, value)? && !of_instruments.transpose()?.unwrap_or(false) {
            world_faults.push(world_fault(&table, name, value)?);
        }
    }
    if let Some(instruments) = &instruments {
        instruments.check_targets()?;
    }
    check_targets(faults.targets(), RIG_TARGETS, |target| {
        file.modules.iter().any(|module| module.id == target)
            || file.lines.iter().any(|line| line.name == target)
    })?;
    let (world, noise_seed) = world::build(&options.of_world(world_faults))?;
    let modules = modules(&file, &table, options.seed, noise_seed)?;
    let rig = Rig::new(world, modules, file.lines, faults);
    let rig = rig.with_instruments(instruments);
    Ok(SharedRig::new(rig))
}

/// Builds the modules of a bench file on one line `bench`. Only faults of lines and modules apply, as a bench has
/// no world.
///
/// # Errors
/// Fails as [`bench::build`] does, or when a fault is unknown or has an unfit value.
pub fn build_bench(file: &Path, faults: &[String]) -> Result<SharedRig, SimError> {
    let mut on_the_line = LineFaults::none(0);
    for text in faults {
        let (name, value) = split(text);
        if !on_the_line.add(name, value)? {
            return Err(SimError::UnknownFault { name: name.into() });
        }
    }
    Ok(SharedRig::new(bench::build(file, on_the_line)?))
}

/// Lists every fault that `--fault` accepts.
///
/// # Errors
/// Fails when the world file, which lists the faults of the world, cannot be read.
pub fn faults(files: &Files, world: Option<&Path>) -> Result<Vec<FaultInfo>, SimError> {
    let table = read_world(files, world)?;
    let of_the_world = table.fault.iter().map(|(name, spec)| FaultInfo {
        name: name.clone(),
        unit: spec.unit.clone(),
        default: spec.default.to_string(),
        what: spec.help.clone(),
    });
    let of_instruments = fault::instrument::list().into_iter();
    Ok(fault::list()
        .into_iter()
        .chain(of_instruments)
        .chain(of_the_world)
        .collect())
}

/// Splits `NAME[=VALUE]`.
pub(crate) fn split(text: &str) -> (&str, Option<&str>) {
    match text.split_once('=') {
        Some((name, value)) => (name, Some(value)),
        None => (text, None),
    }
}

fn world_fault(
    table: &WorldTable,
    name: &str,
    value: Option<&str>,
) -> Result<(String, f64), SimError> {
    if !table.fault.contains_key(name) {
        return Err(SimError::UnknownFault { name: name.into() });
    }
    let number = value.map_or(Ok(f64::NAN), |text| number(name, text))?;
    Ok((name.into(), number))
}

/// Parses the value of a fault of the world.
pub(crate) fn number(name: &str, text: &str) -> Result<f64, SimError> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(SimError::FaultValue {
            name: name.into(),
            found: text.into(),
            expected: "a number".into(),
        }),
    }
}

/// Description of the targets that a fault of a rig may name, for messages.
pub(crate) const RIG_TARGETS: &str = "a module or line of rig.toml";

/// Fails when a fault names a module, line or instrument that does not exist: the misspelt fault would have no effect.
pub(crate) fn check_targets<'a>(
    mut targets: impl Iterator<Item = &'a str>,
    expected: &str,
    known: impl Fn(&str) -> bool,
) -> Result<(), SimError> {
    match targets.find(|target| !known(target)) {
        None => Ok(()),
        Some(target) => Err(SimError::FaultValue {
            name: "target".into(),
            found: target.into(),
            expected: expected.into(),
        }),
    }
}

/// Builds the modules. The seed of the rig draws their errors; the noise seed, if any, draws their noise.
fn modules(
    file: &RigFile,
    table: &WorldTable,
    seed: u64,
    noise: Option<u64>,
) -> Result<Vec<Module>, ConfigError> {
    let module = |spec: &ModuleSpec| {
        let line = file.lines.iter().find(|line| line.name == spec.line);
        let commissioning = Commissioning {
            baud: line.map_or(9_600, |line| line.baud),
            checksum: line.is_some_and(|line| line.checksum),
            host_watchdog_ms: file.host_watchdog_ms,
        };
        let mut rng = tolerances::stream(seed, &spec.id);
        let tolerances = Tolerances::draw(&table.devices, &mut rng);
        let noise = noise.map(|noise| tolerances::stream(noise, &format!("noise of {}", spec.id)));
        Module::new(spec, commissioning, tolerances, noise.unwrap_or(rng))
    };
    file.modules.iter().map(module).collect()
}

impl SharedRig {
    /// Shares a rig.
    pub fn new(rig: Rig) -> Self {
        Self(Arc::new(Mutex::new(rig)))
    }

    /// See [`Rig::exchange`].
    pub fn exchange(&self, line: usize, text: &[u8], t_us: u64) -> Option<Reply> {
        self.rig().exchange(line, text, t_us)
    }

    /// See [`Rig::exchange_at`].
    pub fn exchange_at(
        &self,
        line: usize,
        host_baud: Option<u32>,
        text: &[u8],
        t_us: u64,
    ) -> Option<Reply> {
        self.rig().exchange_at(line, host_baud, text, t_us)
    }

    /// See [`Rig::unprompted`].
    pub fn unprompted(&self, line: usize, t_us: u64) -> Vec<Reply> {
        self.rig().unprompted(line, t_us)
    }

    /// See [`Rig::advance`].
    pub fn advance(&self, t_us: u64) {
        self.rig().advance(t_us);
    }

    /// Returns rig time, microseconds.
    pub fn now_us(&self) -> u64 {
        self.rig().now_us()
    }

    /// Starts to follow the wall clock; see [`Rig::start_real_time`].
    pub(crate) fn start_real_time(&self) -> Instant {
        self.rig().start_real_time()
    }

    /// Returns the instant of the wall clock at rig time 0.
    pub(crate) fn real_origin(&self) -> Instant {
        self.rig().real_origin()
    }

    /// Returns name and baud rate of each line, in the order of their numbers.
    pub fn lines(&self) -> Vec<(String, u32)> {
        let name = |line: &LineSpec| (line.name.clone(), line.baud);
        self.rig().lines().iter().map(name).collect()
    }

    /// See [`Rig::port_back_us`].
    pub fn port_back_us(&self, line: usize, t_us: u64) -> Option<u64> {
        self.rig().port_back_us(line, t_us)
    }

    /// See [`Rig::next_port_loss_us`].
    pub fn next_port_loss_us(&self, line: usize, t_us: u64) -> Option<u64> {
        self.rig().next_port_loss_us(line, t_us)
    }

    /// Counts the EEPROM writes of all modules.
    pub fn eeprom_writes(&self) -> u64 {
        self.rig().eeprom_writes()
    }

    /// Counts the EEPROM writes of each module, by identifier.
    pub fn eeprom_writes_by_module(&self) -> Vec<(String, u64)> {
        self.rig().eeprom_writes_by_module()
    }

    /// Records a late reply; see [`Rig::late_replies`].
    pub(crate) fn record_late(&self, line: usize, t_us: u64, late_us: u64) {
        self.rig().record_late(line, t_us, late_us);
    }

    /// See [`Rig::late_replies`].
    pub fn late_replies(&self) -> crate::journal::LateReplies {
        self.rig().late_replies()
    }

    /// See [`Rig::journal`].
    pub fn journal(&self) -> std::sync::mpsc::Receiver<crate::journal::Entry> {
        self.rig().journal()
    }

    /// Activates a fault, `NAME` or `NAME=VALUE`; times in the value count from now.
    ///
    /// # Errors
    /// Fails when the fault is unknown, its value is unfit, or it applies only to the start.
    pub fn inject(&self, fault: &str) -> Result<(), SimError> {
        self.rig().inject(fault)
    }

    /// Returns the truth of every lot part that has entered the nest, in order.
    pub fn truth(&self) -> Vec<serde_json::Value> {
        self.rig().record().truth()
    }

    /// Returns every body that has left the magazine, in order of leaving.
    pub fn bodies(&self) -> Vec<BodyTruth> {
        self.rig().record().bodies()
    }

    /// Replaces the parts in the magazine for another lot, as an operator does; only recipe, number of parts and
    /// reference parts of the options apply.
    ///
    /// # Errors
    /// Fails when a configuration file is missing or wrong; the magazine then stays unchanged.
    pub fn refill(&self, options: &Options) -> Result<(), SimError> {
        let options = options.of_world(Vec::new());
        self.rig().record().refill(&options)
    }

    /// Forgets the bodies that have left the line, and their truth: a rig that runs lot after lot must not grow.
    pub fn forget_finished(&self) {
        self.rig().record().forget_finished();
    }

    /// Cancels the faults of the world that have not struck yet; parameters of the whole rig stay.
    pub fn cancel_faults(&self) {
        self.rig().record().cancel_faults();
    }

    /// Returns every instrument from its front panel to remote control, as a person does at the instrument.
    pub fn release_panels(&self) {
        if let Some(instruments) = self.rig().instruments_mut() {
            instruments.release_panels();
        }
    }

    /// Returns the start of each recent motion that an output caused: microseconds and actuator.
    pub fn motion_starts(&self) -> Vec<(u64, &'static str)> {
        self.rig().record().motion_starts()
    }

    /// Returns a description of each crash.
    pub fn crashes(&self) -> Vec<String> {
        self.rig().record().crashes()
    }

    /// Returns every drive of a coil in a supply range above the commanded one, in order of time.
    pub fn overdrives(&self) -> Vec<Overdrive> {
        self.rig().record().overdrives().to_vec()
    }

    /// Returns every move of the main contacts of a contactor, in order of time.
    pub fn contact_moves(&self) -> Vec<ContactMove> {
        self.rig().record().contact_moves().to_vec()
    }

    /// Locks the rig. A poisoned lock is safe: a line that panics leaves the rig between two events.
    pub(crate) fn rig(&self) -> MutexGuard<'_, Rig> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
