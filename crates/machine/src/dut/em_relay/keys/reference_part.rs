//! Keys of a relay with a certificate in `config/golden.toml`.

use crate::dut::keys::table;
use crate::form::{Form, Key, above_zero, key};

const VOLTAGE: &[Key] = table! {
    key("value", above_zero(1000.0, "V"), "gauge", "certified value");
    key("u", above_zero(4.0, "V"), "gauge", "standard uncertainty of the certificate");
};

const COIL: &[Key] = table! {
    key("value", above_zero(100_000.0, "ohm"), "gauge", "certified value");
    key("u", above_zero(100.0, "ohm"), "gauge", "standard uncertainty of the certificate");
};

/// Keys of an entry of `[[golden]]`.
pub const PART: &[Key] = table! {
    key("serial", Form::Text, "gauge, history", "serial number, used once");
    key("nominal_v", above_zero(1000.0, "V"), "gauge", "nominal coil voltage; serves recipes of the same voltage");
    key("operate_voltage_v", Form::Table(VOLTAGE), "gauge", "operate threshold");
    key("release_voltage_v", Form::Table(VOLTAGE), "gauge", "release threshold");
    key("coil_resistance_ohm", Form::Table(COIL), "gauge", "coil resistance");
};
