//! Recipes that a rig for solid-state relays cannot carry out.
#![allow(clippy::unwrap_used)]

use super::bench::{RIG, profiles, recipe, wiring};
use crate::dut::device::Rig;
use crate::dut::em_relay::settings::ReferenceSet;
use crate::dut::made_up::MadeUp;
use crate::dut::recipe::KindRecipe;

/// Returns what hinders the recipe with changes, on a rig with changes, with profiles whose texts `profile` changes.
fn faults(
    recipe_changes: &[(&str, &str)],
    rig_change: (&str, &str),
    profile: impl Fn(&str, &str) -> String,
) -> Vec<String> {
    let text = RIG.replace(rig_change.0, rig_change.1);
    assert!(rig_change.0.is_empty() || text != RIG);
    let wiring = wiring(&text, &profiles(profile));
    let accuracy = crate::dut::em_relay::tests::context().accuracy;
    let rig = Rig {
        wiring: &wiring,
        reference: None,
        accuracy: &accuracy,
        reference_parts: &ReferenceSet::default(),
    };
    let all = recipe(recipe_changes).infeasible(&rig);
    all.iter().map(ToString::to_string).collect()
}

fn same(_: &str, text: &str) -> String {
    text.to_owned()
}

const SAME: (&str, &str) = ("smu_in]", "smu_in]");

#[test]
fn the_rig_carries_out_its_recipe_in_both_dialects() {
    for digitizer in ["digitizer-rigol", "digitizer-keysight"] {
        let change = ("\"digitizer-rigol\"", format!("\"{digitizer}\""));
        let found = RIG.replace(change.0, &change.1);
        let wiring = wiring(&found, &profiles(same));
        let accuracy = crate::dut::em_relay::tests::context().accuracy;
        let rig = Rig {
            wiring: &wiring,
            reference: None,
            accuracy: &accuracy,
            reference_parts: &ReferenceSet::default(),
        };
        assert_eq!(recipe(&[]).infeasible(&rig), [], "{digitizer}");
    }
}
