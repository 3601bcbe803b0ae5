//! Keys of points, actuators, the axis and the bins.

use machine::form::{Form, Key, above_zero, from_to, key, whole};

pub(super) const ANALOG_IN: &[Key] = keys! {
    key("module", Form::Text, "rig", "name of the module");
    key("channel", whole(0, 15, ""), "rig", "channel, from 0");
    key("unit", Form::Choice(&["V", "A"]), "rig", "unit of the quantity");
    key("gain", above_zero(100_000.0, "V"), "rig", "volts at the terminal per unit of the quantity");
};

pub(super) const CHANNEL: &[Key] = keys! {
    key("module", Form::Text, "rig", "name of the module");
    key("channel", whole(0, 15, ""), "rig", "channel, from 0");
};

pub(super) const ANALOG_OUT: &[Key] = keys! {
    key("module", Form::Text, "rig", "name of the module");
    key("gain", above_zero(100.0, ""), "rig", "volts of the coil supply per volt at the terminal");
};

pub(super) const SUPPLY_RANGE: &[Key] = keys! {
    key("code", whole(0, 3, ""), "rig", "bits of supply_range_1 and supply_range_0, read back alike");
    key("factor", above_zero(100.0, ""), "rig",
        "multiplies the gains of [analog_out] and divides those of the inputs behind the amplifier");
    key("max_v", above_zero(1000.0, "V"), "rig", "highest voltage of the supply");
    key("max_ma", above_zero(10_000.0, "mA"), "rig", "largest current of the supply");
};

pub(super) const DIGITAL_IN: &[Key] = keys! {
    key("module", Form::Text, "rig", "name of the module");
    key("channel", whole(0, 15, ""), "rig", "channel, from 0");
    key("active", Form::Choice(&["low", "high"]), "rig", "low: the bit reads 0 while the signal is present");
};

pub(super) const ACTUATOR: &[Key] = keys! {
    key("timeout_ms", above_zero(60_000.0, "ms"), "station", "longest stroke; a longer one raises an alarm");
};

pub(super) const STATION: &[Key] = keys! {
    key("point", whole(0, 7, ""), "rig", "number in the point table of the slide");
    key("x_mm", from_to(-1000.0, 1000.0, "mm"), "rig, guard", "position relative to the nest");
};

pub(super) const BIN: &[Key] = keys! {
    key("point", whole(0, 7, ""), "rig", "number in the point table of the slide");
    key("x_mm", from_to(-1000.0, 1000.0, "mm"), "rig, guard", "position relative to the nest");
    key("beam", Form::Text, "station", "digital input in the chute, read by its event counter");
};
