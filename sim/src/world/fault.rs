//! Faults of the world that can be asked for by name.

use std::path::Path;

use super::table::FaultSpec;
use crate::config::ConfigError;
use std::collections::BTreeMap;

/// What the value of a fault counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Seconds of rig time; it ends by itself.
    Timed,
    /// Lot parts as they leave the magazine, from 1; it strikes once.
    OfPart,
    /// Something of the whole rig, from its start.
    OfStart,
}

macro_rules! faults {
    ($($kind:ident { $($name:ident = $text:literal),* $(,)? })*) => {
        /// A fault of mechanism, board or part; `config/sim.toml` says what each does.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(missing_docs)] // explained beside the default in config/sim.toml
        pub enum Fault { $($($name,)*)* }

        impl Fault {
            /// The fault of this name.
            pub fn from_name(name: &str) -> Option<Self> {
                match name { $($($text => Some(Fault::$name),)*)* _ => None }
            }

            /// What its value counts.
            pub fn kind(self) -> Kind {
                match self { $($(Fault::$name => Kind::$kind,)*)* }
            }
        }
    };
}

faults! {
    OfPart {
        JamPusher = "jam_pusher", StuckClamp = "stuck_clamp", NoPart = "no_part",
        DoublePart = "double_part", Fall = "fall", ProbeDirty = "probe_dirty",
        BeamBlind = "beam_blind", AxisAlarm = "axis_alarm", StuckLift = "stuck_lift",
        StuckGripper = "stuck_gripper", Turned = "turned", PartMisses = "part_misses",
        PartStays = "part_stays", PartSticks = "part_sticks",
    }
    Timed {
        Door = "door", Estop = "estop", Air = "air", StopButton = "stop_button",
        StartButton = "start_button", ResetButton = "reset_button",
        BinFull = "bin_full", Starved = "starved", SensorStuck = "sensor_stuck",
        SensorLost = "sensor_lost", SensorBounce = "sensor_bounce",
    }
    OfStart {
        Drift = "drift", Refeed = "refeed", PartsSeed = "parts_seed",
        NoiseSeed = "noise_seed", ProbeFilm = "probe_film",
        GoldenEvery = "golden_every",
    }
}

/// The faults that strike the machine and its parts, with their values.
#[derive(Debug, Clone, Default)]
pub struct WorldFaults(Vec<(Fault, f64)>);

impl WorldFaults {
    /// Resolves names; a value that is NaN takes the default of the table.
    ///
    /// # Errors
    /// There is no fault of that name.
    pub fn resolve(
        asked: &[(String, f64)],
        table: &BTreeMap<String, FaultSpec>,
        path: &Path,
    ) -> Result<Self, ConfigError> {
        let resolve =
            |(name, value): &(String, f64)| match (Fault::from_name(name), table.get(name)) {
                (Some(fault), Some(spec)) => {
                    Ok((fault, if value.is_nan() { spec.default } else { *value }))
                }
                (_, _) => Err(ConfigError::Value {
                    path: path.to_path_buf(),
                    key: format!("fault.{name}"),
                    message: format!("no such fault, expected one of {}", names(table)),
                }),
            };
        asked
            .iter()
            .map(resolve)
            .collect::<Result<_, _>>()
            .map(Self)
    }

    /// Faults that have a time, each with its second.
    pub fn timed(&self) -> impl Iterator<Item = (Fault, f64)> + '_ {
        let asked = self.0.iter().copied();
        asked.filter(|(fault, _)| fault.kind() == Kind::Timed)
    }

    /// One more that is to strike at a part.
    pub fn ask(&mut self, fault: Fault, part: f64) {
        self.0.push((fault, part));
    }

    /// Values asked for under one name.
    pub fn values(&self, fault: Fault) -> impl Iterator<Item = f64> + '_ {
        self.0
            .iter()
            .filter(move |(f, _)| *f == fault)
            .map(|(_, v)| *v)
    }

    /// Seed of the day, where it is not that of the rig.
    pub fn noise_seed(&self) -> Option<u64> {
        self.values(Fault::NoiseSeed).next().map(|it| it as u64)
    }

    /// Whatever still waits for its part is called off.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Takes away a fault that strikes once at a part (counted from 1); true if it was asked for.
    pub fn strikes(&mut self, fault: Fault, part: Option<u64>) -> bool {
        let hit = |(f, v): &(Fault, f64)| *f == fault && part == Some(*v as u64);
        let place = self.0.iter().position(hit);
        place.map(|i| self.0.remove(i)).is_some()
    }
}

fn names(table: &BTreeMap<String, FaultSpec>) -> String {
    table
        .keys()
        .map(String::as_str)
        .collect::<Vec<_>>()
        .join(", ")
}
