//! Which rig a command works on: the one at serial ports, or the simulated one.

use anyhow::bail;
use std::path::PathBuf;

/// How rig time passes on the simulated rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum PaceArg {
    /// As fast as the machine can: in-process streams, virtual time that starts at the wall clock
    Virtual,
    /// At real speed, through pseudo-terminals
    Real,
}

/// The rig of a command.
#[derive(Debug, Clone, clap::Args)]
pub struct RigArgs {
    /// On the simulated rig
    #[arg(long)]
    pub sim: bool,
    /// How time passes on the simulated rig
    #[arg(long, value_enum, default_value = "virtual", requires = "sim")]
    pub pace: PaceArg,
    /// Virtual time, but at most X times as fast as the wall clock
    #[arg(long, value_name = "X", requires = "sim", value_parser = speed)]
    pub speed: Option<f64>,
    /// Draws rig and parts of the simulated rig
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

impl RigArgs {
    /// Refuses what does not go together.
    pub fn check(&self) -> anyhow::Result<()> {
        if self.speed.is_some() && !self.is_virtual() {
            bail!("--speed: found with --pace real, expected --pace virtual");
        }
        if self.sim && !cfg!(feature = "sim") {
            bail!("--sim: this is a plant build without the simulated rig");
        }
        Ok(())
    }

    /// The simulated rig in virtual time.
    pub fn is_virtual(&self) -> bool {
        self.sim && self.pace == PaceArg::Virtual
    }
}

/// No speed that a person can follow and a machine keep up with.
#[derive(Debug, thiserror::Error)]
#[error("found {0}, expected a number from 0.1 to 100")]
pub struct NoSpeed(String);

/// How often the wall clock.
pub fn speed(text: &str) -> Result<f64, NoSpeed> {
    let found = text.parse().ok();
    let sensible = found.filter(|it| (0.1..=100.0).contains(it));
    sensible.ok_or_else(|| NoSpeed(text.to_owned()))
}
