//! Tests of the whole folder: missing files, the scene, reference parts, unknown recipes.

use super::{GOLDEN, RIG, changed, line_of};
use crate::{Plant, load_recipe, recipe_names};
use std::path::Path;

/// A copy of `config/` with one file changed; the copy is deleted when this value is dropped.
pub(super) struct Copy(pub tempfile::TempDir);

impl Copy {
    pub fn with(file: &str, change: impl Fn(&str) -> String) -> Self {
        let original = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../config");
        let copy = tempfile::tempdir().unwrap();
        std::fs::create_dir(copy.path().join("recipes")).unwrap();
        for known in [
            "rig.toml",
            "scene.toml",
            "golden.toml",
            "recipes/jzc-22f-012.toml",
        ] {
            let text = std::fs::read_to_string(original.join(known)).unwrap();
            let text = if known == file { change(&text) } else { text };
            std::fs::write(copy.path().join(known), text).unwrap();
        }
        Self(copy)
    }

    /// Returns the message with which loading fails, without the path of the folder.
    pub fn refused(&self) -> String {
        Plant::load(&self.0.path().into())
            .unwrap_err()
            .to_string()
            .replace(&format!("{}/", self.0.path().display()), "")
    }
}

#[test]
fn the_whole_plant_is_loaded_from_its_folder() {
    let copy = Copy::with("", str::to_owned);
    let plant = Plant::load(&copy.0.path().into()).unwrap();
    assert_eq!(plant.reference_parts.of_nominal(12.0).count(), 5);
    assert_eq!(plant.reference.unwrap().coil_ohm, 400.0);
    assert_eq!(plant.accuracy.conversions_per_s, 75.0);
    assert_eq!(
        load_recipe(&copy.0.path().into(), "jzc-22f-012")
            .unwrap()
            .device
            .part()
            .nominal_v,
        Some(12.0)
    );
}

#[test]
fn a_recipe_is_refused_without_its_bins() {
    let copy = Copy::with("rig.toml", |text| {
        text.replace("\ncoil    =", "\ngrade_2 =")
    });
    let plant = Plant::load(&copy.0.path().into()).unwrap();
    let recipe = load_recipe(&copy.0.path().into(), "jzc-22f-012").unwrap();
    let message = plant.admit(&recipe).unwrap_err().to_string();
    assert!(
        message.ends_with(
            "jzc-22f-012.toml:3: kind: found \"em_relay\", expected a rig with the bins of this kind: rig.toml has no bin.coil"
        ),
        "{message}"
    );
}

#[test]
fn an_unknown_recipe_is_refused_with_the_known_ones() {
    let copy = Copy::with("", str::to_owned);
    assert_eq!(recipe_names(&copy.0.path().into()), ["jzc-22f-012"]);
    for name in ["jzc-22f-013", "../rig", ""] {
        let message = load_recipe(&copy.0.path().into(), name)
            .unwrap_err()
            .to_string();
        assert!(
            message.ends_with(&format!(
                "found no recipe \"{name}\", expected one of jzc-22f-012"
            )),
            "{message}"
        );
    }
}

#[test]
fn a_missing_file_is_named() {
    let copy = Copy::with("", str::to_owned);
    std::fs::remove_file(copy.0.path().join("golden.toml")).unwrap();
    assert_eq!(
        copy.refused(),
        "golden.toml: found no readable file, expected the reference parts"
    );
}

#[test]
fn a_duplicate_serial_is_refused_with_both_lines() {
    let copy = Copy::with("golden.toml", |text| changed(text, "G-12-2", "G-12-1"));
    let [first, second] = [line_of(GOLDEN, "G-12-1"), line_of(GOLDEN, "G-12-2")];
    let expected = format!(
        "golden.toml:{second}: golden[1].serial: found \"G-12-1\", expected a serial number of its own \
         (line {first}: golden[0].serial)"
    );
    assert_eq!(copy.refused(), expected);
}

#[test]
fn an_unknown_scene_key_is_refused_with_its_line() {
    let copy = Copy::with("scene.toml", |text| {
        changed(text, "stroke_mm = 60.0", "strok_mm = 60.0")
    });
    let message = copy.refused();
    assert!(message.starts_with("scene.toml:"), "{message}");
    assert!(
        message.contains("actuator[1].strok_mm: unknown field `strok_mm`"),
        "{message}"
    );
}

#[test]
fn a_scene_number_out_of_range_is_refused() {
    let copy = Copy::with("scene.toml", |text| {
        let line = text
            .lines()
            .find(|line| line.starts_with("default_margin_mm"))
            .unwrap();
        changed(text, line, "default_margin_mm = -1.0")
    });
    let message = copy.refused();
    let line = std::fs::read_to_string(copy.0.path().join("scene.toml"))
        .map(|text| line_of(&text, "default_margin_mm"))
        .unwrap();
    assert!(
        message.starts_with(&format!(
            "scene.toml:{line}: guard.default_margin_mm: found -1"
        )),
        "{message}"
    );
}

#[test]
fn a_place_beyond_the_axis_stroke_is_refused() {
    let copy = Copy::with("rig.toml", |text| {
        changed(text, "point = 7, x_mm = 350.0", "point = 7, x_mm = 360.0")
    });
    let expected = format!(
        "rig.toml:{}: [bin].retest.x_mm: found 360, expected 0 to 350, the stroke of sort_axis in scene.toml",
        line_of(RIG, "retest  =")
    );
    assert_eq!(copy.refused(), expected);
}
