//! The file of instruments that `sim --instruments` serves.

use std::collections::BTreeSet;
use std::ops::RangeInclusive;
use std::path::Path;

use super::adapter::Adapter;
use super::bench::{Bench, Instruments, SharedBench};
use super::circuit::Circuit;
use super::device::Device;
use super::instrument::{self, Channel, Fitting, Model};
use super::line::{Line, Unrest};
use super::passive::Passive;
use super::port::{Behind, Port};
use super::relay::{Defect, Kind, SolidState, Truth};
use crate::config::ConfigError;
use crate::error::SimError;
use crate::fault::instrument::InstrumentFaults;
use crate::module::setting;
use crate::shared::{check_targets, split};
use crate::table::{Entry, Table};

/// Permitted load resistance, ohms: with a snubber it gives a time constant short against a cycle of the line.
const LOAD_OHM: RangeInclusive<f64> = 0.1..=10_000.0;

/// Link by which a host reaches an instrument or adapter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// TCP socket on the loopback interface; port 0 chooses a free one.
    Tcp(u16),
    /// Pseudo-terminal at this baud rate.
    Serial(u32),
}

impl Link {
    /// Returns the time of one character, microseconds; 0 over TCP.
    pub fn character_us(self) -> u64 {
        match self {
            Self::Tcp(_) => 0,
            Self::Serial(baud) => 10_000_000 / u64::from(baud),
        }
    }

    fn read(keys: &Table) -> Result<Self, ConfigError> {
        let tcp = keys.fit("tcp", "a port from 0 to 65535", Entry::whole)?;
        let baud = keys.fit("baud", "a rate from 1 baud", |it| {
            it.whole().filter(|baud| *baud > 0)
        })?;
        match (tcp, baud) {
            (Some(port), None) => Ok(Self::Tcp(port)),
            (None, Some(baud)) => Ok(Self::Serial(baud)),
            (Some(_), Some(_)) => Err(keys.wrong("baud", "one of `tcp` and `baud`")),
            (None, None) => Err(keys.wrong("tcp", "`tcp`, `baud`, or `adapter` with `gpib`")),
        }
    }
}

/// Builds the instruments of a file.
///
/// # Errors
/// Fails when the file cannot be read, a key is unknown, a value does not fit, or a fault is unknown.
pub fn build(file: &Path, seed: u64, faults: &[String]) -> Result<SharedBench, SimError> {
    built(&Table::of_file(file)?, seed, faults)
}

/// Builds the instruments from the text of such a file.
///
/// # Errors
/// Fails as [`build`] does.
pub fn build_text(text: &str, seed: u64, faults: &[String]) -> Result<SharedBench, SimError> {
    built(&Table::parse(Path::new("-"), text)?, seed, faults)
}

fn built(keys: &Table, seed: u64, faults: &[String]) -> Result<SharedBench, SimError> {
    let circuit = circuit(keys.get("circuit")?, seed)?;
    let adapters: Option<Vec<Table>> = keys.get("adapter")?;
    let instruments: Vec<Table> = keys.get("instrument")?;
    keys.finish()?;
    let mut names = BTreeSet::new();
    let mut adapters = adapters
        .unwrap_or_default()
        .iter()
        .map(|keys| adapter(keys, &mut names))
        .collect::<Result<Vec<_>, _>>()?;
    let (mut devices, mut ports): (Vec<Device>, Vec<Port>) = Default::default();
    for keys in &instruments {
        let (name, number) = (name(keys, &mut names)?, devices.len());
        match keys.get::<Option<String>>("adapter")? {
            Some(_) => attach(keys, number, &mut adapters)?,
            None => {
                let link = Link::read(keys)?;
                ports.push(Port::new(name.clone(), link, Behind::Instrument(number)));
            }
        }
        let model = keys.get("model")?;
        let instrument = instrument::build(model, &name, seed, fitting(keys, model)?);
        keys.finish()?;
        devices.push(Device::new(name, instrument));
    }
    ports.extend(
        adapters
            .into_iter()
            .map(|(name, link, it)| Port::new(name, link, Behind::Adapter(it))),
    );
    let faults = active(faults, seed, |target| names.contains(target))?;
    let instruments = Instruments {
        devices,
        ports,
        faults,
    };
    Ok(SharedBench::new(Bench {
        instruments,
        circuit,
        now_us: 0,
    }))
}

/// Reads a name; fails when an instrument or adapter already has it, because faults find their targets by name.
fn name(keys: &Table, names: &mut BTreeSet<String>) -> Result<String, ConfigError> {
    let name: String = keys.get("name")?;
    match names.insert(name.clone()) {
        true => Ok(name),
        false => Err(keys.wrong("name", "a name that no other instrument or adapter has")),
    }
}

