//! Tests of a rig with a rack: the rig loads without feeder and scene, and the refusal of a wrong socket or list names
//! its place.

use super::changed;
use crate::{Folder, Plant, check_all, load_recipe};
use machine::dut::FIXTURES;
use machine::rig::bin::Bin;
use machine::rig::fault::Fault;
use machine::rig::model::Terminals;
use machine::rig::point::{DigitalIn, DigitalOut};
use machine::rig::wiring::Wiring;
use std::path::Path;

/// The rig for temperature relays.
pub(super) const RACK_RIG: &str = include_str!("../../../../config/rigs/thermostat/rig.toml");

fn plant() -> Plant {
    Plant::load(&Folder::built_in_rig("thermostat").unwrap()).unwrap()
}

/// Returns why the rig is refused after one change of its text.
fn refused(from: &str, to: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("rig.toml"), changed(RACK_RIG, from, to)).unwrap();
    let fault = Plant::load(&folder.path().into()).unwrap_err().to_string();
    let (_, fault) = fault.rsplit_once("rig.toml:").unwrap();
    let (_, fault) = fault.split_once(": ").unwrap();
    fault.to_owned()
}

#[test]
fn a_rig_with_a_rack_needs_no_feeder() {
    let plant = plant();
    check_all(&plant.folder).unwrap();
    let wiring = &plant.wiring;
    let rack = wiring.rack().unwrap();
    assert_eq!((rack.sockets().len(), wiring.lines.len()), (40, 1));
    assert!(plant.scene.is_none() && wiring.feeder().is_none());
    assert_eq!(rack.lists().first(), Some(&Bin::PASS));
    assert!(wiring.has_bin(Bin::named("snap")) && !wiring.has_bin(Bin::named("coil")));
    assert_eq!(rack.socket(40).unwrap().select, 39);
    assert_eq!(
        wiring.input_name(rack.socket(7).unwrap().contact),
        "socket_07"
    );
}

#[test]
fn points_of_a_feeder_have_no_terminal_here() {
    let wiring = plant().wiring;
    for point in DigitalIn::ALL {
        let here = DigitalIn::OF_RACK.contains(point);
        assert_eq!(wiring.wired_in(*point).is_some(), here, "{point}");
        assert_eq!(wiring.digital_input(point.name()).is_some(), here);
    }
    for point in DigitalOut::ALL {
        let here = DigitalOut::OF_RACK.contains(point);
        assert_eq!(wiring.wired_out(*point).is_some(), here, "{point}");
    }
    assert!(
        wiring
            .digital_inputs()
            .all(|(_, it)| wiring.wired_in(it).is_some())
    );
}

#[test]
fn the_scan_reads_the_safety_chain_on_any_module() {
    let text = changed(
        RACK_RIG,
        "limiter_ok        = { module = \"socket_di_c\", channel = 11,",
        "limiter_ok        = { module = \"socket_di_c\", channel = 14,",
    );
    let settings = toml::from_str(&text).unwrap();
    let wiring = Wiring::resolve(&settings, FIXTURES).unwrap();
    for name in ["limiter_ok", "airflow_ok", "mains_ok"] {
        let input = wiring.digital_input(name).unwrap();
        assert!(wiring.scanned_inputs().contains(&input), "{name}");
    }
}

#[test]
fn four_analog_outputs_have_channels_of_their_own() {
    let wiring = plant().wiring;
    let outputs = ["heater_power", "vent_opening"].map(|it| wiring.analog_output(it).unwrap());
    let channels = outputs.map(|it| wiring.analog_out(it).channel.get());
    assert_eq!(channels, [0, 1]);
    let module = wiring.module(wiring.analog_out(outputs[0]).module);
    assert_eq!(module.model.channels(Terminals::AnalogOut), 4);
    assert_eq!(module.level_channels().len(), 4);
}

#[test]
fn two_sockets_on_one_input_are_refused() {
    let from = "02 = { module = \"socket_di_a\", channel = 1,";
    let to = "02 = { module = \"socket_di_a\", channel = 0,";
    let why = refused(from, to);
    assert!(
        why.starts_with(
            "[socket].02: found socket_di_a channel 0, expected a terminal of its own (line"
        ),
        "{why}"
    );
    assert!(why.ends_with(": [socket].01)"), "{why}");
}

#[test]
fn wrong_sockets_and_lists_are_refused() {
    for (from, to, why) in [
        (
            "select = 1,",
            "select = 0,",
            "[socket].02.select: found 0, expected a number of its own",
        ),
        (
            "row = 1, column = 2 }",
            "row = 1, column = 1 }",
            "[socket].02.column: found 1, expected a place of its own",
        ),
        (
            "\n02 = {",
            "\n1 = {",
            "[socket].1: found 1, expected a number of its own",
        ),
        (
            "\n02 = {",
            "\nb2 = {",
            "[socket].b2: found the name \"b2\", expected the number",
        ),
        (
            "\"retest\"]",
            "\"other\"]",
            "[rack].lists: found pass, temperature, contact, snap, other, expected the list \"retest\"",
        ),
        (
            "\"snap\", ",
            "\"pass\", ",
            "[rack].lists[3]: found \"pass\", expected a list of its own",
        ),
        (
            "[rack]",
            "[axis]\nnest = { point = 0, x_mm = 0.0 }\n[rack]",
            "[axis]: found an unknown key",
        ),
        (
            "rack_temperature      = { module = \"rtd\", channel = 2 }",
            "",
            "[temperature].rack_temperature: found nothing",
        ),
        (
            "type = \"22\"",
            "type = \"0F\"",
            "[module.rtd].type: found \"0F\", expected 20, 21, 22, 23, 24, 25, 26, 27 for an I-7033",
        ),
        (
            "type = \"0F\"",
            "type = \"22\"",
            "[module.thermocouple].type: found \"22\", expected 0E, 0F, 10, 11 for an I-7018",
        ),
    ] {
        let found = refused(from, to);
        assert!(found.contains(why), "{found}");
    }
}

#[test]
fn a_recipe_for_a_feeder_is_refused_on_a_rack() {
    let plant = plant();
    let recipes = Folder::Directory(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config"));
    for name in ["jzc-22f-012", "resistor-390"] {
        let recipe = load_recipe(&recipes, name).unwrap();
        let why: Vec<String> = recipe
            .infeasible(&plant.rig())
            .iter()
            .map(Fault::to_string)
            .collect();
        let kind = recipe.device.kind().name();
        let needs =
            format!("kind: found \"{kind}\", expected a rig with a feeder: rig.toml has [rack]");
        assert!(why.contains(&needs), "{why:?}");
    }
}

#[test]
fn a_rack_with_other_numbers_of_sockets_resolves() {
    let text = RACK_RIG.lines().filter(|line| {
        let number = line.get(..2).and_then(|it| it.parse::<u16>().ok());
        number.is_none_or(|it| it <= 10)
    });
    let text: Vec<&str> = text.collect();
    let settings = toml::from_str(&text.join("\n")).unwrap();
    let wiring = Wiring::resolve(&settings, FIXTURES).unwrap();
    assert_eq!(wiring.rack().unwrap().sockets().len(), 10);
}
