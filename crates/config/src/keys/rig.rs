//! Keys of `rig.toml`.

mod measuring;
mod modules;
mod points;

use machine::dut::FIXTURES;
use machine::dut::em_relay::keys::board::REFERENCE;
use machine::form::{Form, Key, Points, key, optional};
use machine::rig::point::{DigitalIn, DigitalOut, Fixture};
use machine::rig::rack::THERMOMETER;
use machine::rig::stroke::ActuatorKey;
use measuring::{ACCURACY, ACCURACY_WITH_RACK, CALIBRATION};
use modules::{BUS, HISTORY, INSTRUMENT, LINE, MODULE, RECIPES, SAFETY, SERIAL_READER};
use points::{
    ACTUATOR, ANALOG_IN, ANALOG_OUT, BIN, CHANNEL, DIGITAL_IN, LEVEL, RACK, SOCKET, STATION,
    SUPPLY_RANGE,
};

/// Returns the form of points that only some kinds of device use: none is required, and `may` returns the allowed
/// names.
const fn of_kinds(may: fn() -> Vec<&'static str>, entry: &'static Form) -> Form {
    Form::Points(Points {
        must: &[],
        may,
        free: false,
        entry,
    })
}

/// Returns the names of points that the kinds of device declare, each once.
fn declared(names: impl Fn(&Fixture) -> Vec<&'static str>) -> Vec<&'static str> {
    let mut all: Vec<&str> = Vec::new();
    for name in FIXTURES.iter().flat_map(names) {
        if !all.contains(&name) {
            all.push(name);
        }
    }
    all
}

fn digital_in() -> Vec<&'static str> {
    declared(|kind| kind.digital_in.to_vec())
}

fn digital_out() -> Vec<&'static str> {
    declared(|kind| kind.digital_out.iter().map(|it| it.name).collect())
}

fn analog_in() -> Vec<&'static str> {
    declared(|kind| kind.analog_in.iter().map(|it| it.name).collect())
}

fn analog_out() -> Vec<&'static str> {
    declared(|kind| kind.analog_out.to_vec())
}

fn temperature() -> Vec<&'static str> {
    declared(|kind| kind.temperature.to_vec())
}

fn counter() -> Vec<&'static str> {
    declared(|kind| kind.counter.to_vec())
}

const LINES: Key = key(
    "line",
    Form::Named(&Form::Table(LINE)),
    "bus",
    "RS-485 lines by name",
);
const BUSES: Key = key(
    "bus",
    Form::Table(BUS),
    "bus, cycle",
    "times and counts of every line",
);
const SAFETIES: Key = key(
    "safety",
    Form::Table(SAFETY),
    "rig",
    "what the plant demands of the emergency stop",
);
const HISTORIES: Key = optional(
    "history",
    Form::Table(HISTORY),
    "app",
    "reaction to a history that cannot be written; how long traces of alarms stay",
);
const APPROVAL: Key = optional(
    "recipes",
    Form::Table(RECIPES),
    "app, page",
    "what the plant demands of a recipe before a lot may use it",
);
const MODULES: Key = key(
    "module",
    Form::Named(&Form::Table(MODULE)),
    "rig",
    "modules by name",
);
const INSTRUMENTS: Key = optional(
    "instrument",
    Form::Named(&Form::Table(INSTRUMENT)),
    "rig",
    "SCPI instruments by name",
);
const ANALOG_INPUTS: Key = optional(
    "analog_in",
    of_kinds(analog_in, &Form::Table(ANALOG_IN)),
    "rig",
    "analog inputs by point",
);

/// All keys of `rig.toml` of a rig with a feeder.
pub const FILE: &[Key] = keys! {
    LINES;
    BUSES;
    SAFETIES;
    HISTORIES;
    APPROVAL;
    optional("serial_reader", Form::Table(SERIAL_READER), "bus, station",
        "code reader at the pocket, on a line of its own; sends a line of text per part by itself");
    MODULES;
    INSTRUMENTS;
    ANALOG_INPUTS;
    optional("temperature", of_kinds(temperature, &Form::Table(CHANNEL)), "rig", "thermometers by point");
    optional("analog_out", of_kinds(analog_out, &Form::Table(ANALOG_OUT)), "rig", "analog outputs by point");
    optional("supply_range", Form::Named(&Form::Table(SUPPLY_RANGE)), "rig",
        "ranges of the supply by name; a rig without them has one, of factor 1");
    optional("counter", of_kinds(counter, &Form::Table(CHANNEL)), "rig", "gated counters by point");
    key("digital_in", Form::Points(Points { must: DigitalIn::NAMES_OF_FEEDER, may: digital_in, free: true, entry: &Form::Table(DIGITAL_IN) }), "rig",
        "digital inputs by point");
    key("digital_out", Form::Points(Points { must: DigitalOut::NAMES_OF_FEEDER, may: digital_out, free: false, entry: &Form::Table(CHANNEL) }), "rig",
        "digital outputs by point");
    key("actuator", Form::Each(ActuatorKey::NAMES, &Form::Table(ACTUATOR)), "station", "supervision of strokes");
    key("axis", Form::Each(&["nest", "park"], &Form::Table(STATION)), "rig", "places of the sort axis that are not bins");
    key("bin", Form::NamedWith(&["pass", "retest"], &Form::Table(BIN)), "rig, station", "bins by name");
    optional("reference", Form::Table(REFERENCE), "gauge",
        "references on the interface board, for recipes that need them; tolerances are half widths");
    key("accuracy", Form::Table(ACCURACY), "gauge", "promised before calibration; half widths unless said otherwise");
    key("calibration", Form::Table(CALIBRATION), "gauge", "how long a calibration holds");
};

/// All keys of `rig.toml` of a rig with a rack.
pub const WITH_RACK: &[Key] = keys! {
    LINES;
    BUSES;
    SAFETIES;
    HISTORIES;
    APPROVAL;
    MODULES;
    INSTRUMENTS;
    ANALOG_INPUTS;
    key("temperature", Form::Points(Points { must: &[THERMOMETER], may: temperature, free: false, entry: &Form::Table(CHANNEL) }), "rig",
        "thermometers by point");
    optional("analog_out", of_kinds(analog_out, &Form::Table(LEVEL)), "rig", "analog outputs by point");
    key("digital_in", Form::Points(Points { must: DigitalIn::NAMES_OF_RACK, may: digital_in, free: false, entry: &Form::Table(DIGITAL_IN) }), "rig",
        "digital inputs by point");
    key("digital_out", Form::Points(Points { must: DigitalOut::NAMES_OF_RACK, may: digital_out, free: false, entry: &Form::Table(CHANNEL) }), "rig",
        "digital outputs by point");
    key("rack", Form::Table(RACK), "rig, station", "rack that a person loads; makes this a rig without feeder");
    key("socket", Form::Named(&Form::Table(SOCKET)), "rig, station", "sockets by their number, 1 to 999");
    key("accuracy", Form::Table(ACCURACY_WITH_RACK), "gauge", "promised before calibration; half widths unless said otherwise");
    key("calibration", Form::Table(CALIBRATION), "gauge", "how long a calibration holds");
};
