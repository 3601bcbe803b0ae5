//! Tables of the world file that describe relays: lot, relay, defects.
//!
//! `config/sim.toml` describes each key beside its value.

use super::lumped::Parameters;
use crate::world::table::table;

table!(
    /// Scatter of the parts of a lot.
    LotTable {
        nominal_v: f64, nominal_coil_ohm: f64,
        operate_v_mean: f64, operate_v_sd: f64, release_v_mean: f64, release_v_sd: f64,
        coil_ohm_mean: f64, coil_ohm_sd: f64,
        operate_ms_mean: f64, operate_ms_sd: f64, operate_ms_follows_v: f64,
        release_ms_mean: f64, release_ms_sd: f64,
        contact_no_mohm_median: f64, contact_nc_mohm_median: f64,
        contact_ln_sd: f64, closure_ln_sd: f64,
        bounce_no_ms_mean: f64, bounce_no_ms_sd: f64,
        bounce_nc_ms_mean: f64, bounce_nc_ms_sd: f64, bounce_ln_sd: f64,
        threshold_scatter_sd_mv: f64, thermal_emf_sd_uv: f64,
    }
);
table!(
    /// Default relay that the fit adjusts, its heat capacities, its bounce lists.
    RelayTable {
        lumped: Parameters,
        copper_zero_c: f64, coil_heat_j_per_k: f64, body_heat_j_per_k: f64,
        coil_to_body_k_per_w: f64, body_to_air_k_per_w: f64,
        bounce_no_us: Vec<f64>, bounce_nc_us: Vec<f64>,
    }
);
table!(
    /// Defects: rate and ranges.
    DefectTable {
        rate_pct: f64,
        shorted_turns_coil_factor: [f64; 2], wrong_coil_factor: [f64; 2],
        weak_spring_release_v: [f64; 2], weak_spring_operate_v: [f64; 2],
        stiff_spring_operate_v: [f64; 2], stiff_spring_release_v: [f64; 2],
        slow_operate_ms: [f64; 2], slow_release_ms: [f64; 2], bouncing_ms: [f64; 2],
        high_contact_mohm: [f64; 2], far_too_high_ohm: [f64; 2], unstable_contact_mohm: [f64; 2],
    }
);
