//! Keys about measuring: promised accuracies, calibration.

use machine::dut::em_relay::keys::board::{GATE_DELAY, OPERATION_SCATTER};
use machine::form::{Form, Key, above_zero, from_to, key, optional};

const INPUT_GAIN: Key = key(
    "ai_gain_pct",
    from_to(0.0, 10.0, "%"),
    "gauge",
    "gain of analog inputs, of reading",
);
const INPUT_OFFSET: Key = key(
    "ai_offset_pct_of_range",
    from_to(0.0, 10.0, "%"),
    "gauge",
    "offset of analog inputs, of range",
);
const INPUT_NOISE: Key = key(
    "ai_noise_lsb",
    from_to(0.0, 100.0, "LSB"),
    "gauge",
    "noise of analog inputs, standard deviation",
);
const THERMOMETERS: Key = key(
    "rtd_k",
    from_to(0.0, 10.0, "K"),
    "gauge",
    "thermometers, standard deviation",
);
const CONVERSIONS: Key = key(
    "conversions_per_s",
    above_zero(10_000.0, "1/s"),
    "station",
    "of an I-7017F in fast mode, all enabled channels together",
);

/// Promised accuracies of a rig with a rack, whose tests use neither ramps nor gated counters.
pub(super) const ACCURACY_WITH_RACK: &[Key] = keys! {
    INPUT_GAIN;
    INPUT_OFFSET;
    INPUT_NOISE;
    THERMOMETERS;
    CONVERSIONS;
};

pub(super) const ACCURACY: &[Key] = keys! {
    INPUT_GAIN;
    INPUT_OFFSET;
    INPUT_NOISE;
    key("ao_gain_pct", from_to(0.0, 10.0, "%"), "gauge", "gain of analog outputs");
    key("ao_offset_mv", from_to(0.0, 1000.0, "mV"), "gauge", "offset of analog outputs at the terminal");
    key("ao_slope_pct", from_to(0.0, 50.0, "%"), "gauge", "slope of ramps");
    optional("ao_refresh_ms", from_to(0.0, 100.0, "ms"), "gauge",
        "time between two steps of a ramping analog output; above 2 no coarse ramp is trusted");
    GATE_DELAY;
    THERMOMETERS;
    key("part_minus_track_k", from_to(0.0, 10.0, "K"), "gauge", "part against track, standard deviation");
    optional("part_minus_track_u_pct", above_zero(100.0, "%"), "gauge",
        "relative standard uncertainty of part_minus_track_k; default 70, wrong by a factor of two");
    OPERATION_SCATTER;
    CONVERSIONS;
};

pub(super) const CALIBRATION: &[Key] = keys! {
    key("valid_h", above_zero(8760.0, "h"), "gauge", "age at which a calibration no longer holds");
    optional("golden", Form::Text, "config", "file of the reference parts, beside rig.toml, for recipes that need them");
    optional("rack", Form::Text, "config", "file with the certificate of thermometer and sockets, beside rig.toml; without it U is at least 0.8 K");
};
