//! Keys of `golden.toml`, and of `rack.toml`, the certificate of a rack of sockets.

use machine::dut::em_relay::keys::reference_part::PART;
use machine::form::{Form, Key, from_to, key};

/// All keys of `golden.toml`.
pub const FILE: &[Key] = keys! {
    key("reference_temperature_c", from_to(-40.0, 85.0, "C"), "gauge", "temperature of the certified values");
    key("golden", Form::List(&Form::Table(PART)), "gauge", "the reference parts");
};

/// All keys of `rack.toml`.
pub use machine::dut::thermostat::keys::CERTIFICATE;
