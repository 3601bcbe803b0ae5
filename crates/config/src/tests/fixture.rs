//! Tests of rigs that lack points of a fixture: such a rig loads, and the refusal of a recipe names the point that is
//! missing.

use super::RIG;
use super::rack::RACK_RIG;
use crate::{Folder, Plant, load_recipe, recipe_names};
use machine::dut::FIXTURES;
use machine::dut::Kind;
use machine::rig::point::{DigitalIn, DigitalOut};
use std::path::Path;
use toml::{Table, Value};

/// Sections of `rig.toml` whose entries are points.
const POINTS: [&str; 6] = [
    "digital_in",
    "digital_out",
    "analog_in",
    "analog_out",
    "counter",
    "temperature",
];

/// Returns the default rig without the points for which `lacks` is true.
fn without(lacks: impl Fn(&str, &Table) -> bool) -> Table {
    let mut rig: Table = toml::from_str(RIG).unwrap();
    for section in POINTS {
        let points = rig[section].as_table_mut().unwrap();
        points.retain(|name, point| !lacks(name, point.as_table().unwrap()));
    }
    rig
}

/// Returns the default rig without its coil board, that is, without the measuring line and everything on that line.
fn without_the_coil_board() -> Table {
    let rig: Table = toml::from_str(RIG).unwrap();
    let measures = |module: &Value| module["line"].as_str() == Some("measure");
    let board = |point: &Table| measures(&rig["module"][point["module"].as_str().unwrap()]);
    let mut bare = without(|_, point| board(point));
    let modules = bare["module"].as_table_mut().unwrap();
    modules.retain(|_, module| !measures(module));
    bare["line"].as_table_mut().unwrap().remove("measure");
    for section in [
        "analog_in",
        "analog_out",
        "supply_range",
        "counter",
        "temperature",
    ] {
        bare.remove(section);
    }
    bare
}

/// Returns a copy of the default folder with this `rig.toml`.
fn folder(rig: &Table) -> tempfile::TempDir {
    let original = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config");
    let copy = tempfile::tempdir().unwrap();
    let to = |name: &str| copy.path().join(name);
    std::fs::create_dir(to("recipes")).unwrap();
    let recipes = recipe_names(&Folder::Directory(original.clone())).into_iter();
    let recipes = recipes.map(|name| format!("recipes/{name}.toml"));
    for name in ["scene.toml", "golden.toml"]
        .map(String::from)
        .into_iter()
        .chain(recipes)
    {
        std::fs::copy(original.join(&name), to(&name)).unwrap();
    }
    std::fs::write(to("rig.toml"), toml::to_string(rig).unwrap()).unwrap();
    copy
}

/// Returns, for the recipe of each relay, why this rig refuses it.
fn refused(rig: &Table) -> Vec<String> {
    let copy = folder(rig);
    let plant = Plant::load(&copy.path().into()).unwrap();
    let recipes = recipe_names(&copy.path().into());
    let recipes = recipes
        .iter()
        .map(|name| load_recipe(&copy.path().into(), name).unwrap());
    let relays = recipes.filter(|recipe| recipe.device.kind() == Kind::EmRelay);
    relays
        .map(|recipe| plant.admit(&recipe).unwrap_err().to_string())
        .collect()
}

/// The rig for solid-state relays.
const SSR_RIG: &str = include_str!("../../../../config/rigs/ssr/rig.toml");

#[test]
fn a_rig_without_coil_board_refuses_relay_recipes() {
    let refused = refused(&without_the_coil_board());
    assert_eq!(refused.len(), 9);
    for message in refused {
        let why = "[test]: found no [digital_in].kelvin_coil_a in rig.toml, \
                   expected a rig with every point that its test needs";
        assert!(message.ends_with(why), "{message}");
        assert!(message.contains("recipes/jzc-22f-0"), "{message}");
    }
}

