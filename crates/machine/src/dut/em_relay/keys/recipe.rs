//! Keys of a relay in `config/recipes/NAME.toml`.

use crate::dut::em_relay::Strategy;
use crate::dut::em_relay::recipe::CoilChannels;
use crate::dut::em_relay::sampling::Polarities;
use crate::dut::keys::{BODY, PIN_LENGTH, REFERENCE_TEMPERATURE, Sections, limit, table};
use crate::form::{Form, Key, above_zero, key, optional, whole};

/// Keys of `[part]`, `[limits]`, `[test]`.
pub const SECTIONS: Sections = Sections {
    part: PART,
    limits: LIMITS,
    external: &[],
    test: TEST,
};

const PART: &[Key] = table! {
    key("nominal_v", above_zero(1000.0, "V"), "gauge, station", "nominal coil voltage");
    key("nominal_coil_ohm", above_zero(100_000.0, "ohm"), "gauge", "nominal coil resistance at the reference temperature");
    BODY;
    PIN_LENGTH;
    REFERENCE_TEMPERATURE;
};

const LIMIT_OHM: Form = limit!("ohm", 100_000.0);
const LIMIT_V: Form = limit!("V", 1000.0);
const LIMIT_MS: Form = limit!("ms", 1000.0);
const LIMIT_MOHM: Form = limit!("mOhm", 100_000.0);

const LIMITS: &[Key] = table! {
    key("coil_resistance_ohm", LIMIT_OHM, "gauge", "coil resistance");
    key("operate_voltage_v", LIMIT_V, "gauge", "operate threshold");
    key("release_voltage_v", LIMIT_V, "gauge", "release threshold");
    key("operate_time_ms", LIMIT_MS, "gauge", "operate time without bounce");
    key("release_time_ms", LIMIT_MS, "gauge", "release time without bounce");
    key("operate_bounce_ms", LIMIT_MS, "gauge", "open time of NO after its first make");
    key("release_bounce_ms", LIMIT_MS, "gauge", "open time of NC after its first make");
    key("contact_resistance_no_mohm", LIMIT_MOHM, "gauge", "resistance of NO");
    key("contact_resistance_nc_mohm", LIMIT_MOHM, "gauge", "resistance of NC");
};

const COIL: &[Key] = table! {
    optional("settles_ms", whole(1, 1000, "ms"), "station", "from the drive to the first conversion that counts; default 32");
    optional("scans", whole(1, 100, ""), "station", "scans that are averaged; default 1");
};

const CONTACT: &[Key] = table! {
    optional("polarities", Form::Choice(&Polarities::NAMES), "station", "directions of the source on the closures; default alternating, which needs the coarse ramps of both thresholds, else plus_minus");
    optional("closures", whole(1, 20, ""), "station", "timed closures of either contact, at the most; default 1");
    optional("stops_early", Form::Flag, "station", "no further closure once both contacts are 3 standard deviations clear of their limits");
    optional("closure_scatter_pct", whole(0, 100, "%"), "station", "least scatter of a film from closure to closure (1 sd); default 10");
};

const STRATEGY: &[Key] = table! {
    optional("operate_voltage_v", Form::Choice(&Strategy::NAMES), "station", "how the operate threshold is found");
    optional("release_voltage_v", Form::Choice(&Strategy::NAMES), "station", "how the release threshold is found");
    optional("coil", Form::Table(COIL), "station", "how the coil resistance is read");
    optional("contact", Form::Table(CONTACT), "station", "how the contacts are read");
};

const TEST: &[Key] = table! {
    key("conditioning_operations", whole(0, 1000, ""), "station", "operations before the first measurement");
    key("prebias_v", above_zero(1000.0, "V"), "station", "coil resistance is measured and the operate ramp starts here");
    key("coarse_span_v", above_zero(1000.0, "V"), "station", "height of the coarse ramp");
    key("coil_channels", Form::Choice(&CoilChannels::NAMES), "station, gauge", "channels that measure the coil");
    key("expected_operate_v", above_zero(1000.0, "V"), "station", "operate threshold expected of the lot");
    key("expected_operate_sd_v", above_zero(20.0, "V"), "station", "its standard deviation");
    key("expected_release_v", above_zero(1000.0, "V"), "station", "release threshold expected of the lot");
    key("expected_release_sd_v", above_zero(20.0, "V"), "station", "its standard deviation");
    key("clamp", Form::Choice(&["zener", "diode"]), "station", "coil suppression during the timed release");
    optional("strategy", Form::Table(STRATEGY), "station", "per threshold; coarse_fine where none is named");
};
