//! Whole lots on the simulated rig in virtual time, compared with the truth of its world.

use crate::program::{Said, Workshop, objects};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::OnceLock;

const PARTS: u64 = 12;

/// A finished lot.
struct Lot {
    workshop: Workshop,
    said: Said,
    parts: Vec<Value>,
    summary: Value,
    truth: Vec<Value>,
}

fn run(name: &str, recipe: &str, count: u64, more: &str) -> Lot {
    run_in(Workshop::new(name), recipe, count, more)
}

fn run_in(workshop: Workshop, recipe: &str, count: u64, more: &str) -> Lot {
    let line = format!(
        "run --sim --pace virtual --lot A --recipe {recipe} --count {count} --truth t.jsonl --json {more}"
    );
    let said = workshop.run(&line).with_status(0);
    let mut parts = said.objects();
    let summary = parts.pop().unwrap();
    let truth = objects(&workshop.read("t.jsonl"));
    Lot {
        workshop,
        said,
        parts,
        summary,
        truth,
    }
}

/// Returns twelve parts of the default recipe; all tests share one run.
fn twelve() -> &'static Lot {
    static LOT: OnceLock<Lot> = OnceLock::new();
    LOT.get_or_init(|| run("twelve", "jzc-22f-012", PARTS, "--seed 1"))
}

/// Returns a lot in which three parts in four are defective, with every kind of defect.
fn spoiled() -> &'static Lot {
    static LOT: OnceLock<Lot> = OnceLock::new();
    LOT.get_or_init(|| {
        let workshop = Workshop::new("spoiled");
        workshop.change("config/sim.toml", "rate_pct = 4.0", "rate_pct = 75.0");
        run_in(workshop, "jzc-22f-012", 48, "--seed 3")
    })
}

fn text<'a>(object: &'a Value, key: &str) -> &'a str {
    object[key].as_str().unwrap_or_default()
}

#[test]
fn every_part_is_printed_in_order_with_a_summary() {
    let lot = twelve();
    let seqs: Vec<u64> = lot
        .parts
        .iter()
        .filter_map(|part| part["seq"].as_u64())
        .collect();
    assert_eq!(seqs, (1..=PARTS).collect::<Vec<u64>>(), "{}", lot.said);
    assert!(
        lot.parts
            .iter()
            .all(|part| text(part, "type") == "part" && text(part, "lot") == "A")
    );
    let summary = &lot.summary;
    assert_eq!(
        (text(summary, "type"), summary["parts"].as_u64()),
        ("summary", Some(PARTS))
    );
    let judged: u64 = ["pass", "fail", "void"]
        .iter()
        .filter_map(|verdict| summary[*verdict].as_u64())
        .sum();
    let binned: u64 = summary["bins"]
        .as_object()
        .unwrap()
        .values()
        .filter_map(Value::as_u64)
        .sum();
    assert_eq!(
        (judged, binned, summary["alarms"].as_u64()),
        (PARTS, PARTS, Some(0))
    );
}

#[test]
fn a_passed_part_has_nine_values_with_uncertainty() {
    for part in twelve()
        .parts
        .iter()
        .filter(|part| text(part, "verdict") == "pass")
    {
        let (values, uncertainty) = (
            part["values"].as_object().unwrap(),
            part["uncertainty"].as_object().unwrap(),
        );
        assert_eq!((values.len(), uncertainty.len()), (9, 9), "{part}");
        assert!(values.keys().eq(uncertainty.keys()));
        assert!(
            uncertainty
                .values()
                .all(|u| u.as_f64().is_some_and(|u| u > 0.0)),
            "{part}"
        );
    }
}

#[test]
fn values_of_good_parts_err_below_three_uncertainties() {
    let lot = twelve();
    for (part, truth) in lot
        .parts
        .iter()
        .zip(&lot.truth)
        .filter(|(_, truth)| truth["defect"].is_null())
    {
        for (key, value) in part["values"].as_object().unwrap() {
            let off = (value.as_f64().unwrap() - truth[key].as_f64().unwrap()).abs();
            let stated = part["uncertainty"][key].as_f64().unwrap();
            assert!(
                off <= 3.0 * stated,
                "part {} {key}: off by {off}, stated {stated}",
                part["seq"]
            );
        }
    }
}

