//! Tests of resistor dummies on the line under manual control.

use super::hand::{Hand, options};
use super::*;

/// Creates a configuration folder with one recipe, `dummy`, of this kind.
pub(super) fn folder(kind: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in ["rig.toml", "sim.toml", "scene.toml", "golden.toml"] {
        std::fs::copy(config_dir().join(file), folder.path().join(file)).unwrap();
    }
    let recipe = format!(
        "name = \"dummy\"\nkind = \"{kind}\"\n\n[part]\nbody_mm = [22.5, 16.5, 16.5]\npin_length_mm = 3.5\n"
    );
    let recipes = folder.path().join("recipes");
    std::fs::create_dir(&recipes).unwrap();
    std::fs::write(recipes.join("dummy.toml"), recipe).unwrap();
    folder
}

/// Returns options for three dummies and for reference parts, which this kind does not have.
pub(super) fn dummies(folder: &tempfile::TempDir) -> WorldOptions {
    WorldOptions {
        files: folder.path().into(),
        recipe: "dummy".into(),
        ..options(true)
    }
}

#[test]
fn a_dummy_passes_the_line_and_shows_its_resistance() {
    let folder = folder("resistor");
    let mut hand = Hand::new(dummies(&folder));
    hand.feed();
    hand.set("kelvin_test", true);
    let pins = ["coil_a", "coil_b", "com", "no", "nc"];
    assert!(pins.iter().all(|pin| hand.is_on(&format!("kelvin_{pin}"))));
    hand.set("kelvin_test", false);
    hand.level(2.5);
    hand.set("coil_drive", true);
    hand.wait(1.0);
    let (volts, amperes) = (hand.value("coil_voltage"), hand.value("coil_current_fine"));
    assert!((volts - 2.5).abs() < 1e-9, "{volts} V");
    for contact in ["no_closed", "nc_closed"] {
        assert!(!hand.is_on(contact), "{contact}");
    }
    hand.set("source_on", true);
    hand.wait(20.0);
    assert_eq!(hand.value("contact_current"), 0.0);
    hand.set("source_on", false);
    hand.set("coil_drive", false);
    hand.wait(1.0);
    assert_eq!(hand.value("coil_current"), 0.0);
    hand.sort(2);
    let truth = &hand.world.truth()[0];
    let ohm = truth["resistance_ohm"].as_f64().unwrap();
    let off = volts / amperes / ohm - 1.0;
    assert!(off.abs() < 3e-4, "{off} within 12 K at 25 ppm");
    assert_eq!(truth["landed_in"], "pass");
    assert!(truth["defect"].is_null());
    assert_eq!(hand.world.crashes(), Vec::<String>::new());
}

#[test]
fn a_short_reaches_the_current_limit_of_the_supply() {
    let folder = folder("resistor");
    let world = folder.path().join("world.toml");
    let short = "[resistor]\nnominal_ohm = 1.0\ndefects_pct = 0.0\n";
    std::fs::write(&world, short).unwrap();
    let mut hand = Hand::new(WorldOptions {
        world_file: Some(world.clone()),
        ..dummies(&folder)
    });
    hand.feed();
    hand.level(2.5);
    hand.set("coil_drive", true);
    hand.wait(1.0);
    let (volts, amperes) = (hand.value("coil_voltage"), hand.value("coil_current"));
    assert!((volts - 0.15).abs() < 0.002, "{volts} V");
    assert!(amperes >= 0.05, "{amperes} A");
}

#[test]
fn a_refill_may_change_the_kind_of_part() {
    let folder = folder("resistor");
    let relays = folder.path().join("recipes/jzc-22f-012.toml");
    std::fs::copy(config_dir().join("recipes/jzc-22f-012.toml"), relays).unwrap();
    let mut hand = Hand::new(WorldOptions {
        files: folder.path().into(),
        ..options(false)
    });
    hand.feed();
    hand.sort(2);
    hand.world.refill(&dummies(&folder)).unwrap();
    hand.feed();
    let truth = hand.world.truth();
    assert!(truth[0].get("resistance_ohm").is_none() && truth[0]["operate_voltage_v"].is_f64());
    assert!(truth[1]["resistance_ohm"].is_f64() && truth[1]["operate_voltage_v"].is_null());
}

#[test]
fn an_unknown_kind_is_refused_with_file_and_line() {
    let folder = folder("capacitor");
    let error = World::build(&dummies(&folder)).unwrap_err().to_string();
    assert!(
        error.contains(
            "dummy.toml:2: kind: found \"capacitor\", expected em_relay, resistor or ssr"
        ),
        "{error}"
    );
}
