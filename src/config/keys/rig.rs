//! Keys of `rig.toml`.

mod measuring;
mod modules;
mod points;

use crate::form::{Form, Key, key};
use crate::rig::point::{AnalogIn, AnalogOut, Counter, DigitalIn, DigitalOut, Temperature};
use measuring::{ACCURACY, CALIBRATION, REFERENCE};
use modules::{BUS, LINE, MODULE, SAFETY};
use points::{ACTUATOR, ACTUATORS, ANALOG_IN, ANALOG_OUT, BIN, CHANNEL, DIGITAL_IN, STATION};

/// The whole file.
pub const FILE: &[Key] = &[
    key(
        "line",
        Form::Named(&Form::Table(LINE)),
        "bus",
        "RS-485 lines by name",
    ),
    key(
        "bus",
        Form::Table(BUS),
        "bus, cycle",
        "times and counts of every line",
    ),
    key(
        "safety",
        Form::Table(SAFETY),
        "rig",
        "what the plant demands of the emergency stop",
    ),
    key(
        "module",
        Form::Named(&Form::Table(MODULE)),
        "rig",
        "modules by name",
    ),
    key(
        "analog_in",
        Form::Each(AnalogIn::NAMES, &Form::Table(ANALOG_IN)),
        "rig",
        "analog inputs by point",
    ),
    key(
        "temperature",
        Form::Each(Temperature::NAMES, &Form::Table(CHANNEL)),
        "rig",
        "thermometers by point",
    ),
    key(
        "analog_out",
        Form::Each(AnalogOut::NAMES, &Form::Table(ANALOG_OUT)),
        "rig",
        "analog outputs by point",
    ),
    key(
        "counter",
        Form::Each(Counter::NAMES, &Form::Table(CHANNEL)),
        "rig",
        "gated counters by point",
    ),
    key(
        "digital_in",
        Form::Each(DigitalIn::NAMES, &Form::Table(DIGITAL_IN)),
        "rig",
        "digital inputs by point",
    ),
    key(
        "digital_out",
        Form::Each(DigitalOut::NAMES, &Form::Table(CHANNEL)),
        "rig",
        "digital outputs by point",
    ),
    key(
        "actuator",
        Form::Each(ACTUATORS, &Form::Table(ACTUATOR)),
        "station",
        "supervision of strokes",
    ),
    key(
        "axis",
        Form::Each(&["nest", "park"], &Form::Table(STATION)),
        "rig",
        "places of the sort axis that are not bins",
    ),
    key(
        "bin",
        Form::NamedWith(&["pass", "retest"], &Form::Table(BIN)),
        "rig, station",
        "bins by name",
    ),
    key(
        "reference",
        Form::Table(REFERENCE),
        "gauge",
        "references on the interface board; tolerances are half widths",
    ),
    key(
        "accuracy",
        Form::Table(ACCURACY),
        "gauge",
        "promised before calibration; half widths unless said otherwise",
    ),
    key(
        "calibration",
        Form::Table(CALIBRATION),
        "gauge",
        "how long a calibration holds",
    ),
];
