//! Which rig a run works on: the one at serial ports, or the simulated one.

#[cfg(feature = "sim")]
use super::simulated::LiveRig;
#[cfg(feature = "sim")]
use std::path::PathBuf;

/// The rig of a run.
#[derive(Debug, Clone)]
pub enum RigSource {
    /// Serial ports of `rig.toml`, except for the lines that are given another one.
    Serial(Vec<LinePort>),
    /// The simulated rig.
    #[cfg(feature = "sim")]
    Simulated(Simulated),
}

/// A line and the port that it gets instead of the one in `rig.toml`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinePort {
    /// Name of the line as wired.
    pub line: String,
    /// Path of the serial port.
    pub port: String,
}

/// How the simulated rig is drawn and how its time passes.
#[cfg(feature = "sim")]
#[derive(Debug, Clone)]
pub struct Simulated {
    /// How time passes.
    pub pace: SimulatedPace,
    /// Draws rig and parts.
    pub seed: u64,
    /// World instead of `sim.toml` of the configuration.
    pub world: Option<PathBuf>,
    /// Faults, `NAME[=VALUE[@FROM[..UNTIL]]]`.
    pub faults: Vec<String>,
    /// True values of every specimen go to this file.
    pub truth: Option<PathBuf>,
    /// A rig that lives before and after the run; none: one is built for the run.
    pub live: Option<Box<LiveRig>>,
}

/// How time passes on the simulated rig.
#[cfg(feature = "sim")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SimulatedPace {
    /// As fast as the computer can, in-process.
    Virtual,
    /// In-process, at most this many times as fast as the wall clock.
    Held(f64),
    /// As the wall clock, through pseudo-terminals.
    Real,
}

#[cfg(feature = "sim")]
impl Simulated {
    /// The default world in virtual time.
    pub fn drawn_by(seed: u64) -> Self {
        Self {
            pace: SimulatedPace::Virtual,
            seed,
            world: None,
            faults: Vec::new(),
            truth: None,
            live: None,
        }
    }
}

impl RigSource {
    /// The simulated rig as it lives; none: one is built for the run, or the rig is real.
    #[cfg(feature = "sim")]
    pub(super) fn live(&self) -> Option<&LiveRig> {
        match self {
            Self::Serial(_) => None,
            Self::Simulated(simulated) => simulated.live.as_deref(),
        }
    }

    /// The seed of the simulated rig; none of a real one.
    pub fn seed(&self) -> Option<u64> {
        match self {
            Self::Serial(_) => None,
            #[cfg(feature = "sim")]
            Self::Simulated(simulated) => Some(simulated.seed),
        }
    }

    /// Whether the simulated rig looks for bodies that touch (feature `bodies`); none of a real rig.
    pub fn bodies_watched(&self) -> Option<bool> {
        match self {
            Self::Serial(_) => None,
            #[cfg(feature = "sim")]
            Self::Simulated(_) => Some(rigsim::world::bodies::WATCHED),
        }
    }

    /// The rig is simulated.
    pub fn is_simulated(&self) -> bool {
        self.seed().is_some()
    }

    /// Time of the run is virtual: the runtime's clock is paused.
    pub fn is_virtual(&self) -> bool {
        match self {
            Self::Serial(_) => false,
            #[cfg(feature = "sim")]
            Self::Simulated(simulated) => simulated.pace != SimulatedPace::Real,
        }
    }

    /// How many times as fast as the wall clock virtual time may pass; none: unlimited, or not virtual.
    pub fn speed(&self) -> Option<f64> {
        match self {
            Self::Serial(_) => None,
            #[cfg(feature = "sim")]
            Self::Simulated(simulated) => match simulated.pace {
                SimulatedPace::Held(speed) => Some(speed),
                SimulatedPace::Virtual | SimulatedPace::Real => None,
            },
        }
    }
}
