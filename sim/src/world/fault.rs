//! Faults of machine and parts, by name. The code of a fault is where the affected device is simulated, in this folder:
//! drives and air in `mechanism.rs`, handing over of parts in `mechanism/parts.rs`, sensors and buttons in
//! `mechanism/sensors.rs`, the part itself in `magazine.rs`, the board in `mod.rs`, contactors and socket in
//! `ssr_board/power.rs`.

use std::path::Path;

use super::table::FaultSpec;
use crate::config::{ConfigError, SupplyRange};
use std::collections::BTreeMap;

/// Meaning of a fault's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultKind {
    /// Start in seconds of rig time; the fault ends by itself.
    Timed,
    /// Number of a lot part in the order of leaving the magazine, from 1; the fault strikes once.
    OfPart,
    /// Parameter of the whole rig, which applies from the start.
    OfStart,
}

macro_rules! faults {
    ($($kind:ident { $($name:ident = $text:literal),* $(,)? })*) => {
        /// A fault of mechanism, board or part; `config/sim.toml` describes each.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[allow(missing_docs)] // explained beside the default in config/sim.toml
        pub enum Fault { $($($name,)*)* }

        impl Fault {
            /// Returns the fault of this name.
            pub fn from_name(name: &str) -> Option<Self> {
                match name { $($($text => Some(Fault::$name),)*)* _ => None }
            }

            /// Returns the meaning of the fault's value.
            pub fn kind(self) -> FaultKind {
                match self { $($(Fault::$name => FaultKind::$kind,)*)* }
            }
        }
    };
}

faults! {
    OfPart {
        JamPusher = "jam_pusher", StuckClamp = "stuck_clamp", NoPart = "no_part",
        DoublePart = "double_part", Fall = "fall", ProbeDirty = "probe_dirty",
        BeamBlind = "beam_blind", AxisAlarm = "axis_alarm", StuckLift = "stuck_lift",
        StuckGripper = "stuck_gripper", Misoriented = "turned", PartMisses = "part_misses",
        PartStays = "part_stays", PartSticks = "part_sticks",
        UnreadableCode = "unreadable_code", DuplicateCode = "duplicate_code",
    }
    Timed {
        Door = "door", Estop = "estop", Air = "air", StopButton = "stop_button",
        StartButton = "start_button", ResetButton = "reset_button",
        BinFull = "bin_full", Starved = "starved", SensorStuck = "sensor_stuck",
        SensorLost = "sensor_lost", SensorBounce = "sensor_bounce",
        LineWelded = "line_contactor_welded", LineBroken = "line_contactor_broken",
        LoopWelded = "loop_contactor_welded", LoopBroken = "loop_contactor_broken",
        MirrorsStuck = "mirrors_stuck", SocketShort = "socket_short",
        LineDead = "line_dead", LoopDead = "loop_dead", LeadOpen = "output_lead_open",
    }
    OfStart {
        Drift = "drift", Refeed = "refeed", PartsSeed = "parts_seed",
        NoiseSeed = "noise_seed", ProbeFilm = "probe_film",
        ReferenceEvery = "golden_every", SupplyRangeStuck = "supply_range_stuck",
    }
}

/// Active faults of mechanism, board and parts, with their values.
#[derive(Debug, Clone, Default)]
pub struct WorldFaults(Vec<(Fault, f64)>);

impl WorldFaults {
    /// Resolves the names of faults; the value NaN selects the default of the table.
    ///
    /// # Errors
    /// Fails when no fault has that name.
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
                (_, _) => Err(ConfigError::Fault {
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

    /// Returns the timed faults with their start in seconds.
    pub fn timed(&self) -> impl Iterator<Item = (Fault, f64)> + '_ {
        let asked = self.0.iter().copied();
        asked.filter(|(fault, _)| fault.kind() == FaultKind::Timed)
    }

    /// Adds a fault that strikes at the part with this number in the lot.
    pub fn add(&mut self, fault: Fault, part: f64) {
        self.0.push((fault, part));
    }

    /// Returns the values of all active faults of this kind.
    pub fn values(&self, fault: Fault) -> impl Iterator<Item = f64> + '_ {
        self.0
            .iter()
            .filter(move |(f, _)| *f == fault)
            .map(|(_, v)| *v)
    }

    /// Returns the seed of noise and temperatures, if it differs from the seed of the rig.
    pub fn noise_seed(&self) -> Option<u64> {
        self.values(Fault::NoiseSeed).next().map(|it| it as u64)
    }

    /// Returns the range in which the relays of the coil supply stick, if that fault is active.
    ///
    /// # Errors
    /// Fails when no range has that code.
    pub fn stuck_range(
        &self,
        ranges: &[SupplyRange],
        path: &Path,
    ) -> Result<Option<SupplyRange>, ConfigError> {
        let Some(code) = self.values(Fault::SupplyRangeStuck).next() else {
            return Ok(None);
        };
        let range = ranges.iter().find(|range| f64::from(range.code) == code);
        let codes: Vec<String> = ranges.iter().map(|it| it.code.to_string()).collect();
        range.copied().map(Some).ok_or_else(|| ConfigError::Fault {
            path: path.to_path_buf(),
            key: "fault.supply_range_stuck".into(),
            message: match ranges.is_empty() {
                true => "the rig has no [supply_range]".into(),
                false => format!(
                    "found {code}, expected the code of a range: {}",
                    codes.join(", ")
                ),
            },
        })
    }

    /// Removes the faults that wait for their part or time. Parameters of the whole rig, such as `refeed`, stay.
    pub fn clear(&mut self) {
        self.0
            .retain(|(fault, _)| fault.kind() == FaultKind::OfStart);
    }

    /// Removes the fault if it strikes at this part (number from 1); returns true when it strikes.
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
