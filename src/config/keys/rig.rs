//! Keys of `rig.toml`.

mod measuring;
mod modules;
mod points;

use crate::dut::em_relay::points as em_relay;
use crate::form::{Form, Key, Points, key, optional};
use crate::rig::axis::Bin;
use crate::rig::point::{DigitalIn, DigitalOut};
use measuring::{ACCURACY, CALIBRATION, REFERENCE};
use modules::{BUS, LINE, MODULE, SAFETY};
use points::{ACTUATOR, ACTUATORS, ANALOG_IN, ANALOG_OUT, BIN, CHANNEL, DIGITAL_IN, STATION};

/// Points that only kinds of device declare.
const fn of_kinds(may: &'static [&'static [&'static str]], entry: &'static Form) -> Form {
    Form::Points(Points {
        must: &[],
        may,
        free: false,
        entry,
    })
}

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
    optional(
        "analog_in",
        of_kinds(&[&em_relay::QUANTITY_NAMES], &Form::Table(ANALOG_IN)),
        "rig",
        "analog inputs by point",
    ),
    optional(
        "temperature",
        of_kinds(&[em_relay::FIXTURE.temperature], &Form::Table(CHANNEL)),
        "rig",
        "thermometers by point",
    ),
    optional(
        "analog_out",
        of_kinds(&[em_relay::FIXTURE.analog_out], &Form::Table(ANALOG_OUT)),
        "rig",
        "analog outputs by point",
    ),
    optional(
        "counter",
        of_kinds(&[em_relay::FIXTURE.counter], &Form::Table(CHANNEL)),
        "rig",
        "gated counters by point",
    ),
    key(
        "digital_in",
        Form::Points(Points {
            must: DigitalIn::NAMES,
            may: &[em_relay::DigitalIn::NAMES],
            free: true,
            entry: &Form::Table(DIGITAL_IN),
        }),
        "rig",
        "digital inputs by point",
    ),
    key(
        "digital_out",
        Form::Points(Points {
            must: DigitalOut::NAMES,
            may: &[em_relay::DigitalOut::NAMES],
            free: false,
            entry: &Form::Table(CHANNEL),
        }),
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
        Form::Each(Bin::NAMES, &Form::Table(BIN)),
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
