//! Opens the lines of a run: serial ports, pseudo-terminals of the simulated rig, or in-process streams.

use super::{Controls, RunArgs};
use anyhow::{anyhow, bail};
use app::cycle::LineEnds;
use bus::{LineLog, LineSettings, Pace, SerialPorts};
use config::Plant;
use machine::rig::wiring::LineId;
use std::path::Path;
use tokio::sync::mpsc;

/// How long a silent module of a measuring line is asked who it is before the line goes on without it. Three tries
/// with this grace take 0.65 s, so the host watchdogs of the line's other modules still hear their host in time.
const LATE_REPLY_MS: u64 = 180;

/// Open lines, ready for the cycle.
pub struct Lines {
    /// The cycle's ends.
    pub ends: Vec<LineEnds>,
    /// Trace and health of each line, by name.
    pub logs: Vec<(String, LineLog)>,
}

/// The simulated rig behind the lines, or none.
pub struct Behind {
    #[cfg(feature = "sim")]
    rig: Option<rigsim::SharedRig>,
    #[cfg(feature = "sim")]
    _ptys: Option<rigsim::pty::Ptys>,
}

impl Behind {
    /// Counts the EEPROM writes of the simulated modules; nobody can on a rig.
    pub fn eeprom_count(&self) -> super::recorder::EepromCount {
        #[cfg(feature = "sim")]
        if let Some(rig) = &self.rig {
            let rig = rig.clone();
            return Box::new(move || Some(rig.eeprom_writes()));
        }
        Box::new(|| None)
    }

    /// The simulated rig, to meddle with.
    #[cfg(feature = "sim")]
    pub fn rig(&self) -> Option<rigsim::SharedRig> {
        self.rig.clone()
    }

    /// Writes the truth file and reports bodies that touched.
    pub fn finish(&self, args: &RunArgs) -> anyhow::Result<()> {
        #[cfg(feature = "sim")]
        if let Some(rig) = &self.rig {
            if let Some(path) = &args.truth {
                let lines: String = rig.truth().iter().map(|part| format!("{part}\n")).collect();
                std::fs::write(path, lines)
                    .map_err(|error| anyhow!("--truth {}: {error}", path.display()))?;
            }
            for crash in rig.crashes() {
                tracing::error!("bodies touched: {crash}");
            }
        }
        let _ = args;
        Ok(())
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
        // The line with the emergency stop keeps the shorter grace that its reaction bound is derived from.
        settings.late_reply_ms = LATE_REPLY_MS;
    }
    settings.log = LineLog::with_trace(4096);
    settings
}

struct Queues {
    ends: LineEnds,
    requests: mpsc::Receiver<bus::Request>,
    answers: mpsc::Sender<bus::Answer>,
}

fn queues(line: LineId) -> Queues {
    let (request_in, request_out) = mpsc::channel(1);
    let (answer_in, answer_out) = mpsc::channel(1);
    Queues {
        ends: LineEnds {
            line,
            requests: request_in,
            answers: answer_out,
        },
        requests: request_out,
        answers: answer_in,
    }
}

/// Opens every line of the plant.
pub fn open(
    plant: &Plant,
    config: &Path,
    args: &RunArgs,
    controls: &Controls,
    pace: &Pace,
) -> anyhow::Result<(Lines, Behind)> {
    #[cfg(feature = "sim")]
    if args.rig.sim {
        let rig = match controls.staged_rig() {
            Some(rig) => rig,
            None => simulated::build(plant, config, args)?,
        };
        return simulated::open(plant, rig, args, pace);
    }
    let _ = (config, controls);
    let mut lines = Lines {
        ends: Vec::new(),
        logs: Vec::new(),
    };
    let overrides = overrides(plant, &args.rig.line)?;
    for line in plant.wiring.line_ids() {
        let port = overrides
            .iter()
            .find(|(known, _)| *known == line)
            .map_or_else(
                || plant.wiring.line(line).port.clone(),
                |(_, port)| port.clone(),
            );
        serial(plant, line, &port, pace, &mut lines);
    }
    Ok((lines, Behind::none()))
}

impl Behind {
    fn none() -> Self {
        Self {
            #[cfg(feature = "sim")]
            rig: None,
            #[cfg(feature = "sim")]
            _ptys: None,
        }
    }
}

fn serial(plant: &Plant, line: LineId, port: &str, pace: &Pace, lines: &mut Lines) {
    let settings = settings(plant, line);
    lines
        .logs
        .push((settings.name.clone(), settings.log.clone()));
    let queues = queues(line);
    let ports = SerialPorts {
        path: port.to_string(),
        baud: settings.baud,
    };
    tokio::spawn(bus::run_reopening(
        ports,
        settings,
        *pace,
        queues.requests,
        queues.answers,
    ));
    lines.ends.push(queues.ends);
}