#[test]
fn every_part_lies_in_the_bin_of_its_row() {
    for lot in [twelve(), spoiled()] {
        assert_eq!(lot.truth.len(), lot.parts.len());
        for (part, truth) in lot.parts.iter().zip(&lot.truth) {
            assert_eq!(part["seq"], truth["seq"]);
            assert_eq!(
                text(part, "bin"),
                text(truth, "landed_in"),
                "part {}",
                part["seq"]
            );
        }
    }
}

#[test]
fn no_defective_part_is_passed() {
    let lot = spoiled();
    let defective = lot
        .truth
        .iter()
        .filter(|truth| !truth["defect"].is_null())
        .count();
    assert!(
        defective >= 24,
        "only {defective} defective parts in the lot"
    );
    for (part, truth) in lot.parts.iter().zip(&lot.truth) {
        let passed_bad = !truth["defect"].is_null() && text(part, "bin") == "pass";
        assert!(
            !passed_bad,
            "part {} with {} was passed",
            part["seq"], truth["defect"]
        );
    }
}

/// Defects with their bins. A part that cannot be measured goes to retest.
const BIN_OF_DEFECT: &[(&str, &str)] = &[
    ("open", "coil"),
    ("shorted", "coil"),
    ("wrong", "coil"),
    ("weak", "voltage"),
    ("stiff", "voltage"),
    ("slow", "time"),
    ("bouncing", "time"),
    ("stuck", "contact"),
    ("high", "contact"),
    ("unstable", "contact"),
    ("turned", "retest"),
    ("missing", "retest"),
];

/// Number of defects of the simulated rig; the entry `stuck` of [`BIN_OF_DEFECT`] covers NC and NO.
const KINDS_OF_DEFECT: usize = 13;

#[test]
fn every_defect_goes_to_the_bin_of_its_cause() {
    let lot = spoiled();
    let kinds: BTreeSet<&str> = lot
        .truth
        .iter()
        .filter_map(|truth| truth["defect"].as_str())
        .collect();
    assert_eq!(kinds.len(), KINDS_OF_DEFECT, "{kinds:?}");
    for (part, truth) in lot.parts.iter().zip(&lot.truth) {
        let Some(defect) = truth["defect"].as_str() else {
            continue;
        };
        let known = BIN_OF_DEFECT
            .iter()
            .find(|(start, _)| defect.starts_with(start));
        let (_, bin) = known.unwrap_or_else(|| panic!("no bin for the defect {defect}"));
        assert_eq!(
            text(part, "bin"),
            *bin,
            "part {} with {defect}: {}",
            part["seq"],
            part["reasons"]
        );
    }
}

#[test]
fn a_part_that_does_not_pass_has_reasons() {
    for part in spoiled()
        .parts
        .iter()
        .filter(|part| text(part, "verdict") != "pass")
    {
        assert!(
            part["reasons"]
                .as_array()
                .is_some_and(|reasons| !reasons.is_empty()),
            "{part}"
        );
    }
}

#[test]
fn every_part_has_rows_down_to_raw_replies() {
    let workshop = &twelve().workshop;
    assert_eq!(
        workshop.count("SELECT count(*) FROM part WHERE kind = 'lot'"),
        PARTS as i64
    );
    assert_eq!(
        workshop.count("SELECT count(*) FROM part WHERE kind = 'lot' AND landed_bin IS NOT bin"),
        0
    );
    let short = "SELECT count(*) FROM part WHERE kind = 'lot' AND verdict = 'pass' AND 9 <>
        (SELECT count(DISTINCT parameter_id) FROM measurement WHERE part_id = part.id AND value IS NOT NULL)";
    assert_eq!(workshop.count(short), 0);
    let bare = "SELECT count(*) FROM measurement AS m WHERE value IS NOT NULL AND NOT EXISTS
        (SELECT 1 FROM sample AS s WHERE s.part_id = m.part_id AND s.parameter_id = m.parameter_id
         AND s.raw <> '' AND s.line <> '' AND s.module <> '')";
    assert_eq!(workshop.count(bare), 0, "a value without its raw reply");
    assert_eq!(
        workshop.count("SELECT count(*) FROM run WHERE closed_at_us IS NULL"),
        0
    );
    assert_eq!(
        workshop.count("SELECT count(*) FROM run WHERE source = 'simulated' AND seed = '1'"),
        1
    );
}

