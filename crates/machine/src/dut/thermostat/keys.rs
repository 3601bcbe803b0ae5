//! Keys of the recipe of a temperature relay, and of the certificate of its rack.

use crate::dut::keys::{Sections, limit, table};
use crate::form::{Form, Key, above_zero, from_to, key, optional, whole};

/// Keys of the sections `[part]`, `[limits]` and `[test]`.
pub const SECTIONS: Sections = Sections {
    part: PART,
    limits: LIMITS,
    external: &[],
    test: TEST,
};

const PART: &[Key] = table! {
    key("lag_s", above_zero(600.0, "s"), "station", "expected lag of the parts behind the air; the first batch measures it");
};

const LIMITS: &[Key] = table! {
    key("operate_temperature_c", limit!("C", 300.0), "gauge", "temperature at which the contact opens on rise");
    key("reset_temperature_c", limit!("C", 300.0), "gauge", "temperature at which it closes on fall");
    optional("differential_k", limit!("K", 200.0), "gauge", "operate less reset temperature of the same part");
    optional("contact_resistance_mohm", limit!("mOhm", 10_000.0), "gauge", "resistance of the closed contact before heating");
    optional("creep_k", limit!("K", 50.0), "gauge", "width over which the contact opens, in the last pass; 0 for a snap");
    optional("chatter_edges", limit!("", 10_000.0), "gauge", "edges of the contact in one switching beside its own; 0 for a clean snap");
    optional("repeatability_k", limit!("K", 50.0), "gauge", "widest range of the same switching temperature over the passes");
};

const POINT: &[Key] = table! {
    key("reading_c", from_to(-100.0, 600.0, "C"), "gauge", "reading of the rig");
    key("true_c", from_to(-100.0, 600.0, "C"), "gauge", "true temperature");
};

const CHAIN: &[Key] = table! {
    key("points", Form::List(&Form::Table(POINT)), "gauge", "at least three temperatures, rising");
    key("u_k", above_zero(5.0, "K"), "gauge", "standard uncertainty after the correction");
};

const MAP: &[Key] = table! {
    key("excess_k", above_zero(500.0, "K"), "gauge", "air less room at which the map was made");
    key("offset_k", Form::List(&from_to(-10.0, 10.0, "K")), "gauge", "socket less air, in the order of the numbers of the sockets");
    key("u_k", above_zero(5.0, "K"), "gauge", "standard uncertainty of an offset");
};

const FIRST_ORDER: &[Key] = table! {
    key("gain_k", above_zero(1_000.0, "K"), "station", "rise per full heater");
    key("time_constant_s", above_zero(600.0, "s"), "station", "its time constant");
    key("delay_s", from_to(0.0, 60.0, "s"), "station", "its delay");
};

const PID: &[Key] = table! {
    key("gain_per_k", above_zero(10.0, "1/K"), "station", "full heaters per kelvin of error");
    key("integral_s", above_zero(3_600.0, "s"), "station", "integral time");
    key("derivative_s", from_to(0.0, 600.0, "s"), "station", "derivative time");
};

const RESPONSE: &[Key] = table! {
    key("gain_k", above_zero(1_000.0, "K"), "station", "rise of the air per full heater that settles");
    key("time_constant_s", above_zero(600.0, "s"), "station", "its time constant");
    key("delay_s", from_to(0.0, 60.0, "s"), "station", "delay of the whole response");
    key("slope_k_per_s", above_zero(10.0, "K/s"), "station", "rise per full heater that goes on");
    key("loss_per_k", from_to(0.0, 1.0, "1/K"), "station", "full heaters that replace the losses per kelvin above the room");
    key("fan", from_to(0.0, 1.0, ""), "station", "power of the fan in full heaters");
    key("vent_per_k", from_to(0.0, 1.0, "1/K"), "station", "full heaters that the open vent removes per kelvin above the room");
    key("first_order", Form::Table(FIRST_ORDER), "station", "response of the first two minutes, for the settings of the controller");
    optional("pid", Form::Table(PID), "station", "settings of the controller, of `relayrig chamber tune`; without them they follow from first_order");
};

/// Keys of the certificate of the rack.
pub const CERTIFICATE: &[Key] = table! {
    key("issued", Form::Text, "gauge", "date of issue, such as 2026-01-15; from then on the certificate holds for calibration.valid_h");
    key("chain", Form::Table(CHAIN), "gauge", "reference thermometer, read through its module");
    key("map", Form::Table(MAP), "gauge", "sockets against the air");
    optional("chamber", Form::Table(RESPONSE), "station", "response of the chamber, of `relayrig chamber identify`; without it the first batch of a run finds it");
};

const TEST: &[Key] = table! {
    key("learning_k_per_min", from_to(0.1, 10.0, "K/min"), "station", "rate of the first pass of a batch that measures the lag");
    key("rate_k_per_min", from_to(0.1, 10.0, "K/min"), "station", "rate of the other passes");
    key("passes", whole(1, 10, ""), "station", "passes at rate_k_per_min in each batch");
    optional("scatter_passes", whole(0, 10, ""), "station", "passes at learning_k_per_min before these in each batch, so that a part that scatters shows it; default 0");
    key("learning_every", whole(1, 100, ""), "station", "batches from one that measures the lag to the next; the first one does");
    key("beyond_k", from_to(1.0, 50.0, "K"), "station", "by how much a pass goes beyond the limits to find parts outside");
    optional("claimed_u_k", from_to(0.05, 10.0, "K"), "gauge", "expanded uncertainty (k = 2) that results of the recipe must keep; refused when the rig cannot");
    optional("most_k_per_min", from_to(0.1, 10.0, "K/min"), "station", "referee: highest slope over a minute within the windows");
    optional("control", Form::Choice(&["pid", "fuzzy", "fuzzy-pid"]), "station", "law behind the feed-forward; default pid");
};
