//! Tests: stored values judged by another recipe.

use super::super::*;
use config::{Folder, load_recipe};
use machine::dut::em_relay::bins;
use machine::dut::em_relay::recipe::RelayRecipe;
use machine::dut::recipe::DeviceRecipe;
use machine::dut::rejudge::Basis;
use machine::dut::{Reason, Recipe, Verdict};
use machine::instrument::curve::Curve;

fn recipe() -> Recipe {
    load_recipe(&Folder::built_in(), "jzc-22f-012").unwrap()
}

/// Returns a part whose values lie in the middle of all limits, except for its operate voltage.
fn part(operate_v: f64, verdict: &str, reasons: &[&str]) -> Part {
    let mut part = Part::fixture("A", 1, verdict);
    for (key, value) in [
        ("coil_resistance_ohm", 400.0),
        ("operate_voltage_v", operate_v),
        ("release_voltage_v", 2.3),
        ("operate_time_ms", 4.7),
        ("release_time_ms", 2.9),
        ("operate_bounce_ms", 0.4),
        ("release_bounce_ms", 0.5),
        ("contact_resistance_no_mohm", 18.0),
        ("contact_resistance_nc_mohm", 22.0),
    ] {
        part.values.insert(key.into(), value.into());
        part.uncertainty.insert(key.into(), 0.02.into());
    }
    part.with_reasons(reasons.iter().map(|it| Reason::from_text(it)).collect())
}

fn relay(recipe: &mut Recipe) -> &mut RelayRecipe {
    match &mut recipe.device {
        DeviceRecipe::EmRelay(relay) => relay,
        DeviceRecipe::Resistor(_) | DeviceRecipe::Ssr(_) | DeviceRecipe::Thermostat(_) => {
            panic!("a relay")
        }
    }
}

fn by_values(part: &Part, recipe: &Recipe) -> Verdict {
    rejudged(part, &[], Basis::of_recipe(recipe), recipe)
}

#[test]
fn the_other_recipes_limits_judge_with_stored_uncertainty() {
    let recipe = recipe();
    assert_eq!(
        by_values(&part(8.9, "fail", &["operate_voltage_v high"]), &recipe),
        Verdict::Pass
    );
    let bad = by_values(&part(9.1, "pass", &[]), &recipe);
    assert_eq!(
        (bad.bin(), bad.texts()),
        (bins::VOLTAGE, vec!["operate_voltage_v high".to_owned()])
    );
    let doubtful = by_values(&part(8.99, "pass", &[]), &recipe);
    assert_eq!(doubtful.texts(), ["operate_voltage_v high not proven"]);
}

#[test]
fn what_no_value_says_stays() {
    let recipe = recipe();
    let mut open = part(8.0, "fail", &["coil open"]);
    open.bin = Some("coil".into());
    let again = by_values(&open, &recipe);
    assert_eq!(
        (again.bin(), again.texts()),
        (bins::COIL, vec!["coil open".to_owned()])
    );
    let void = by_values(&part(8.0, "void", &["reply refused"]), &recipe);
    assert_eq!(
        void,
        Verdict::Void(vec![Reason::unclassified("reply refused")])
    );
}

#[test]
fn a_missing_value_is_void() {
    let mut part = part(8.0, "pass", &[]);
    part.values.remove("operate_time_ms");
    let again = by_values(&part, &recipe());
    assert_eq!(
        again,
        Verdict::Void(vec![Reason::from_text("operate_time_ms not measured")])
    );
}

#[test]
fn values_convert_to_the_other_recipes_reference_temperature() {
    let mut recipe = recipe();
    let stored = part(8.9, "pass", &[]);
    let at_23_c = Basis::of_recipe(&recipe);
    relay(&mut recipe).part.reference_temperature_c = 33.0;
    let warmer = rejudged(&stored, &[], at_23_c, &recipe);
    assert_eq!(warmer.texts(), ["operate_voltage_v high"], "9.25 V at 33 C");
}

#[test]
fn a_recipe_of_another_coil_voltage_does_not_fit() {
    let mut recipe = recipe();
    let basis = Basis::of(&recipe.source_text).unwrap();
    assert_eq!(basis, Basis::of_recipe(&recipe));
    assert_eq!(basis.misfit(&recipe), None);
    relay(&mut recipe).part.nominal_v = 24.0;
    assert!(basis.misfit(&recipe).is_some());
    assert_eq!(Basis::of("name = \"old\""), None);
}

/// Returns the recipe with a higher limit: operate voltage up to 11.5 V.
fn generous() -> Recipe {
    let folder = tempfile::tempdir().unwrap();
    let text = recipe().source_text.replace(
        "operate_voltage_v = { high = 9.0 }",
        "operate_voltage_v = { high = 11.5 }",
    );
    std::fs::create_dir(folder.path().join("recipes")).unwrap();
    std::fs::write(folder.path().join("recipes/jzc-22f-012.toml"), text).unwrap();
    load_recipe(&folder.path().into(), "jzc-22f-012").unwrap()
}

/// Returns curves of a coil driven from 5 V up to 11 V whose contact never made.
fn never_made() -> Vec<Curve> {
    let curve = |signal: &str, samples: &[(i64, f64)]| Curve {
        signal: signal.into(),
        unit: String::new(),
        begin_us: 0,
        t_us: samples.iter().map(|it| it.0).collect(),
        values: samples.iter().map(|it| Some(it.1)).collect(),
    };
    vec![
        curve("supply_level", &[(0, 5.0)]),
        curve("supply_coarse", &[(20_000, 6.0)]),
        curve("coil_drive", &[(5_000, 1.0)]),
        curve("board", &[(10_000, 2.0), (190_000, 2.0)]),
    ]
}

#[test]
fn curves_decide_a_missing_value_as_fail_or_void() {
    let recipe = recipe();
    let mut high = part(
        8.0,
        "fail",
        &["operate_voltage_v high: above the coarse ramp"],
    );
    high.values.remove("operate_voltage_v");
    high.bin = Some("voltage".into());
    let basis = Basis::of_recipe(&recipe);
    let strict = rejudged(&high, &never_made(), basis, &recipe);
    assert_eq!(
        (strict.bin(), strict.texts()),
        (bins::VOLTAGE, vec!["operate_voltage_v high".to_owned()])
    );
    let generous = rejudged(&high, &never_made(), basis, &generous());
    assert_eq!(
        generous,
        Verdict::Void(vec![Reason::from_text("operate_voltage_v not measured")])
    );
    let blind = rejudged(&high, &[], basis, &recipe);
    assert_eq!(blind.name(), "fail", "nothing was kept of it, so it stays");
}
