//! Accuracies that the makers of the instruments specify, from `config/rig.toml`, and the range of their inputs.

use serde::Deserialize;

/// Full scale of a +-10 V input, V at the terminal.
pub const FULL_SCALE_V: f64 = 10.0;
/// Resolution of a +-10 V input of 12 bits, volts per step.
pub const LSB_V: f64 = 2.0 * FULL_SCALE_V / 4096.0;
/// Highest voltage at a terminal that a test or a calibration may plan to read. The last 2 % of the full scale are in
/// reserve for the errors of sources, references and input.
pub const READABLE_V: f64 = 0.98 * FULL_SCALE_V;

/// Accuracies before calibration: half widths, except for fields documented as standard deviations. Fields that
/// `rig.toml` of a rig with a rack omits are zero, because no source ramps and no counter gates there.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct AccuracySettings {
    /// Gain error of analog inputs, % of reading.
    pub ai_gain_pct: f64,
    /// Offset error of analog inputs, % of range.
    pub ai_offset_pct_of_range: f64,
    /// Noise of analog inputs, LSB (standard deviation).
    pub ai_noise_lsb: f64,
    /// Gain error of analog outputs, %.
    #[serde(default)]
    pub ao_gain_pct: f64,
    /// Offset error of analog outputs, mV at the terminal.
    #[serde(default)]
    pub ao_offset_mv: f64,
    /// Error of the slope of an analog output while it ramps, %.
    #[serde(default)]
    pub ao_slope_pct: f64,
    /// Time between two steps of an analog output while it ramps, ms.
    #[serde(default = "AccuracySettings::usual_refresh_ms")]
    pub ao_refresh_ms: f64,
    /// Delay of the counter gates, microseconds.
    #[serde(default)]
    pub gate_delay_us: f64,
    /// Error of the thermometers, K (standard deviation).
    pub rtd_k: f64,
    /// Difference between the temperatures of part and magazine track, K (standard deviation).
    #[serde(default)]
    pub part_minus_track_k: f64,
    /// Relative standard uncertainty of `part_minus_track_k` itself, %.
    #[serde(default = "AccuracySettings::usual_part_minus_track_u_pct")]
    pub part_minus_track_u_pct: f64,
    /// Scatter of a threshold from operation to operation, for a 12 V coil, mV (standard deviation).
    #[serde(default)]
    pub operation_scatter_mv: f64,
    /// Conversions of an I-7017F in fast mode, all enabled channels together, per second.
    pub conversions_per_s: f64,
}

impl AccuracySettings {
    /// Returns the refresh interval assumed for an I-7021P where `rig.toml` states none.
    fn usual_refresh_ms() -> f64 {
        1.0
    }

    /// Returns the relative uncertainty of a standard deviation that may be wrong by a factor of two: ln 2.
    fn usual_part_minus_track_u_pct() -> f64 {
        70.0
    }
}
