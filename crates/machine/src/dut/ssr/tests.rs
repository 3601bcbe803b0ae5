//! Recipes that a rig for solid-state relays cannot carry out.
#![allow(clippy::unwrap_used)]

pub mod bench;
pub mod line_bench;

use crate::dut::Recipe;
use crate::dut::device::Rig;
use crate::dut::em_relay::settings::ReferenceSet;
use bench::{RIG, profiles, recipe, wiring};

/// Returns what hinders the recipe with changes, on a rig with changes, with profiles whose texts `profile` changes.
fn faults(
    recipe_changes: &[(&str, &str)],
    rig_change: (&str, &str),
    profile: impl Fn(&str, &str) -> String,
) -> Vec<String> {
    faults_of(&recipe(recipe_changes), rig_change, profile)
}

fn faults_of(
    recipe: &Recipe,
    rig_change: (&str, &str),
    profile: impl Fn(&str, &str) -> String,
) -> Vec<String> {
    let text = RIG.replace(rig_change.0, rig_change.1);
    assert!(RIG.contains(rig_change.0), "{rig_change:?}");
    let wiring = wiring(&text, &profiles(profile));
    let accuracy = crate::dut::em_relay::tests::context().accuracy;
    let rig = Rig {
        wiring: &wiring,
        reference: None,
        accuracy: &accuracy,
        reference_parts: &ReferenceSet::default(),
        certificate: None,
    };
    let all = recipe.infeasible(&rig);
    all.iter().map(ToString::to_string).collect()
}

fn same(_: &str, text: &str) -> String {
    text.to_owned()
}

const NO_CHANGE: (&str, &str) = ("", "");

#[test]
fn the_rig_carries_out_its_recipe_in_both_dialects() {
    for digitizer in ["\"digitizer-rigol\"", "\"digitizer-keysight\""] {
        let found = faults(&[], ("\"digitizer-rigol\"", digitizer), same);
        assert_eq!(found, [""; 0], "{digitizer}");
    }
}

#[test]
fn both_dialects_have_the_same_programs() {
    let all = profiles(same);
    let programs = |name: &str| all[name].programs().map(str::to_owned).collect::<Vec<_>>();
    let (mut rigol, mut keysight) = (programs("digitizer-rigol"), programs("digitizer-keysight"));
    rigol.retain(|it| it != "acquire");
    keysight.retain(|it| it != "acquire");
    assert_eq!(rigol, keysight);
}

#[test]
fn a_rig_without_an_instrument_is_refused() {
    let found = faults(&[], ("instrument.smu_in]", "instrument.smu]"), same);
    assert_eq!(found.len(), 1);
    assert!(found[0].contains("no [instrument].smu_in"), "{found:?}");
}

#[test]
fn a_profile_without_a_program_is_refused() {
    for (program, profile) in [
        ("program.step", "smu-2450"),
        ("program.capture", "digitizer-rigol"),
        ("program.off", "pulse-source"),
    ] {
        let change = |name: &str, text: &str| match name == profile {
            true => text.replace(&format!("[{program}]"), "[program.other]"),
            false => text.to_owned(),
        };
        let found = faults(&[], NO_CHANGE, change);
        assert!(
            !found.is_empty() && found.iter().all(|it| it.contains(profile)),
            "{found:?}"
        );
    }
}

#[test]
fn an_argument_out_of_range_is_refused() {
    let found = faults(
        &[("control_v = 5.0", "control_v = 19.0")],
        NO_CHANGE,
        |_, text| {
            text.replace(
                "argument.level_v = { low = 0.02, high = 20.0 }",
                "argument.level_v = { low = 0.02, high = 10.0 }",
            )
        },
    );
    assert!(
        found.len() == 1 && found[0].contains("level_v"),
        "{found:?}"
    );
}

#[test]
fn a_profile_without_a_range_is_refused() {
    let change = |_: &str, text: &str| text.replace("\"source_current_a\"", "\"frequency_hz\"");
    let found = faults(&[], NO_CHANGE, change);
    assert!(
        found.len() == 1 && found[0].contains("source_current_a"),
        "{found:?}"
    );
}

#[test]
fn limits_that_conformity_cannot_decide_are_refused() {
    for (from, to) in [
        (
            "v_on_v = { high = 3.5 }",
            "v_on_v = { low = 2.0, high = 3.5 }",
        ),
        (
            "v_off_v = { low = 1.0 }",
            "v_off_v = { low = 1.0, high = 3.0 }",
        ),
        ("v_on_v = { high = 3.5 }", "v_on_v = { high = 5.5 }"),
        ("v_off_v = { low = 1.0 }", "v_off_v = { low = 3.49 }"),
    ] {
        assert_eq!(faults(&[(from, to)], NO_CHANGE, same).len(), 1, "{to}");
    }
}

#[test]
fn a_ramp_needs_a_step_at_its_begin() {
    let cases = [
        (
            "v_off_v = { low = 1.0 }",
            "v_off_v = { low = 0.2 }",
            "limits.v_off_v.low",
        ),
        (
            "v_on_v = { high = 3.5 }",
            "v_on_v = { high = 4.6 }",
            "limits.v_on_v.high",
        ),
    ];
    let ramp = ("method = \"bisect\"", "method = \"ramp\"");
    assert_eq!(faults(&[ramp], NO_CHANGE, same), [""; 0]);
    for (from, to, key) in cases {
        let found = faults(&[ramp, (from, to)], NO_CHANGE, same);
        assert!(found.len() == 1 && found[0].contains(key), "{found:?}");
    }
}

#[test]
fn a_ramp_of_an_ac_part_is_refused() {
    let ramp = [("method = \"bisect\"", "method = \"ramp\"")];
    let recipe = line_bench::recipe(line_bench::ZERO_CROSS, &ramp);
    let found = faults_of(&recipe, NO_CHANGE, same);
    assert!(
        found.len() == 1 && found[0].contains("test.method"),
        "{found:?}"
    );
}

#[test]
fn made_up_parts_lie_inside_every_limit() {
    let recipe = recipe(&[]);
    let made_up = recipe.device.made_up(&recipe.limits);
    assert_eq!(made_up.scatter.len(), super::Parameter::ALL.len());
    for (of, scatter) in &made_up.scatter {
        let limit = recipe.limits.of(*of);
        let reach = 4.0 * scatter.sd;
        assert!(
            limit.low.is_none_or(|low| low < scatter.mean - reach),
            "{of}"
        );
        assert!(
            limit.high.is_none_or(|high| scatter.mean + reach < high),
            "{of}"
        );
    }
}
