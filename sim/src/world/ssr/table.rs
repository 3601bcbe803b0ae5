//! Distribution of the true values of a lot of solid-state relays, and of its defects.

use crate::world::table::table;

table!(
    /// Values of good DC parts at 25 degrees Celsius.
    SsrTable {
        forward_v_mean: f64, forward_v_sd: f64, input_ohm_mean: f64, input_ohm_sd: f64,
        threshold_ma_mean: f64, threshold_ma_sd: f64, hysteresis_mean: f64, hysteresis_sd: f64,
        on_tau_us_mean: f64, on_tau_us_sd: f64, off_tau_us_mean: f64, off_tau_us_sd: f64,
        on_mohm_mean: f64, on_mohm_sd: f64, junction_k_per_w_mean: f64, junction_k_per_w_sd: f64,
        leakage_na_median: f64, leakage_ln_sd: f64, insulation_mohm: f64, output_pf: f64,
        shorted_mohm: f64, defects: SsrDefectTable,
    }
);
table!(
    /// Values of DC parts with a defect, at the temperature of the part.
    SsrDefectTable {
        rate_pct: f64, wrong_input_ma: [f64; 2], shorted_led_ohm: f64, aged_v_on_v: [f64; 2],
        high_drop_mohm: [f64; 2], thermal_drift_mv: [f64; 2],
        slow_turn_on_us: [f64; 2], slow_turn_off_us: [f64; 2], leaky_ua: [f64; 2],
    }
);
table!(
    /// Values of good AC parts at 25 degrees Celsius.
    SsrAcTable {
        forward_v_mean: f64, forward_v_sd: f64, input_ohm_mean: f64, input_ohm_sd: f64,
        threshold_ma_mean: f64, threshold_ma_sd: f64, hysteresis_mean: f64, hysteresis_sd: f64,
        on_tau_us_mean: f64, on_tau_us_sd: f64, off_tau_us_mean: f64, off_tau_us_sd: f64,
        knee_v_mean: f64, knee_v_sd: f64, knee_difference_v_sd: f64,
        slope_mohm_mean: f64, slope_mohm_sd: f64, latching_ma: f64, holding_ma: f64,
        inhibit_v_mean: f64, inhibit_v_sd: f64, retrigger_v_mean: f64, retrigger_v_sd: f64,
        junction_k_per_w_mean: f64, junction_k_per_w_sd: f64, commutation_v_per_us_mean: f64,
        commutation_v_per_us_sd: f64, snubber_nf_mean: f64, snubber_nf_sd: f64, leakage_na_median: f64,
        leakage_ln_sd: f64, insulation_mohm: f64, shorted_mohm: f64, defects: SsrAcDefectTable,
    }
);
table!(
    /// Values of AC parts with a defect, at the temperature of the part.
    SsrAcDefectTable {
        rate_pct: f64, wrong_input_ma: [f64; 2], shorted_led_ohm: f64, aged_v_on_v: [f64; 2],
        high_drop_v: [f64; 2], thermal_factor: [f64; 2], slow_turn_on_us: [f64; 2],
        slow_turn_off_us: [f64; 2], leaky_ua: [f64; 2], open_snubber_pf: f64,
        open_snubber_v_per_us: [f64; 2], wrong_snubber_factor: [f64; 2],
    }
);
