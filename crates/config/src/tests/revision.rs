//! Tests of revisions: what is kept, what is refused, and that a refusal leaves the folder as it was.

use super::plant::Copy;
use crate::{Approval, Change, ConfigError, Plant, approval, load_recipe, revise, revision};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

const NAME: &str = "jzc-22f-012";

fn bench() -> (Copy, Plant) {
    let copy = Copy::with("", str::to_owned);
    let plant = Plant::load(&copy.0.path().into()).unwrap();
    (copy, plant)
}

/// Returns a change of one value, based on the newest revision.
fn change(plant: &Plant, path: &str, value: serde_json::Value) -> Change {
    Change {
        from: revision(&plant.folder, NAME, None).unwrap().hash,
        ..change_of(path, value)
    }
}

/// Returns a change of one value, based on no revision.
fn change_of(path: &str, value: serde_json::Value) -> Change {
    Change {
        name: NAME.into(),
        from: String::new(),
        reason: "tighter".into(),
        save_as: None,
        values: [(path.to_owned(), value)].into(),
    }
}

/// Returns every file below the folder, with its text.
pub(super) fn files(folder: &Path) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else {
            let text = std::fs::read_to_string(&path).unwrap();
            found.insert(path.display().to_string(), text);
        }
    }
    found
}

#[test]
fn a_change_without_reason_changes_nothing() {
    let (copy, plant) = bench();
    let before = files(copy.0.path());
    for reason in ["", " "] {
        let mut change = change(&plant, "limits.operate_voltage_v.high", json!(8.7));
        change.reason = reason.into();
        let refused = revise(&plant, &change).unwrap_err();
        assert!(matches!(refused, ConfigError::NoReason), "{refused}");
    }
    assert_eq!(files(copy.0.path()), before);
}

#[test]
fn a_revision_loads_next_and_keeps_the_old_text() {
    let (copy, plant) = bench();
    let old = load_recipe(&copy.0.path().into(), NAME).unwrap();
    let path = "limits.operate_voltage_v.high";
    let saved = revise(&plant, &change(&plant, path, json!(8.7))).unwrap();
    assert_eq!((saved.number, saved.newest), (2, 2));
    let lines: Vec<String> = saved.changes.iter().map(ToString::to_string).collect();
    assert_eq!(lines, ["limits.operate_voltage_v.high: 9.0 V -> 8.7 V"]);
    let new = load_recipe(&copy.0.path().into(), NAME).unwrap();
    assert_eq!(new.hash, saved.hash);
    assert!(
        new.source_text
            .contains("operate_voltage_v = { high = 8.7 }")
    );
    let kept = copy.0.path().join("recipes/revisions/jzc-22f-012/1.toml");
    assert_eq!(std::fs::read_to_string(kept).unwrap(), old.source_text);
    assert_eq!(
        revision(&copy.0.path().into(), NAME, Some(1)).unwrap().hash,
        old.hash
    );
    let third = revise(&plant, &change(&plant, path, json!(9.0))).unwrap();
    assert_eq!(
        (third.number, &third.hash),
        (3, &old.hash),
        "back again is a revision too"
    );
    assert_eq!(crate::recipe_names(&copy.0.path().into()), [NAME]);
    let files = files(&copy.0.path().join("recipes"));
    assert_eq!(files.len(), 3, "{:?}", files.keys());
}

#[test]
fn the_second_of_two_changes_is_refused() {
    let (copy, plant) = bench();
    let first = change(&plant, "decision.slow_repeats", json!(4));
    let second = change(&plant, "part.pin_length_mm", json!(3.6));
    revise(&plant, &first).unwrap();
    let before = files(copy.0.path());
    let refused = revise(&plant, &second).unwrap_err();
    assert!(
        matches!(refused, ConfigError::NotNewest { newest: 2, .. }),
        "{refused}"
    );
    assert_eq!(files(copy.0.path()), before);
}