/// Lines by name and the ports they are to have instead of those of `rig.toml`.
///
/// # Errors
/// No `NAME=PORT`, or a line that is not wired.
pub fn overrides(plant: &Plant, given: &[String]) -> anyhow::Result<Vec<(LineId, String)>> {
    let one = |text: &String| {
        let Some((name, port)) = text.split_once('=') else {
            bail!("--line: found \"{text}\", expected NAME=PORT");
        };
        let known: Vec<&str> = plant
            .wiring
            .lines
            .iter()
            .map(|line| line.name.as_str())
            .collect();
        let line = plant.wiring.line_named(name).ok_or_else(|| {
            anyhow!(
                "--line: found \"{name}\", expected one of {}",
                known.join(", ")
            )
        })?;
        Ok((line, port.to_string()))
    };
    given.iter().map(one).collect()
}

#[cfg(feature = "sim")]
pub(in crate::cli) mod simulated {
    use super::{Behind, Lines, Pace, Path, Plant, RunArgs, anyhow, queues, serial, settings};
    use crate::cli::plug::PlugPorts;
    use rigsim::pty::{self, Rates};
    use rigsim::{Options, SharedRig, wire};

    /// The faults asked for; and the magazine is loaded as the golden checks of the lot want it, as a person would.
    fn faults(plant: &Plant, args: &RunArgs) -> Vec<String> {
        let mut faults = args.rig.fault.clone();
        let asked = faults.iter().any(|it| it.starts_with("golden_every"));
        let every = plant.lot.golden_check.after_parts.filter(|_| !asked);
        faults.extend(every.map(|every| format!("golden_every={every}")));
        faults
    }

    /// The rig that the arguments ask for, golden parts and the lot in its magazine.
    fn loaded(plant: &Plant, config: &Path, args: &RunArgs) -> Options {
        Options {
            config_dir: config.to_path_buf(),
            world: args.rig.world.clone(),
            seed: args.rig.seed,
            recipe: args.recipe.clone(),
            parts: args.count,
            reference_parts: true,
            faults: faults(plant, args),
        }
    }

    /// The rig that the arguments ask for.
    pub fn build(plant: &Plant, config: &Path, args: &RunArgs) -> anyhow::Result<SharedRig> {
        Ok(rigsim::build(&loaded(plant, config, args))?)
    }

    /// The same with an empty magazine.
    pub fn build_empty(plant: &Plant, config: &Path, args: &RunArgs) -> anyhow::Result<SharedRig> {
        Ok(rigsim::build(&Options {
            parts: Some(0),
            reference_parts: false,
            ..loaded(plant, config, args)
        })?)
    }

    /// What a person does before a lot: empties the magazine and loads it.
    pub fn load(
        rig: &SharedRig,
        plant: &Plant,
        config: &Path,
        args: &RunArgs,
    ) -> anyhow::Result<()> {
        Ok(rig.refill(&loaded(plant, config, args))?)
    }

    /// The simulated rig behind its lines.
    pub fn open(
        plant: &Plant,
        rig: SharedRig,
        args: &RunArgs,
        pace: &Pace,
    ) -> anyhow::Result<(Lines, Behind)> {
        let mut lines = Lines {
            ends: Vec::new(),
            logs: Vec::new(),
        };
        if !args.rig.is_virtual() {
            let ptys = pty::serve(&rig, Rates::Ignored)?;
            for (name, path) in ptys.paths() {
                let line = plant
                    .wiring
                    .line_named(&name)
                    .ok_or_else(|| anyhow!("line {name} is not wired"))?;
                serial(plant, line, &path.to_string_lossy(), pace, &mut lines);
            }
            return Ok((
                lines,
                Behind {
                    rig: Some(rig),
                    _ptys: Some(ptys),
                },
            ));
        }
        for (name, plug) in wire::plugs(&rig) {
            let line = plant
                .wiring
                .line_named(&name)
                .ok_or_else(|| anyhow!("line {name} is not wired"))?;
            let settings = settings(plant, line);
            lines.logs.push((name, settings.log.clone()));
            let queues = queues(line);
            tokio::spawn(bus::run_reopening(
                PlugPorts(plug),
                settings,
                *pace,
                queues.requests,
                queues.answers,
            ));
            lines.ends.push(queues.ends);
        }
        Ok((
            lines,
            Behind {
                rig: Some(rig),
                _ptys: None,
            },
        ))
    }
}