#[test]
fn reference_parts_come_first_and_end_in_retest() {
    let workshop = &twelve().workshop;
    assert!(workshop.count("SELECT count(*) FROM part WHERE kind = 'golden'") > 0);
    // The calibration repeats only the fine ramps of reference parts, three times.
    let other = "SELECT count(*) FROM measurement JOIN parameter ON parameter.id = parameter_id
        JOIN part ON part.id = part_id
        WHERE kind = 'golden' AND attempt <> iif(key LIKE '%voltage_v', 4, 1)";
    assert_eq!(workshop.count(other), 0);
    let long = "SELECT count(*) FROM part WHERE kind = 'golden' AND test_s > 2.0";
    assert_eq!(workshop.count(long), 0);
    assert_eq!(
        workshop.count(
            "SELECT count(*) FROM part WHERE kind = 'golden' AND landed_bin IS NOT 'retest'"
        ),
        0
    );
    let late = "SELECT count(*) FROM part WHERE kind = 'golden' AND
        judged_at_us > (SELECT min(judged_at_us) FROM part WHERE kind = 'lot')";
    assert_eq!(workshop.count(late), 0);
}

#[test]
fn a_lot_writes_no_eeprom_and_touches_nothing() {
    for lot in [twelve(), spoiled()] {
        assert_eq!(lot.summary["eeprom_writes"].as_u64(), Some(0));
        assert!(!lot.said.stderr.contains("touched"), "{}", lot.said.stderr);
    }
}

/// Returns rows, verdicts, values and the fingerprint of the bytes on both lines, without wall times.
fn without_wall_clock(lot: &Lot) -> (Vec<Value>, Value) {
    let mut summary = lot.summary.clone();
    summary.as_object_mut().unwrap().remove("wall_s");
    summary.as_object_mut().unwrap().remove("wall_profile");
    (lot.parts.clone(), summary)
}

#[test]
fn the_same_seed_gives_the_same_rows_and_bytes() {
    let again = run("twelve-again", "jzc-22f-012", PARTS, "--seed 1");
    assert_eq!(without_wall_clock(twelve()), without_wall_clock(&again));
    assert_eq!(twelve().truth, again.truth);
    let bytes = twelve().summary["bytes"].as_object().unwrap();
    assert!(
        ["measure", "motion"]
            .iter()
            .all(|line| bytes.contains_key(*line)),
        "{bytes:?}"
    );
}

#[test]
fn another_seed_is_another_lot() {
    let other = run("another-seed", "jzc-22f-012", 2, "--seed 2");
    assert_ne!(other.parts[0]["values"], twelve().parts[0]["values"]);
}

#[test]
fn the_other_coil_voltages_run_as_well() {
    for recipe in ["jzc-22f-009", "jzc-22f-006"] {
        let lot = run(recipe, recipe, 6, "--seed 1");
        assert_eq!(lot.summary["parts"].as_u64(), Some(6));
        for (part, truth) in lot.parts.iter().zip(&lot.truth) {
            let good = truth["defect"].is_null();
            assert_eq!(
                good,
                text(part, "bin") == "pass",
                "{recipe} part {}: {}",
                part["seq"],
                part["reasons"]
            );
            assert_eq!(text(part, "bin"), text(truth, "landed_in"));
        }
    }
}

#[test]
fn the_history_lists_the_lot() {
    let workshop = &twelve().workshop;
    let listed = workshop.run("history list").with_status(0);
    assert!(listed.stdout.contains("jzc-22f-012"), "{listed}");
    let queried = workshop
        .run("history query --lot A --format json")
        .with_status(0);
    let lot_rows = queried
        .objects()
        .iter()
        .filter(|row| text(row, "kind") == "lot")
        .count();
    assert_eq!(lot_rows as u64, PARTS, "{queried}");
    let none = workshop
        .run("history query --lot A --bin pass --verdict fail --format json")
        .with_status(0);
    assert_eq!(none.stdout, "");
    workshop.run("history check").with_status(0);
}

