//! Opens the lines of a run: serial ports, pseudo-terminals of the simulated rig, or in-process streams.

use super::instrument_log::InstrumentLog;
use super::instrument_tasks::{InstrumentTask, InstrumentTasks};
use super::lot::{LotContext, Purpose};
use super::real_time::Keeper;
use super::source::{LinePort, RigSource};
#[cfg(feature = "sim")]
use super::{simulated, source::Simulated, truth_file::TruthFile};
use anyhow::anyhow;
#[cfg(feature = "sim")]
use bus::instrument::Opener;
use bus::{LineLog, LineSettings, OpenPort, Pace, Reading};
use config::{Plant, SerialReaderSettings};
use cycle::{InstrumentEnds, LineEnds};
use machine::handling::serial::SourceName;
#[cfg(feature = "sim")]
use machine::rig::instruments::InstrumentWiring;
use machine::rig::wiring::LineId;
#[cfg(feature = "sim")]
use rigsim::{SharedRig, pty, scpi::serve::Served, wire};
use scpi::LinkAddress;
use tokio::sync::mpsc;

/// How long a measuring line waits for a late reply, ms. The line requests the name of a silent module three times; at
/// this wait the three requests take 0.65 s, so the host watchdogs of the line's other modules receive their heartbeat
/// in time.
const LATE_REPLY_MS: u64 = 180;

/// Name of the code reader's line for `--line` and on the simulated rig.
const READER: &str = "serial_reader";
/// Number of code readings that may wait for the cycle.
const READINGS: usize = 16;

/// Returns the code reader that gives this run its serial numbers; `None` for a run without a code reader.
fn reader<'a>(context: &LotContext<'a>) -> Option<&'a SerialReaderSettings> {
    let source = context.plant.lot.serial.as_ref().map(|it| it.source);
    let reads = context.purpose == Purpose::Lot && source == Some(SourceName::Reader);
    context.plant.serial_reader.as_ref().filter(|_| reads)
}

/// Function that returns the number of EEPROM writes of all modules so far; `None` on a real rig, whose modules keep no
/// count.
pub type EepromCount = Box<dyn Fn() -> Option<u64> + Send>;

/// Open lines, ready for the cycle.
pub struct Lines {
    /// Runs the tasks of lines and instruments.
    keeper: Keeper,
    /// Queue ends that the cycle holds, in the order of the wiring.
    pub ends: Vec<LineEnds>,
    /// Queue ends that the cycle holds for the instruments, in the order of the wiring.
    pub instruments: Vec<InstrumentEnds>,
    instrument_tasks: Vec<InstrumentTask>,
    /// Readings of the code reader; `None` in a lot without a code reader.
    pub readings: Option<mpsc::Receiver<Reading>>,
    /// Trace and health of each line, with its name.
    pub logs: Vec<(String, LineLog)>,
    /// Traffic and health of each instrument.
    pub(super) instrument_logs: Vec<InstrumentLog>,
    /// The simulated rig behind the lines; `None` on a real rig.
    #[cfg(feature = "sim")]
    rig: Option<SharedRig>,
    #[cfg(feature = "sim")]
    _ptys: Option<pty::Ptys>,
    /// Ports of simulated instruments, which close when the run ends.
    #[cfg(feature = "sim")]
    _served: Option<Served>,
}

impl Lines {
    fn none(keeper: &Keeper) -> Self {
        Self {
            keeper: keeper.clone(),
            ends: Vec::new(),
            instruments: Vec::new(),
            instrument_tasks: Vec::new(),
            readings: None,
            logs: Vec::new(),
            instrument_logs: Vec::new(),
            #[cfg(feature = "sim")]
            rig: None,
            #[cfg(feature = "sim")]
            _ptys: None,
            #[cfg(feature = "sim")]
            _served: None,
        }
    }

    /// Returns a counter of the simulated modules' EEPROM writes.
    pub fn eeprom_count(&self) -> EepromCount {
        #[cfg(feature = "sim")]
        if let Some(rig) = self.rig.clone() {
            return Box::new(move || Some(rig.eeprom_writes()));
        }
        Box::new(|| None)
    }

    fn keep(&mut self, opened: Vec<(InstrumentEnds, InstrumentTask)>) {
        (self.instruments, self.instrument_tasks) = opened.into_iter().unzip();
        let tasks = self.instrument_tasks.iter();
        self.instrument_logs = tasks.map(|it| it.log.clone()).collect();
    }

    /// Waits until the task of every instrument has ended, and so has made its instrument safe or given up.
    pub async fn end_instruments(&mut self) {
        for task in std::mem::take(&mut self.instrument_tasks) {
            task.end().await;
        }
    }

