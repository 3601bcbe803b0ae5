//! The lot: good parts lie well inside the limits, and each defect shows its own signature.

use std::collections::BTreeMap;

use rigsim::scpi::relay::Kind;
use rigsim::world::ssr::Defect;
use serde_json::Value;

use super::figures::{GOOD, capture};
use super::hand::Hand;

/// Limits of the recipe: key, least, most.
const LIMITS: [(&str, f64, f64); 11] = [
    ("v_on_v", 0.0, 3.5),
    ("v_off_v", 1.0, f64::INFINITY),
    ("i_in_ma", 2.5, 5.5),
    ("i_rev_ua", 0.0, 10.0),
    ("t_on_us", 0.0, 1_000.0),
    ("t_off_us", 0.0, 1_000.0),
    ("v_drop_v", 0.0, 0.25),
    ("r_on_mohm", 0.0, 83.0),
    ("i_leak_ua", 0.0, 10.0),
    ("i_leak_hot_ua", 0.0, 50.0),
    ("drift_mv", 0.0, 0.18),
];

/// Returns the truth of one lot of parts under a seed, by feeding each into the nest.
fn lot(seed: u64, parts: usize) -> Vec<Value> {
    let world = "[ssr.defects]\nrate_pct = 52.0\n";
    let mut hand = Hand::in_world(seed, world);
    for _ in 0..parts {
        hand.feed();
        hand.sort(2);
    }
    assert_eq!(hand.rig.crashes(), Vec::<String>::new());
    hand.rig.truth()
}

fn outside(truth: &Value) -> Vec<&'static str> {
    let out = LIMITS.iter().filter(|(key, least, most)| {
        truth[*key]
            .as_f64()
            .is_some_and(|it| it < *least || it > *most)
    });
    out.map(|(key, ..)| *key).collect()
}

#[test]
fn each_defect_fails_the_limits_of_its_bin_alone() {
    let mut seen: BTreeMap<String, u32> = BTreeMap::new();
    for seed in 1..=3 {
        for truth in lot(seed, 25) {
            let Some(defect) = truth["defect"].as_str() else {
                assert_eq!(outside(&truth), Vec::<&str>::new(), "{truth}");
                assert!(
                    truth["drift_mv"].as_f64().expect("a drift") < 0.12,
                    "{truth}"
                );
                continue;
            };
            *seen.entry(defect.to_owned()).or_default() += 1;
            let expected: &[&str] = match defect {
                "aged_led" => &["v_on_v"],
                "wrong_input_current" | "open_led" | "shorted_led" => &["i_in_ma"],
                "slow_turn_on" => &["t_on_us"],
                "slow_turn_off" => &["t_off_us"],
                "thermal" => &["drift_mv"],
                "high_drop" => &["v_drop_v", "r_on_mohm", "drift_mv"],
                "leaky_junction" => &["i_leak_ua", "i_leak_hot_ua"],
                "shorted_output" => &["v_drop_v", "r_on_mohm"],
                "stuck_on" | "missing_pin" | "turned" => &[],
                other => panic!("{other}"),
            };
            assert_eq!(outside(&truth), expected, "{truth}");
            assert_eq!(truth["landed_in"], "pass", "{truth}");
        }
    }
    assert_eq!(seen.len(), Defect::of_output(Kind::Dc).len(), "{seen:?}");
}

/// Feeds parts until one has this defect, and leaves it in the nest.
fn with(defect: &str) -> Hand {
    let world = GOOD.replace("rate_pct = 0.0", "rate_pct = 100.0");
    let mut hand = Hand::in_world(5, &world);
    loop {
        hand.feed();
        match hand.truth("defect") == defect {
            true => return hand,
            false => hand.sort(2),
        }
    }
}

#[test]
fn defects_of_the_input_show_in_its_current() {
    for (defect, least_a, most_a) in [
        ("open_led", -1e-9, 1e-9),
        ("shorted_led", 0.049, 0.051),
        ("wrong_input_current", 6.4e-3, 9.1e-3),
        ("aged_led", 3.5e-3, 4.2e-3),
    ] {
        let mut hand = with(defect);
        hand.control(5.0);
        let amps = hand.value("smu_in", ":READ?");
        assert!((least_a..most_a).contains(&amps), "{defect}: {amps}");
    }
}

