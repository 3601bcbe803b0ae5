//! Tests of the lot of AC parts: good parts lie inside the limits of their class, and each defect has its own
//! signature.

use super::*;
use rigsim::scpi::relay::Kind;
use rigsim::world::ssr::Defect;
use serde_json::Value;

/// Limits of the class: key, least, most.
const LIMITS: [(&str, f64, f64); 14] = [
    ("v_on_v", 0.0, 3.5),
    ("v_off_v", 1.0, f64::INFINITY),
    ("i_in_ma", 2.5, 5.5),
    ("i_rev_ua", 0.0, 10.0),
    ("t_on_us", -500.0, 100.0),
    ("t_off_us", -1.0, 500.0),
    ("v_drop_v", 0.0, 1.6),
    ("v_zc_v", 0.0, 20.0),
    ("v_retrig_v", 0.0, 10.0),
    ("i_leak_resistive_ua", 0.0, 50.0),
    ("i_leak_capacitive_ua", 500.0, 3_000.0),
    ("dc_offset_mv", -40.0, 40.0),
    ("halfwave_pct", 0.0, 2.0),
    ("drift_mv", -4.0, 4.0),
];

fn outside(truth: &Value) -> Vec<&'static str> {
    let out = LIMITS.iter().filter(|(key, least, most)| {
        let figure = truth[*key].as_f64();
        figure.is_some_and(|it| it < *least || it > *most)
    });
    out.map(|(key, ..)| *key).collect()
}

/// Returns the characteristics that a defect moves out of the limits of its class.
fn expected(defect: &str, output: &str) -> &'static [&'static str] {
    match defect {
        "aged_led" => &["v_on_v"],
        "wrong_input_current" | "open_led" | "shorted_led" => &["i_in_ma"],
        "slow_turn_on" => &["t_on_us"],
        "slow_turn_off" => &["t_off_us"],
        "thermal" => &["drift_mv"],
        "high_drop" => &["v_drop_v"],
        "leaky_junction" => &["i_leak_resistive_ua"],
        "open_snubber" | "wrong_snubber" => &["i_leak_capacitive_ua"],
        "no_zero_cross" => &["t_on_us", "v_zc_v"],
        "half_wave" => &["dc_offset_mv", "halfwave_pct"],
        "half_short" | "shorted_output" | "stuck_on" | "missing_pin" | "turned" => &[],
        other => panic!("{other} of {output}"),
    }
}

#[test]
fn each_defect_fails_the_limits_of_its_bin_alone() {
    for (output, kind) in [
        ("ac_zero_cross", Kind::AcZeroCross),
        ("ac_random", Kind::AcRandom),
    ] {
        let mut seen = std::collections::BTreeSet::new();
        let mut hand = rig(output, EUROPE, 2, "[ssr_ac.defects]\nrate_pct = 60.0\n");
        for _ in 0..60 {
            hand.feed();
            hand.sort(2);
        }
        assert_eq!(hand.rig.crashes(), Vec::<String>::new());
        for truth in hand.rig.truth() {
            let Some(defect) = truth["defect"].as_str() else {
                assert_eq!(outside(&truth), Vec::<&str>::new(), "{truth}");
                continue;
            };
            seen.insert(defect.to_owned());
            let mut out = outside(&truth);
            // More power in the junction also makes more drift; weak light also takes longer.
            out.retain(|key| defect != "high_drop" || *key != "drift_mv");
            out.retain(|key| defect != "aged_led" || *key != "t_on_us");
            assert_eq!(out, expected(defect, output), "{truth}");
        }
        assert_eq!(seen.len(), Defect::of_output(kind).len(), "{seen:?}");
    }
}

/// Feeds parts until one has this defect, and leaves it in the nest.
fn with(defect: &str) -> Hand {
    let text = QUIET.replace("rate_pct = 0.0", "rate_pct = 100.0");
    let mut hand = rig("ac_zero_cross", EUROPE, 5, &text);
    loop {
        hand.feed();
        match hand.truth("defect") == defect {
            true => return hand,
            false => hand.sort(2),
        }
    }
}

#[test]
fn a_half_short_shows_in_one_polarity_of_the_short_check() {
    for (defect, seen) in [("shorted_output", 2), ("half_short", 1), ("half_wave", 0)] {
        let mut hand = with(defect);
        hand.set("short_check", true);
        let count = [false, true].into_iter().filter(|reversed| {
            hand.set("output_polarity", *reversed);
            hand.is_on("short_seen")
        });
        assert_eq!(count.count(), seen, "{defect}");
    }
}

/// Returns the mean voltage over the output and the mean current on the line of the part in the nest, dark or lit.
fn means(hand: &mut Hand, lit: bool) -> [f64; 2] {
    hand.supply(230.0, 50.0, 2.0);
    hand.control(if lit { 5.0 } else { 0.0 });
    hand.set("bleed_open", true);
    hand.set("line_contactor", true);
    hand.wait(60.0);
    hand.scales([1.0, 1.0, 3.0, 0.05], (0.2, 20_000));
    let [_, volts, _, amps] = hand.record(20_000);
    [volts, amps].map(|curve| curve.iter().sum::<f64>() / curve.len() as f64)
}

#[test]
fn half_of_an_output_shows_as_direct_voltage() {
    // Expects a half-wave mean: peak over pi, 103 V.
    let [volts, amps] = means(&mut with("half_short"), false);
    assert!((volts.abs() - 103.0).abs() < 2.0, "{volts}");
    assert!((amps.abs() - 0.045).abs() < 1e-3, "{amps}");
    let [volts, _] = means(&mut with("half_wave"), true);
    assert!((volts.abs() - 103.0).abs() < 2.0, "{volts}");
    let [volts, _] = means(&mut with("thermal"), true);
    assert!(volts.abs() < 0.2, "{volts}");
}

#[test]
fn a_stuck_part_goes_on_after_its_pulse() {
    for (defect, stays) in [("stuck_on", true), ("leaky_junction", false)] {
        let mut hand = with(defect);
        hand.supply(230.0, 50.0, 2.0);
        hand.set("bleed_open", true);
        hand.set("line_contactor", true);
        hand.wait(60.0);
        hand.control(5.0);
        hand.control(0.0);
        hand.wait(200.0);
        let amps = hand.value(AC, "MEAS:CURR:AC?");
        assert_eq!(amps > 0.05, stays, "{defect}: {amps}");
    }
}