    /// Finishes a run on a simulated rig: writes the truth file, logs collisions, late replies and overdriven coils.
    ///
    /// # Errors
    /// Fails when the file cannot be written.
    pub fn finish(&self, source: &RigSource) -> anyhow::Result<()> {
        match source {
            RigSource::Serial(_) => {}
            #[cfg(feature = "sim")]
            RigSource::Simulated(simulated) => {
                let Some(rig) = &self.rig else { return Ok(()) };
                if let Some(path) = &simulated.truth {
                    TruthFile::create(path)?.write_rest(rig)?;
                }
                for crash in rig.crashes() {
                    tracing::error!("bodies touched: {crash}");
                }
                let late = rig.late_replies();
                if late.count > 0 {
                    let worst_ms = late.worst_us / 1000;
                    tracing::warn!(
                        "this computer made {} replies of the simulated rig late, the latest by {worst_ms} ms",
                        late.count
                    );
                }
                for overdrive in rig.overdrives() {
                    tracing::error!("coil overdriven: {overdrive}");
                }
            }
        }
        Ok(())
    }

    /// Opens a line at a serial port or pseudo-terminal.
    fn serial(&mut self, plant: &Plant, line: LineId, port: &str, pace: &Pace) {
        let path = port.to_string();
        let baud = plant.wiring.line(line).baud;
        self.open(plant, line, bus::serial_port(path, baud), pace);
    }

    /// Starts the task of the code reader; `open` opens the port, and again after every failure.
    fn open_reader(&mut self, settings: &SerialReaderSettings, open: OpenPort, pace: &Pace) {
        let (given, readings) = mpsc::channel(READINGS);
        let reading = bus::run_reader(open, settings.no_code.clone(), *pace, given);
        self.keeper.handle.spawn(reading);
        self.readings = Some(readings);
    }

    /// Starts the task of a line; `open` opens the port, and again after every failure.
    fn open(&mut self, plant: &Plant, line: LineId, open: OpenPort, pace: &Pace) {
        let settings = settings(plant, line);
        self.logs
            .push((settings.name.clone(), settings.log.clone()));
        let (requests, requested) = mpsc::channel(1);
        let (answer, answers) = mpsc::channel(1);
        let serving = bus::run_reopening(open, settings, *pace, requested, answer);
        bus::spawn(&self.keeper.handle, serving);
        self.ends.push(LineEnds {
            line,
            requests,
            answers,
        });
    }
}

fn settings(plant: &Plant, line: LineId) -> LineSettings {
    let (wired, bus) = (plant.wiring.line(line), &plant.wiring.bus);
    let mut settings = LineSettings::new(&wired.name, wired.baud);
    settings.checksum = wired.checksum;
    settings.digital_allowance_ms = bus.digital_allowance_ms as u64;
    settings.analog_allowance_ms = bus.analog_allowance_ms as u64;
    if line
        != plant
            .wiring
            .module(plant.wiring.emergency_stop_module())
            .line
    {
        // The line with the emergency stop keeps the shorter wait, on which its guaranteed reaction time depends.
        settings.late_reply_ms = LATE_REPLY_MS;
    }
    settings.log = LineLog::with_trace(4096);
    settings
}

/// Opens every line and instrument of the plant; `keeper` runs their tasks.
///
/// # Errors
/// Fails when `--line` names a line that the wiring lacks, or when the simulated rig cannot be built or lacks an
/// instrument.
pub async fn open(context: &LotContext<'_>, pace: &Pace, keeper: &Keeper) -> anyhow::Result<Lines> {
    let lines = Lines::none(keeper);
    match context.source {
        RigSource::Serial(given) => serial(lines, context, given, pace),
        #[cfg(feature = "sim")]
        RigSource::Simulated(source) => {
            let rig = match &source.live {
                Some(live) => live.rig.clone(),
                None => simulated::build(context.plant, source, context.order)?,
            };
            simulated_lines(lines, context, (source, rig), pace).await
        }
    }
}

fn serial(
    mut lines: Lines,
    context: &LotContext,
    given: &[LinePort],
    pace: &Pace,
) -> anyhow::Result<Lines> {
    let plant = context.plant;
    check(plant, given)?;
    let port = |name: &str, wired: &str| {
        let other = given.iter().find(|it| it.line == name);
        other.map_or(wired, |it| &it.port).to_owned()
    };
    for line in plant.wiring.line_ids() {
        let wired = plant.wiring.line(line);
        lines.serial(plant, line, &port(&wired.name, &wired.port), pace);
    }
    if let Some(reader) = reader(context) {
        let port = port(READER, &reader.port);
        lines.open_reader(reader, bus::serial_port(port, reader.baud), pace);
    }
    let tasks = instrument_tasks(&lines.keeper, plant, pace, started_us());
    let opened = tasks.open_all(|name| {
        let other = given.iter().find(|it| it.line == name)?;
        other.port.parse().ok()
    });
    lines.keep(opened);
    Ok(lines)
}