#[test]
fn a_refused_revision_names_its_key_and_changes_nothing() {
    let (copy, plant) = bench();
    let before = files(copy.0.path());
    let high = "limits.operate_voltage_v.high";
    let coil = "limits.coil_resistance_ohm.low";
    for (path, value, key) in [
        (high, json!(1000.5), high),
        (high, json!("9 V"), high),
        (high, json!(true), high),
        (coil, json!(441.0), coil),
        ("part.body_mm", json!([22.5, -1.0, 16.5]), "part.body_mm.1"),
        ("part.body_mm", json!([22.5]), "part.body_mm"),
        ("part.nominal_v", json!(null), "part.nominal_v"),
        ("decision.slow_repeats", json!(2.5), "decision.slow_repeats"),
        ("decision.rule", json!("lenient"), "decision.rule"),
        ("name", json!("other"), "name"),
        ("title_zh", json!("  "), "title_zh"),
        ("test.prebias_v", json!(8.0), "test.prebias_v"),
        // The plant, not the file, refuses this limit: its modules measure so coarsely that the guard bands leave no
        // value that passes.
        (coil, json!(439.9), "limits.coil_resistance_ohm"),
    ] {
        let refused = revise(&plant, &change(&plant, path, value)).unwrap_err();
        assert_eq!(refused.key().as_deref(), Some(key), "{refused}");
    }
    assert_eq!(files(copy.0.path()), before);
}

#[test]
fn a_demand_from_outside_comes_and_goes() {
    let dir = tempfile::tempdir().unwrap();
    let rig = dir.path().join("rig");
    crate::init(&rig, "ssr").unwrap();
    let plant = Plant::load(&rig.as_path().into()).unwrap();
    let name = "ssr-dc-60v-3a";
    let revised = |value| {
        let change = Change {
            name: name.into(),
            from: revision(&plant.folder, name, None).unwrap().hash,
            ..change_of("external.r_iso_ohm.low", value)
        };
        revise(&plant, &change).unwrap();
        let recipe = load_recipe(&plant.folder, name).unwrap();
        let text = recipe.source_text.clone();
        (recipe.external.demanded().count(), text)
    };
    let (demanded, text) = revised(json!(1e9));
    assert!(demanded == 1 && text.contains("r_iso_ohm"), "{text}");
    let (demanded, text) = revised(json!(null));
    assert!(demanded == 0 && !text.contains("r_iso_ohm"), "{text}");
}

#[test]
fn a_change_that_changes_nothing_is_refused() {
    let (copy, plant) = bench();
    let before = files(copy.0.path());
    let same = change(&plant, "limits.operate_voltage_v.high", json!(9));
    let refused = revise(&plant, &same).unwrap_err();
    assert!(
        matches!(refused, ConfigError::NothingChanged { .. }),
        "{refused}"
    );
    assert_eq!(files(copy.0.path()), before);
}

#[test]
fn a_name_that_climbs_is_no_recipe() {
    let (copy, plant) = bench();
    let before = files(copy.0.path());
    for name in [
        "../rig",
        "revisions/jzc-22f-012/1",
        "",
        ".",
        "..",
        "jzc-22f-012\0",
        "/etc/passwd",
    ] {
        let mut wanted = change(&plant, "decision.slow_repeats", json!(4));
        wanted.name = name.into();
        let refused = revise(&plant, &wanted).unwrap_err();
        assert!(
            matches!(refused, ConfigError::UnknownRecipe { .. }),
            "{refused}"
        );
        assert!(revision(&copy.0.path().into(), name, Some(1)).is_err());
    }
    assert_eq!(files(copy.0.path()), before);
}

