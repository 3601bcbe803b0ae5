//! Tables of the world file: true values of temperature relays, chamber, sensors, and the person who loads the rack.

use std::collections::BTreeMap;

use crate::config::ConfigError;
use crate::table::{Entry, Read, Table};
use crate::world::oven::{ChamberValues, SensorValues, Spread};
use crate::world::table::table;

table!(
    /// All tables of a rig for temperature relays.
    ThermostatTable {
        part: String, family: BTreeMap<String, PartTable>, defects: DefectTable,
        rack: RackTable, sensors: SensorsTable, safety: SafetyTable, loading: LoadingTable,
        contact_current_ma: f64, compliance_v: f64, emf_uv_sd: f64, input_limit_v: f64,
    }
);
table!(
    /// Values of good parts.
    PartTable {
        operate_c: f64, operate_sd_k: f64, differential_k: f64, differential_sd_k: f64,
        scatter_k: f64, lag_s: [f64; 2], lag_sd_pct: f64, drift_sd_k: f64,
        contact_mohm: f64, contact_ln_sd: f64, closure_ln_sd: f64, bounce_ms: [f64; 2],
    }
);
table!(
    /// Values of defective parts.
    DefectTable {
        rate_pct: f64, outside_k: [f64; 2], wrong_type_k: f64, creep_k: [f64; 2],
        chatter_k: [f64; 2], chatter_hz: [f64; 2], intermittent_pct: [f64; 2],
        intermittent_ms: [f64; 2], high_ohm: [f64; 2], scatter_k: f64, slow_factor: f64,
    }
);
table!(
    /// The rack: by how much the temperature at a socket differs from that of the air.
    RackTable {
        offset_sd_k: f64, certificate_sd_k: f64, delay_mean_s: f64, delay_sd_s: f64,
    }
);
table!(
    /// Errors of the temperature sensors with their modules.
    SensorsTable {
        bias_sd_k: f64, noise_k: f64, thermocouple_bias_sd_k: f64, thermocouple_noise_k: f64,
        thermocouple_lag_s: f64, times_sd_pct: f64, drift_k_per_h: f64,
    }
);
table!(
    /// The hard-wired safety chain of the heater, and the effects of faults.
    SafetyTable {
        limiter_c: f64, airflow_from: f64, airflow_s: f64, slow_fan: f64, half_power: f64,
        mains_low_pct: f64, door_open_s: f64, emergency_stop_s: f64,
    }
);
table!(
    /// The person who loads and unloads.
    LoadingTable { loading_min: f64, reaction_s: f64 }
);

/// A chamber: its design, deviations from the design, and its spread.
#[derive(Debug, Clone)]
#[allow(missing_docs)] // each key is explained beside its value in sim.toml
pub struct ChamberTable {
    pub values: ChamberValues,
    pub sensor: SensorValues,
    pub spread: Spread,
    pub ambient_c: [f64; 2],
}

impl Read for ChamberTable {
    const FORM: &'static str = "a table";

    /// Reads the design, and the keys that replace its values.
    fn read(entry: &Entry) -> Result<Self, ConfigError> {
        let keys = entry.table()?;
        let (values, sensor) = match keys.get::<String>("design")?.as_str() {
            "air" => (ChamberValues::AIR, SensorValues::AIR),
            "oil" => (ChamberValues::OIL, SensorValues::OIL),
            "block" => (ChamberValues::BLOCK, SensorValues::BLOCK),
            _ => return Err(keys.wrong("design", "air, oil or block")),
        };
        let table = Self {
            values: replaced(values, keys)?.scaled(keys.get_or("size", 1.0)?),
            sensor: SensorValues {
                delay_s: keys.get_or("delay_s", sensor.delay_s)?,
                lag_s: keys.get_or("lag_s", sensor.lag_s)?,
                ..sensor
            },
            spread: Spread {
                capacity_pct: keys.get("capacity_sd_pct")?,
                conductance_pct: keys.get("conductance_sd_pct")?,
                power_pct: keys.get("power_sd_pct")?,
            },
            ambient_c: [keys.get("ambient_low_c")?, keys.get("ambient_high_c")?],
        };
        keys.finish()?;
        Ok(table)
    }
}

/// Replaces those values of a design that the table gives.
fn replaced(design: ChamberValues, keys: &Table) -> Result<ChamberValues, ConfigError> {
    let or = |key, own: f64| keys.get_or(key, own);
    Ok(ChamberValues {
        capacity_j_per_k: keys.get_or("capacity_j_per_k", design.capacity_j_per_k)?,
        heater_air_w_per_k: or("heater_air_w_per_k", design.heater_air_w_per_k)?,
        air_wall_w_per_k: or("air_wall_w_per_k", design.air_wall_w_per_k)?,
        air_rack_w_per_k: or("air_rack_w_per_k", design.air_rack_w_per_k)?,
        wall_insulation_w_per_k: or("wall_insulation_w_per_k", design.wall_insulation_w_per_k)?,
        insulation_ambient_w_per_k: or(
            "insulation_ambient_w_per_k",
            design.insulation_ambient_w_per_k,
        )?,
        leak_w_per_k: or("leak_w_per_k", design.leak_w_per_k)?,
        vent_w_per_k: or("vent_w_per_k", design.vent_w_per_k)?,
        door_w_per_k: or("door_w_per_k", design.door_w_per_k)?,
        heater_w: or("heater_w", design.heater_w)?,
        fan_w: or("fan_w", design.fan_w)?,
        ambient_c: design.ambient_c,
    })
}
