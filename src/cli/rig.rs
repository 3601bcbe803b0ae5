//! The rig of a command: at serial ports, or simulated.

use anyhow::{Context, bail};
use app::source::{LinePort, RigSource};
#[cfg(feature = "sim")]
use app::source::{Simulated, SimulatedPace};
use clap::builder::PossibleValuesParser;
use config::Folder;
use std::path::PathBuf;

/// Clock of the simulated rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum PaceArg {
    /// As fast as the machine can: in-process streams, virtual time that starts at the wall clock
    Virtual,
    /// At real speed, through pseudo-terminals
    Real,
}

/// Options that choose the rig of a command: the simulated one, or a real one at serial ports.
#[derive(Debug, Clone, clap::Args)]
pub struct RigArgs {
    /// On the simulated rig
    #[arg(long)]
    pub sim: bool,
    /// Clock of the simulated rig
    #[arg(long, value_enum, default_value = "virtual", requires = "sim")]
    pub pace: PaceArg,
    /// Virtual time, but at most X times as fast as the wall clock
    #[arg(long, value_name = "X", requires = "sim", value_parser = speed)]
    pub speed: Option<f64>,
    /// Seed of the simulated rig and its parts
    #[arg(long, value_name = "N", default_value_t = 1, requires = "sim")]
    pub seed: u64,
    /// World of the simulated rig instead of config/sim.toml
    #[arg(long, value_name = "FILE", requires = "sim")]
    pub world: Option<PathBuf>,
    /// Fault of the simulated rig, see `relayrig sim --faults`
    #[arg(long, value_name = "NAME[=VALUE]", requires = "sim")]
    pub fault: Vec<String>,
    /// Port of a line instead of the one in rig.toml
    #[arg(long, value_name = "NAME=PORT", conflicts_with = "sim")]
    pub line: Vec<String>,
}

/// Returns the parser of `--rig`, which takes the names of the rigs inside this program.
pub fn built_in() -> PossibleValuesParser {
    PossibleValuesParser::new(Folder::built_in_rigs())
}

/// Returns the recipe that a command takes without `--recipe`: the first usual recipe that the configuration has, or else
/// the first of all its recipes.
pub fn usual_recipe(config: &Folder) -> String {
    const USUAL: [&str; 3] = ["jzc-22f-012", "ssr-dc-60v-3a", "thermostat-ksd9700"];
    let names = config::recipe_names(config);
    let usual = USUAL
        .into_iter()
        .find(|it| names.iter().any(|name| name == it));
    let chosen = usual
        .map(str::to_owned)
        .or_else(|| names.into_iter().next());
    chosen.unwrap_or_else(|| USUAL[0].to_owned())
}

impl RigArgs {
    /// Returns the rig that these arguments choose; a simulated rig writes its true values to `truth`.
    ///
    /// # Errors
    /// Fails when options exclude each other, when a line has no port, or when the build lacks the simulated rig.
    pub fn source(&self, truth: Option<PathBuf>) -> anyhow::Result<RigSource> {
        if self.speed.is_some() && !(self.sim && self.pace == PaceArg::Virtual) {
            bail!("--speed: found with --pace real, expected --pace virtual");
        }
        if !self.sim {
            let ports: anyhow::Result<Vec<LinePort>> = self.line.iter().map(port).collect();
            return Ok(RigSource::Serial(ports?));
        }
        self.simulated(truth)
    }

    #[cfg(feature = "sim")]
    fn simulated(&self, truth: Option<PathBuf>) -> anyhow::Result<RigSource> {
        Ok(RigSource::Simulated(Simulated {
            pace: match (self.pace, self.speed) {
                (PaceArg::Real, _) => SimulatedPace::Real,
                (PaceArg::Virtual, None) => SimulatedPace::Virtual,
                (PaceArg::Virtual, Some(speed)) => SimulatedPace::Held(speed),
            },
            seed: self.seed,
            world: self.world.clone(),
            faults: self.fault.clone(),
            truth,
            live: None,
        }))
    }

    #[cfg(not(feature = "sim"))]
    fn simulated(&self, _: Option<PathBuf>) -> anyhow::Result<RigSource> {
        bail!("--sim: this is a plant build without the simulated rig");
    }
}

/// Reads `NAME=PORT`.
pub(super) fn port(text: &String) -> anyhow::Result<LinePort> {
    let (line, port) = text
        .split_once('=')
        .with_context(|| format!("--line: found \"{text}\", expected NAME=PORT"))?;
    Ok(LinePort {
        line: line.to_owned(),
        port: port.to_owned(),
    })
}

/// Error: the text is no speed in the accepted range.
#[derive(Debug, thiserror::Error)]
#[error("found {0}, expected a number from 0.1 to 1000")]
pub struct SpeedError(String);

/// Reads a speed, in multiples of the wall clock.
pub fn speed(text: &str) -> Result<f64, SpeedError> {
    let found = text.parse().ok();
    let sensible = found.filter(|it| (0.1..=1000.0).contains(it));
    sensible.ok_or_else(|| SpeedError(text.to_owned()))
}
