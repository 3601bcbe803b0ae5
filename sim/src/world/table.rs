//! The world file: all numbers of the simulated rig and its parts.
//!
//! `config/sim.toml` describes each key beside its value. Unknown keys are errors; a file for `--world` may omit
//! keys and then takes them from `sim.toml`.

use std::collections::BTreeMap;
use std::path::Path;

use super::relay::table::{DefectTable, LotTable, RelayTable};
use super::resistor::ResistorTable;
use super::ssr::table::{SsrAcTable, SsrTable};
use super::ssr_board::{FixtureTable, MainsTable};
use super::thermostat::table::{ChamberTable, ThermostatTable};
use crate::config::{ConfigError, Files};
use crate::table::{Read, Table};

macro_rules! table {
    ($(#[$doc:meta])* $name:ident { $($field:ident : $ty:ty),* $(,)? }) => {
        $(#[$doc])*
        #[derive(Debug, Clone)]
        #[allow(missing_docs)] // each key is explained beside its value in config/sim.toml
        pub struct $name { $(pub $field: $ty),* }

        crate::table::read_fields!($name { $($field),* }, finish);
    };
}
pub(super) use table;

table!(
    /// Errors and conversion rates of modules, timing of lines.
    DeviceWorld {
        latency_ms_mean: f64, latency_ms_sd: f64,
        ai_gain_pct: f64, ai_offset_pct_of_range: f64, ai_noise_lsb: f64,
        ao_gain_pct: f64, ao_offset_mv: f64, ao_slope_pct: f64, ao_refresh_ms: f64,
        conversions_per_s: f64, conversions_per_s_normal: f64, clock_ppm: f64,
    }
);
table!(
    /// The interface board.
    BoardTable {
        gate_delay_us: f64, source_current_a: f64, source_error_pct: f64,
        source_compliance_v: f64, emf_drift_uv_per_s: f64, source_wait_ms: f64, source_lead_ms: f64,
        supply_max_v: f64, supply_limit_ma: f64, supply_range_ms: f64, supply_zero_mv: f64,
        zener_v: f64, diode_v: f64, ramp_start_mv: f64, window_after_latch_ms: f64,
        monitor_v: f64, monitor_ohm: f64, monitor_threshold_pct: f64,
        input_limit_v: f64, clamp_select_below_ma: f64,
    }
);
table!(
    /// Temperatures around the rig.
    EnvironmentTable {
        ambient_low_c: f64, ambient_high_c: f64,
        track_minus_ambient_half_k: f64, nest_minus_ambient_half_k: f64,
        part_minus_track_sd_k: f64, rtd_error_sd_k: f64,
    }
);
table!(
    /// Cylinders, slide and sensors.
    MechanismTable {
        escapement_ms: f64, pusher_ms: f64, clamp_ms: f64, probe_lift_ms: f64,
        sort_z_ms: f64, gripper_ms: f64, scatter_pct: f64, pusher_stroke_mm: f64,
        axis_mm_per_s: f64, axis_mm_per_s2: f64, axis_window_mm: f64,
        fall_ms: [f64; 2], beam_dark_ms: [f64; 2], track_level_parts: u64, fault_hold_ms: f64,
    }
);
table!(
    /// A fault that the command line may request by name.
    FaultSpec { unit: String, default: f64, help: String }
);
table!(
    /// All tables of the file; the kind of the parts decides which of them a rig needs.
    WorldTable {
        devices: DeviceWorld, fault: BTreeMap<String, FaultSpec>,
        environment: Option<EnvironmentTable>, mechanism: Option<MechanismTable>,
        board: Option<BoardTable>, lot: Option<LotTable>, relay: Option<RelayTable>,
        defects: Option<DefectTable>, resistor: Option<ResistorTable>,
        fixture: Option<FixtureTable>, mains: Option<MainsTable>, ssr: Option<SsrTable>, ssr_ac: Option<SsrAcTable>,
        chamber: Option<ChamberTable>, thermostat: Option<ThermostatTable>,
        instrument: Option<BTreeMap<String, Table>>,
    }
);

/// Tables of electromagnetic relays and their board.
#[derive(Debug, Clone)]
#[allow(missing_docs)] // the fields of WorldTable with these names
pub struct RelayWorld {
    pub environment: EnvironmentTable,
    pub board: BoardTable,
    pub lot: LotTable,
    pub relay: RelayTable,
    pub defects: DefectTable,
}

impl WorldTable {
    /// Returns the tables of electromagnetic relays.
    ///
    /// # Errors
    /// Fails when one of them is missing.
    pub fn relays(&self, files: &Files) -> Result<RelayWorld, ConfigError> {
        Ok(RelayWorld {
            environment: present(&self.environment, "environment", files)?,
            board: present(&self.board, "board", files)?,
            lot: present(&self.lot, "lot", files)?,
            relay: present(&self.relay, "relay", files)?,
            defects: present(&self.defects, "defects", files)?,
        })
    }
}

/// Returns a table that the kind of the parts needs.
///
/// # Errors
/// Fails when `sim.toml` lacks it.
pub fn present<T: Clone>(table: &Option<T>, key: &str, files: &Files) -> Result<T, ConfigError> {
    table.clone().ok_or_else(|| ConfigError::Value {
        path: files.path("sim.toml"),
        line: 1,
        key: key.into(),
        found: "nothing".into(),
        expected: "a table".into(),
    })
}

/// Reads `sim.toml`; a second world file overrides some of its keys.
///
/// # Errors
/// Fails when a file cannot be read, is not TOML, has an unknown key or a value of the wrong type, or describes
/// an impossible relay.
pub fn read_world(files: &Files, other: Option<&Path>) -> Result<WorldTable, ConfigError> {
    let mut world = files.read("sim.toml")?;
    if let Some(path) = other {
        world.overlay(Table::of_file(path)?);
    }
    WorldTable::read(&world.into_entry())
}
