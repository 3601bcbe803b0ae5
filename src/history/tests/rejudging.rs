//! Stored values against another recipe.

use super::super::*;
use crate::config::load_recipe;
use crate::gauge::{Bin, Recipe, Verdict};
use std::path::Path;

fn recipe() -> Recipe {
    let config = Path::new(env!("CARGO_MANIFEST_DIR")).join("config");
    load_recipe(&config, "jzc-22f-012").unwrap()
}

/// A part in the middle of every limit but for its operate voltage.
fn part(operate_v: f64, verdict: &str, reasons: &[&str]) -> Part {
    let mut part = Part::of_paper("A", 1, verdict);
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
    part.reasons = reasons.iter().map(|it| (*it).to_owned()).collect();
    part
}

#[test]
fn the_limits_of_the_other_recipe_decide_with_the_stored_uncertainty() {
    let recipe = recipe();
    assert_eq!(
        rejudged(&part(8.9, "fail", &["operate_voltage_v high"]), &recipe),
        Verdict::Pass
    );
    let bad = rejudged(&part(9.1, "pass", &[]), &recipe);
    assert_eq!(
        (bad.bin(), bad.reasons()),
        (Bin::Voltage, vec!["operate_voltage_v high".to_owned()])
    );
    let doubtful = rejudged(&part(8.99, "pass", &[]), &recipe);
    assert_eq!(doubtful.reasons(), ["operate_voltage_v high not proven"]);
}

#[test]
fn what_no_value_says_stays() {
    let recipe = recipe();
    let mut open = part(8.0, "fail", &["coil open"]);
    open.bin = Some("coil".into());
    let again = rejudged(&open, &recipe);
    assert_eq!(
        (again.bin(), again.reasons()),
        (Bin::Coil, vec!["coil open".to_owned()])
    );
    let void = rejudged(&part(8.0, "void", &["reply refused"]), &recipe);
    assert_eq!(void, Verdict::Void(vec!["reply refused".into()]));
}

#[test]
fn a_value_that_was_never_had_is_void_and_never_passes() {
    let mut part = part(8.0, "pass", &[]);
    part.values.remove("operate_time_ms");
    let again = rejudged(&part, &recipe());
    assert_eq!(
        again,
        Verdict::Void(vec!["operate_time_ms not measured".into()])
    );
}