fn adapter(
    keys: &Table,
    names: &mut BTreeSet<String>,
) -> Result<(String, Link, Adapter), ConfigError> {
    let (name, link) = (name(keys, names)?, Link::read(keys)?);
    keys.finish()?;
    let adapter = Adapter::new(&name);
    Ok((name, link, adapter))
}

/// Connects an instrument to the adapter that its keys name.
fn attach(
    keys: &Table,
    number: usize,
    adapters: &mut [(String, Link, Adapter)],
) -> Result<(), ConfigError> {
    let named = |(name, ..): &&mut (String, Link, Adapter)| {
        keys.find("adapter").and_then(Entry::text) == Some(name)
    };
    let known = adapters.iter_mut().find(named);
    let (.., adapter) = known.ok_or_else(|| keys.wrong("adapter", "the name of an [[adapter]]"))?;
    let form = "an address from 0 to 30 that no other instrument has";
    let free = |it: &Entry| {
        it.whole()
            .filter(|it| *it <= 30 && !adapter.instruments.contains_key(it))
    };
    let address = keys.fit("gpib", form, free)?;
    let address = address.ok_or_else(|| keys.wrong("gpib", form))?;
    adapter.instruments.insert(address, number);
    Ok(())
}

/// Reads the keys that depend on the model: a digitizer has channels, any other model has one pair of terminals.
pub(super) fn fitting(keys: &Table, model: Model) -> Result<Fitting, ConfigError> {
    let latency_ms = setting::number(keys, "latency_ms", 0.0..=1e6)?;
    let (mut at, mut channels) = (None, Vec::new());
    if model.is_digitizer() {
        channels = keys.get_or("channel", channels)?;
        let fits = |it: &Channel| it.ratio.is_finite() && it.ratio != 0.0;
        if channels.len() > Model::CHANNELS || !channels.iter().all(fits) {
            let form = format!("at most {} channels, ratios other than 0", Model::CHANNELS);
            return Err(keys.wrong("channel", &form));
        }
    } else {
        at = keys.get("at")?;
    }
    Ok(Fitting {
        at,
        channels,
        identity: keys.get("identity")?,
        latency_us: latency_ms.map(|ms| (ms * 1e3) as u64),
        exact: keys.get_or("exact", false)?,
    })
}

/// Reads the circuit that the instruments measure: resistors, or a relay with a line.
fn circuit(keys: Option<Table>, seed: u64) -> Result<Box<dyn Circuit>, ConfigError> {
    let keys = match keys {
        Some(keys) => keys,
        None => Table::parse(Path::new("-"), "")?,
    };
    let kind = keys.get_or("kind", Kind::Passive)?;
    let ohms = |key| Ok(setting::number(&keys, key, 0.0..=f64::INFINITY)?.unwrap_or(1e3));
    let unrest = match keys.get_or("distorted", true)? {
        true => Unrest::USUAL,
        false => Unrest::NONE,
    };
    let line = Line::new(seed, unrest);
    let load_ohm = setting::number(&keys, "load_ohm", LOAD_OHM)?.unwrap_or(2_300.0);
    let circuit: Box<dyn Circuit> = match kind {
        Kind::Passive => {
            let (input_ohm, output_ohm) = (ohms("input_ohm")?, ohms("output_ohm")?);
            Box::new(Passive::new(input_ohm, output_ohm, load_ohm, line))
        }
        Kind::Dc | Kind::AcZeroCross | Kind::AcRandom => {
            let defect: Option<Defect> = keys.get("defect")?;
            if defect.is_some_and(|defect| !defect.fits(kind)) {
                return Err(keys.wrong("defect", "a defect that this kind of relay can have"));
            }
            let truth = Truth::draw(kind, defect, seed);
            let load_h = setting::number(&keys, "load_h", 0.0..=1e3)?.unwrap_or(0.0);
            Box::new(SolidState::new(truth, line, load_ohm, load_h))
        }
    };
    keys.finish()?;
    Ok(circuit)
}

/// Returns the active faults of the command line.
fn active(
    faults: &[String],
    seed: u64,
    known: impl Fn(&str) -> bool,
) -> Result<InstrumentFaults, SimError> {
    let mut active = InstrumentFaults::none(seed);
    for text in faults {
        let (name, value) = split(text);
        if !active.add(name, value)? {
            return Err(SimError::UnknownFault { name: name.into() });
        }
    }
    let expected = "an instrument or adapter of the file";
    check_targets(active.targets(), expected, known)?;
    Ok(active)
}
