//! Selects the rig of a run: the real rig at serial ports, or a simulated rig.

#[cfg(feature = "sim")]
use super::simulated::LiveRig;
#[cfg(feature = "sim")]
use std::path::PathBuf;

/// Rig of a run.
#[derive(Debug, Clone)]
pub enum RigSource {
    /// The rig at the ports of `rig.toml`; an entry of the list replaces a port.
    Serial(Vec<LinePort>),
    /// The simulated rig.
    #[cfg(feature = "sim")]
    Simulated(Simulated),
}

/// A line, code reader or instrument, with the port or link that replaces the one in `rig.toml`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinePort {
    /// Name in `rig.toml`; `serial_reader` for the code reader.
    pub line: String,
    /// Path of the serial port; for an instrument, the address of its link.
    pub port: String,
}

/// Options of the simulated rig.
#[cfg(feature = "sim")]
#[derive(Debug, Clone)]
pub struct Simulated {
    /// How fast rig time runs.
    pub pace: SimulatedPace,
    /// Seed of the rig's errors and of its parts.
    pub seed: u64,
    /// World file in place of the configuration's `sim.toml`.
    pub world: Option<PathBuf>,
    /// Faults, `NAME[=VALUE[@FROM[..UNTIL]]]`.
    pub faults: Vec<String>,
    /// File for the true values of every part; `None`: none is written.
    pub truth: Option<PathBuf>,
    /// Simulated rig that exists before and after the run; `None`: the run builds a rig of its own.
    pub live: Option<Box<LiveRig>>,
}

/// Pace of rig time on the simulated rig.
#[cfg(feature = "sim")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SimulatedPace {
    /// In one process, as fast as the computer allows.
    Virtual,
    /// In one process, at most this many times as fast as the wall clock.
    Held(f64),
    /// At the pace of the wall clock, through pseudo-terminals.
    Real,
}

#[cfg(feature = "sim")]
impl Simulated {
    /// Returns options with this seed: the default world, virtual time, no faults.
    pub fn with_seed(seed: u64) -> Self {
        Self {
            pace: SimulatedPace::Virtual,
            seed,
            world: None,
            faults: Vec::new(),
            truth: None,
            live: None,
        }
    }

    /// Returns true at the pace of the wall clock.
    pub(super) fn is_real(&self) -> bool {
        self.pace == SimulatedPace::Real
    }

    /// Returns the source of a run on `live`, which the run neither builds nor drops.
    pub fn on(self, live: LiveRig) -> RigSource {
        RigSource::Simulated(Self {
            live: Some(Box::new(live)),
            ..self
        })
    }
}

impl RigSource {
    /// Returns the live simulated rig; `None` when the run builds one, or on a real rig.
    #[cfg(feature = "sim")]
    pub(super) fn live(&self) -> Option<&LiveRig> {
        match self {
            Self::Serial(_) => None,
            Self::Simulated(simulated) => simulated.live.as_deref(),
        }
    }

    /// Returns the seed of the simulated rig; `None` on a real rig.
    pub fn seed(&self) -> Option<u64> {
        match self {
            Self::Serial(_) => None,
            #[cfg(feature = "sim")]
            Self::Simulated(simulated) => Some(simulated.seed),
        }
    }

    /// Returns whether the simulated rig checks bodies for contact (feature `bodies`); `None` on a real rig.
    pub fn bodies_watched(&self) -> Option<bool> {
        match self {
            Self::Serial(_) => None,
            #[cfg(feature = "sim")]
            Self::Simulated(_) => Some(rigsim::world::bodies::WATCHED),
        }
    }

    /// Returns true for a simulated rig.
    pub fn is_simulated(&self) -> bool {
        self.seed().is_some()
    }

    /// Returns true when rig time is virtual.
    pub fn is_virtual(&self) -> bool {
        match self {
            Self::Serial(_) => false,
            #[cfg(feature = "sim")]
            Self::Simulated(simulated) => simulated.pace != SimulatedPace::Real,
        }
    }

    /// Returns true when rig time runs as fast as the computer allows.
    pub fn is_unlimited(&self) -> bool {
        self.is_virtual() && self.speed().is_none()
    }

    /// Returns the largest ratio of rig time to wall time in virtual time; `None`: unlimited, or not virtual.
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