fn instrument_tasks<'a>(
    keeper: &'a Keeper,
    plant: &'a Plant,
    pace: &'a Pace,
    seed: u64,
) -> InstrumentTasks<'a> {
    let wiring = &plant.wiring;
    InstrumentTasks {
        keeper,
        wiring,
        pace,
        seed,
    }
}

/// Returns the present time, microseconds since 1970 UTC: a seed that no other run has.
fn started_us() -> u64 {
    jiff::Timestamp::now().as_microsecond().unsigned_abs()
}

/// Checks that the wiring has every line or instrument that `--line` names, and that the link given for an instrument
/// is a valid address.
///
/// # Errors
/// Fails on the first name that the wiring lacks, and on an invalid address.
pub fn check(plant: &Plant, given: &[LinePort]) -> anyhow::Result<()> {
    let wired = plant.wiring.lines.iter().map(|line| line.name.as_str());
    let reader = plant.serial_reader.as_ref().map(|_| READER);
    let instruments = plant.wiring.instruments.iter().map(|it| it.name.as_str());
    let known: Vec<&str> = wired.chain(reader).chain(instruments).collect();
    for LinePort { line, port } in given {
        let is_instrument = plant.wiring.instrument_named(line).is_some();
        if is_instrument && let Err(error) = port.parse::<LinkAddress>() {
            return Err(anyhow!("--line {line}: {error}"));
        }
    }
    match given.iter().find(|it| !known.contains(&it.line.as_str())) {
        Some(LinePort { line, .. }) => Err(anyhow!(
            "--line: found \"{line}\", expected one of {}",
            known.join(", ")
        )),
        None => Ok(()),
    }
}

#[cfg(feature = "sim")]
async fn simulated_lines(
    mut lines: Lines,
    context: &LotContext<'_>,
    (source, rig): (&Simulated, SharedRig),
    pace: &Pace,
) -> anyhow::Result<Lines> {
    let plant = context.plant;
    let reader = reader(context);
    let named = |name: &str| {
        let line = plant.wiring.line_named(name);
        line.ok_or_else(|| anyhow!("line {name} is not wired"))
    };
    if source.is_real() {
        let ptys = pty::serve(&rig, pty::Rates::Ignored)?;
        for (name, path) in ptys.paths() {
            let path = path.to_string_lossy();
            match (name == READER, reader) {
                (true, Some(reader)) => {
                    let port = bus::serial_port(path.into_owned(), reader.baud);
                    lines.open_reader(reader, port, pace);
                }
                (true, None) => {}
                (false, _) => lines.serial(plant, named(&name)?, &path, pace),
            }
        }
        lines._ptys = Some(ptys);
        let served = rig.serve_instruments().await?;
        let tasks = instrument_tasks(&lines.keeper, plant, pace, started_us());
        let opened = tasks.open_all(|name| {
            let (_, link) = served.links.iter().find(|it| it.0 == name)?;
            link.parse().ok()
        });
        lines.keep(opened);
        lines._served = Some(served);
    } else {
        let tasks = instrument_tasks(&lines.keeper, plant, pace, source.seed);
        let opened = plugged(&tasks, &rig)?;
        lines.keep(opened);
        for (name, plug) in wire::plugs(&rig) {
            let mut open = bus::from_streams(move || plug.open());
            match (name == READER, reader) {
                (true, Some(reader)) => lines.open_reader(reader, open, pace),
                // Nobody reads codes: the simulated reader ends when its port is opened and closed at once.
                (true, None) => drop(open()),
                (false, _) => lines.open(plant, named(&name)?, open, pace),
            }
        }
    }
    lines.rig = Some(rig);
    Ok(lines)
}

/// Starts the task of each instrument of a simulated rig in virtual time.
#[cfg(feature = "sim")]
fn plugged(
    tasks: &InstrumentTasks,
    rig: &SharedRig,
) -> anyhow::Result<Vec<(InstrumentEnds, InstrumentTask)>> {
    let plugs = rig.instrument_plugs();
    let open = |instrument| {
        let InstrumentWiring { name, link, .. } = tasks.wiring.instrument(instrument);
        let place = link.place();
        let here = |it: &&(String, _)| it.0 == *name || (link.gpib.is_some() && it.0 == place);
        let (_, plug) = plugs.iter().find(here).ok_or_else(|| {
            anyhow!("instrument {name}: found none on the simulated rig, expected one at {link}")
        })?;
        let plug = plug.clone();
        let opener = Opener::Streams(bus::from_streams(move || plug.open()));
        Ok(tasks.open(instrument, link, opener))
    };
    tasks.wiring.instrument_ids().map(open).collect()
}