#[test]
fn an_interrupted_revision_repeats_under_its_number() {
    let (copy, plant) = bench();
    let folder = copy.0.path().join("recipes/revisions/jzc-22f-012");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::copy(
        copy.0.path().join("recipes/jzc-22f-012.toml"),
        folder.join("1.toml"),
    )
    .unwrap();
    std::fs::write(folder.join("1.toml.new"), "half a te").unwrap();
    assert_eq!(
        revision(&copy.0.path().into(), NAME, None).unwrap().number,
        1
    );
    let wanted = change(&plant, "decision.slow_repeats", json!(4));
    assert_eq!(revise(&plant, &wanted).unwrap().number, 2);
    assert_eq!(
        revision(&copy.0.path().into(), NAME, Some(1)).unwrap().hash,
        wanted.from
    );
}

#[test]
fn an_unknown_revision_is_refused_with_the_newest() {
    let (copy, _) = bench();
    for number in [0, 2, u32::MAX] {
        let refused = revision(&copy.0.path().into(), NAME, Some(number)).unwrap_err();
        assert!(
            refused.to_string().ends_with("expected 1 to 1"),
            "{refused}"
        );
    }
}

#[test]
fn a_new_recipe_differs_in_name_and_given_values() {
    let (copy, plant) = bench();
    let old = files(copy.0.path());
    let mut wanted = change(&plant, "limits.operate_voltage_v.high", json!(8.7));
    wanted.save_as = Some("customer-a".into());
    let saved = revise(&plant, &wanted).unwrap();
    assert_eq!((saved.name.as_str(), saved.number), ("customer-a", 1));
    let lines: Vec<String> = saved.changes.iter().map(ToString::to_string).collect();
    let expected = [
        "name: jzc-22f-012 -> customer-a",
        "limits.operate_voltage_v.high: 9.0 V -> 8.7 V",
    ];
    assert_eq!(lines, expected);
    assert_eq!(wanted.audit(Some(&saved))["order"], "new_recipe");
    let new = load_recipe(&copy.0.path().into(), "customer-a").unwrap();
    assert_eq!(new.hash, saved.hash);
    let now = files(copy.0.path());
    assert_eq!(now.len(), old.len() + 1);
    assert!(
        old.iter()
            .all(|it| now.contains_key(it.0) && now[it.0] == *it.1)
    );
}

#[test]
fn a_new_recipe_needs_a_free_usable_name() {
    let (copy, plant) = bench();
    let before = files(copy.0.path());
    let long = "x".repeat(61);
    for name in [
        "",
        " ",
        "../rig",
        "a/b",
        ".hidden",
        "-a",
        "a b",
        "a\0",
        &long,
        NAME,
        "JZC-22F-012",
    ] {
        let mut wanted = change(&plant, "decision.slow_repeats", json!(4));
        wanted.save_as = Some(name.into());
        let refused = revise(&plant, &wanted).unwrap_err();
        let taken = name.eq_ignore_ascii_case(NAME);
        assert_eq!(
            matches!(refused, ConfigError::RecipeTaken { .. }),
            taken,
            "{refused}"
        );
        assert_eq!(
            matches!(refused, ConfigError::RecipeName { .. }),
            !taken,
            "{refused}"
        );
    }
    assert_eq!(files(copy.0.path()), before);
}

#[test]
fn approval_is_a_key_of_the_rig_file() {
    for (text, expected) in [
        ("", Approval::None),
        ("[recipes]\n", Approval::None),
        (
            "[recipes]\napproval = \"second_person\"\n",
            Approval::SecondPerson,
        ),
    ] {
        let copy = Copy::with("rig.toml", |rig| format!("{rig}\n{text}"));
        assert_eq!(approval(&copy.0.path().into()).unwrap(), expected);
    }
    let copy = Copy::with("rig.toml", |rig| {
        format!("{rig}\n[recipes]\napproval = \"always\"\n")
    });
    let refused = Plant::load(&copy.0.path().into()).unwrap_err();
    assert!(
        refused
            .to_string()
            .contains("\"none\" or \"second_person\""),
        "{refused}"
    );
}
