//! Keys of points, actuators, the axis and the bins.

use machine::form::{Form, Key, above_zero, from_to, key, optional, whole};

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
    optional("to_rest_needs", Form::Text, "guard", "input that must be on for a stroke to rest; not for the axis");
    optional("to_end_needs", Form::Text, "guard", "input that must be on for a stroke away from rest; not for the axis");
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

pub(super) const LEVEL: &[Key] = keys! {
    key("module", Form::Text, "rig", "name of the module");
    key("channel", whole(0, 15, ""), "rig", "channel, from 0");
};

pub(super) const RACK: &[Key] = keys! {
    key("unlock_below_c", from_to(0.0, 60.0, "C"), "station", "temperature of the rack below which the door may be unlocked");
    key("lists", Form::List(&Form::Text), "rig, station", "unloading lists in their order, pass and retest among them");
};

pub(super) const SOCKET: &[Key] = keys! {
    key("module", Form::Text, "rig", "module that reads the contact of the part");
    key("channel", whole(0, 15, ""), "rig", "channel, from 0");
    key("active", Form::Choice(&["low", "high"]), "rig", "low: the bit reads 0 while the contact is closed");
    key("select", whole(0, 255, ""), "rig", "number at the multiplexer, used once");
    key("row", whole(1, 100, ""), "page", "row on the plan of the rack");
    key("column", whole(1, 100, ""), "page", "column on that plan; a place is used once");
};