#[test]
fn a_rig_without_references_refuses_relays_and_takes_resistors() {
    let rig: Table = toml::from_str(RIG).unwrap();
    let mut no_board = rig.clone();
    no_board.remove("reference");
    let mut no_parts = rig;
    no_parts["calibration"]
        .as_table_mut()
        .unwrap()
        .remove("golden");
    let cases = [
        (no_board, "references: rig.toml has no [reference]"),
        (
            no_parts,
            "reference parts: rig.toml names no file of them in [calibration].golden",
        ),
    ];
    for (rig, lacks) in cases {
        let refused = refused(&rig);
        assert_eq!(refused.len(), 9);
        for message in refused {
            let why = format!("kind: found \"em_relay\", expected a rig with {lacks}");
            assert!(message.ends_with(&why), "{message}");
        }
        let copy = folder(&rig);
        let recipe = load_recipe(&copy.path().into(), "resistor-390").unwrap();
        Plant::load(&copy.path().into())
            .unwrap()
            .admit(&recipe)
            .unwrap();
    }
}

#[test]
fn the_first_missing_point_refuses_a_resistor() {
    let copy = folder(&without_the_coil_board());
    let plant = Plant::load(&copy.path().into()).unwrap();
    let recipe = load_recipe(&copy.path().into(), "resistor-390").unwrap();
    let why = plant.admit(&recipe).unwrap_err().to_string();
    assert!(
        why.contains("no [digital_out].coil_drive in rig.toml"),
        "{why}"
    );
}

#[test]
fn the_machine_resolves_without_the_coil_board() {
    let copy = folder(&without_the_coil_board());
    let wiring = Plant::load(&copy.path().into()).unwrap().wiring;
    assert_eq!((wiring.lines.len(), wiring.modules.len()), (1, 4));
    assert_eq!(wiring.measuring_lines(), []);
    for point in DigitalIn::OF_FEEDER {
        let handle = wiring.digital_input(point.name()).unwrap();
        assert_eq!(handle, (*point).into());
    }
    for point in DigitalOut::OF_FEEDER {
        let handle = wiring.digital_output(point.name()).unwrap();
        assert_eq!(handle.of_machine(), Some(*point));
    }
    let beams = wiring.axis().bins().map(|bin| wiring.axis().beam(bin));
    assert!(
        beams
            .map(|beam| wiring.input_name(beam))
            .all(|name| name.starts_with("beam_"))
    );
    assert_eq!(
        wiring.digital_inputs().count(),
        DigitalIn::OF_FEEDER.len() + wiring.axis().bins().count()
    );
    assert_eq!(
        wiring.emergency_stop_line(),
        wiring.line_named("motion").unwrap()
    );
}

#[test]
fn the_first_missing_point_refuses_a_recipe() {
    for (section, name) in [
        ("digital_in", "latch"),
        ("digital_out", "arm"),
        ("analog_in", "contact_drop"),
        ("analog_out", "supply_fine"),
        ("counter", "gate_1"),
        ("temperature", "track_temperature"),
    ] {
        let refused = refused(&without(|known, _| known == name));
        let why = format!("found no [{section}].{name} in rig.toml, expected");
        assert!(refused.iter().all(|it| it.contains(&why)), "{refused:?}");
    }
}

#[test]
fn a_recipe_needs_only_the_points_it_reads() {
    let spare = [
        "coil_voltage",
        "contact_current",
        "supply_voltage",
        "nest_temperature",
    ];
    let copy = folder(&without(|name, _| spare.contains(&name)));
    let plant = Plant::load(&copy.path().into()).unwrap();
    for name in recipe_names(&copy.path().into()) {
        plant
            .admit(&load_recipe(&copy.path().into(), &name).unwrap())
            .unwrap();
    }
}

#[test]
fn a_rig_of_each_fixture_wires_every_declared_point() {
    let rigs = [RIG, SSR_RIG, RACK_RIG].map(|it| toml::from_str::<Table>(it).unwrap());
    assert_eq!(rigs.len(), FIXTURES.len());
    for (kind, rig) in FIXTURES.iter().zip(&rigs) {
        let outputs = kind.digital_out.iter().map(|it| ("digital_out", it.name));
        let analog = kind.analog_in.iter().map(|it| ("analog_in", it.name));
        let inputs = kind.digital_in.iter().map(|it| ("digital_in", *it));
        let sources = kind.analog_out.iter().map(|it| ("analog_out", *it));
        for (section, name) in outputs.chain(analog).chain(inputs).chain(sources) {
            assert!(rig[section].get(name).is_some(), "{section} {name}");
        }
    }
}