#[test]
fn a_short_check_sees_the_shorted_output_alone() {
    for (defect, seen) in [("shorted_output", true), ("leaky_junction", false)] {
        let mut hand = with(defect);
        hand.set("short_check", true);
        assert_eq!(hand.is_on("short_seen"), seen, "{defect}");
        hand.set("output_polarity", true);
        assert_eq!(hand.is_on("short_seen"), seen, "{defect}");
    }
}

#[test]
fn a_stuck_part_conducts_after_its_first_pulse() {
    let mut hand = with("stuck_on");
    hand.load();
    let before_a = hand.value("smu_out", ":READ?");
    hand.control(5.0);
    hand.control(0.0);
    hand.wait(2_000.0);
    let after_a = hand.value("smu_out", ":READ?");
    assert!(before_a < 1e-6 && after_a > 7.9e-3, "{before_a} {after_a}");
}

#[test]
fn slow_parts_switch_late_in_the_capture() {
    for (defect, key) in [("slow_turn_on", "t_on_us"), ("slow_turn_off", "t_off_us")] {
        let mut hand = with(defect);
        hand.load();
        let ([_, _, output], trigger) = capture(&mut hand);
        let at = |place: usize| 8.0 - output[place];
        let (edge, level_v) = match key {
            "t_on_us" => (trigger, 0.9 * 8.0),
            _ => (trigger + 30_000, 0.1 * 8.0),
        };
        let after_us = (0..10_000)
            .find(|us| (at(edge + us) > level_v) == (key == "t_on_us"))
            .expect("a crossing");
        let true_us = hand.figure(key);
        assert!(
            (after_us as f64 / true_us - 1.0).abs() < 0.12,
            "{after_us} {true_us}"
        );
    }
}

#[test]
fn a_hot_or_high_drop_shows_at_one_ampere() {
    for (defect, least_v, most_v) in [("thermal", 0.04, 0.051), ("high_drop", 0.099, 0.23)] {
        let mut hand = with(defect);
        hand.control(5.0);
        hand.set("bleed_open", true);
        hand.set("smu_to_output", true);
        hand.source_amps(1.0, 0.1);
        let volts = hand.value("smu_out", ":READ?");
        assert!((least_v..most_v).contains(&volts), "{defect}: {volts}");
    }
}

#[test]
fn missing_and_turned_pins_open_kelvin_bits() {
    let points = [
        "kelvin_in_plus",
        "kelvin_in_minus",
        "kelvin_out_1",
        "kelvin_out_2",
    ];
    for (defect, open) in [("missing_pin", 1), ("turned", 2), ("leaky_junction", 0)] {
        let mut hand = with(defect);
        hand.set("kelvin_test", true);
        let off = points.iter().filter(|point| !hand.is_on(point)).count();
        assert_eq!(off, open, "{defect}");
        hand.set("kelvin_test", false);
        assert!(!points.iter().any(|point| hand.is_on(point)), "{defect}");
    }
}

#[test]
fn a_dirty_pin_opens_its_circuit() {
    let mut hand = Hand::of(&super::hand::options(1, &["probe_dirty=1"]));
    hand.feed();
    hand.set("kelvin_test", true);
    assert!(hand.is_on("kelvin_out_1") && !hand.is_on("kelvin_out_2"));
    hand.control(5.0);
    hand.load();
    let amps = hand.value("smu_out", ":READ?");
    assert!(amps.abs() < 1e-5, "{amps}");
}

#[test]
fn film_on_the_probes_opens_kelvin_bits() {
    // 8 ohm at each touch, half of it on each probe of the input.
    let mut hand = Hand::of(&super::hand::options(1, &["probe_film=800"]));
    for touch in 1..=2 {
        hand.feed();
        hand.set("kelvin_test", true);
        assert_eq!(hand.is_on("kelvin_in_plus"), touch == 1, "touch {touch}");
        assert!(hand.is_on("kelvin_out_1"));
        hand.set("kelvin_test", false);
        hand.sort(2);
    }
}