#[test]
fn conditioning_operates_the_relay_by_the_recipe() {
    let operations = |name: &str, count: u64| {
        let workshop = Workshop::new(name);
        workshop.change(
            "config/recipes/jzc-22f-012.toml",
            "conditioning_operations = 0",
            &format!("conditioning_operations = {count}"),
        );
        let lot = run_in(workshop, "jzc-22f-012", 2, "--seed 1");
        assert!(lot.parts.iter().all(|part| text(part, "bin") == "pass"));
        let operations = lot.truth.iter().map(|it| it["operations"].as_u64());
        operations.collect::<Option<Vec<u64>>>().unwrap()
    };
    let without = operations("unconditioned", 0);
    let with = operations("conditioned", 3);
    let added: Vec<u64> = with.iter().zip(&without).map(|(a, b)| a - b).collect();
    assert_eq!(added, [3, 3], "{with:?} after {without:?}");
}

#[test]
fn a_rig_without_references_sorts_resistors() {
    let workshop = Workshop::new("unreferenced");
    let rig = workshop.read("config/rig.toml");
    let (before, rest) = rig.split_once("[reference]\n").unwrap();
    let (_, after) = rest.split_once("\n[accuracy]\n").unwrap();
    let bare: String = format!("{before}[accuracy]\n{after}")
        .lines()
        .filter(|line| !line.starts_with("golden = "))
        .map(|line| format!("{line}\n"))
        .collect();
    workshop.write("config/rig.toml", &bare);
    std::fs::remove_file(workshop.folder.join("config/golden.toml")).unwrap();
    let lot = run_in(workshop, "resistor-390", 3, "--seed 1");
    assert_eq!(lot.parts.len(), 3);
    let refused = lot.workshop.run("config check").with_status(2);
    assert!(refused.stderr.contains("[reference]"), "{refused}");
}

#[test]
fn a_diode_recipe_times_the_release_into_the_diode() {
    let workshop = Workshop::new("lots_diode");
    let recipe = "config/recipes/jzc-22f-012.toml";
    workshop.change(recipe, "clamp = \"zener\"", "clamp = \"diode\"");
    workshop.change(
        recipe,
        "release_time_ms = { high = 5.0 }",
        "release_time_ms = { high = 25.0 }",
    );
    let lot = run_in(workshop, "jzc-22f-012", 4, "");
    let sound = lot.parts.iter().zip(&lot.truth);
    for (part, truth) in sound.filter(|(_, truth)| truth["defect"].is_null()) {
        assert_eq!(part["verdict"], "pass", "{part}");
        let found_ms = part["values"]["release_time_ms"].as_f64().unwrap();
        let off_ms = (found_ms - truth["release_time_ms"].as_f64().unwrap()).abs();
        assert!(found_ms > 8.0 && off_ms < 0.05, "{part} {truth}");
    }
}

#[test]
fn a_rig_noisier_than_promised_gets_a_wider_uncertainty() {
    let workshop = Workshop::new("lots_noisy");
    workshop.change(
        "config/sim.toml",
        "ai_noise_lsb = 0.5 ",
        "ai_noise_lsb = 1.0 ",
    );
    let lot = run_in(workshop, "jzc-22f-012", 3, "--seed 1");
    let broken = &lot.summary["broken_promises"][0];
    assert_eq!(text(broken, "promise"), "ai_noise", "{}", lot.summary);
    assert_eq!(broken["after_parts"], 0);
    let seen_lsb = broken["seen"].as_f64().unwrap();
    assert!((0.9..1.1).contains(&seen_lsb), "{broken}");
    let alarms = lot.workshop.texts("SELECT code FROM alarm");
    assert_eq!(alarms, ["ai_noise_promise_broken"]);
    let u = |lot: &Lot| lot.parts[0]["uncertainty"]["contact_resistance_no_mohm"].as_f64();
    assert!(u(&lot) > u(twelve()).map(|it| 1.5 * it), "{:?}", u(&lot));
}
