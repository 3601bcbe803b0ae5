//! Interlocks of the board: what no program can pass, and what a dead client leaves behind.

use super::hand::Hand;

/// Puts 60 V on the output of the part in the nest.
fn at_60_v(hand: &mut Hand) {
    hand.feed();
    hand.set("bleed_open", true);
    hand.source("smu_out", 60.0, 1e-3, 1e-4);
    hand.set("smu_to_output", true);
    hand.wait(20.0);
    assert!(!hand.is_on("output_safe"));
}

#[test]
fn nothing_connects_without_the_probe_chain() {
    let mut hand = Hand::new(1);
    hand.set("bleed_open", true);
    hand.source("smu_out", 60.0, 1e-3, 1e-4);
    hand.set("smu_to_output", true);
    hand.set("short_check", true);
    hand.set("line_contactor", true);
    hand.wait(100.0);
    assert!(hand.is_on("output_safe") && hand.is_on("line_open"));
    assert!(hand.residual_v().abs() < 1.0);
    hand.set("short_check", false);
    hand.set("line_contactor", false);
    hand.set("probe_lift", true);
    hand.wait(300.0);
    assert!(!hand.is_on("output_safe"), "{:?}", hand.residual_v());
    let volts = hand.residual_v();
    assert!((volts - 60.0).abs() < 1.5, "{volts}");
    hand.set("line_contactor", true);
    hand.wait(20.0);
    assert!(!hand.is_on("line_open") && hand.is_on("loop_open"));
    hand.set("loop_contactor", true);
    hand.wait(20.0);
    assert!(hand.is_on("line_open") && hand.is_on("loop_open"), "both");
}

#[test]
fn the_jaws_stay_closed_until_the_output_is_safe() {
    let mut hand = Hand::new(1);
    at_60_v(&mut hand);
    hand.set("clamp_open", true);
    hand.wait(500.0);
    assert!(hand.is_on("jaw_left_closed") && hand.is_on("jaw_right_closed"));
    hand.set("smu_to_output", false);
    hand.set("bleed_open", false);
    hand.wait(300.0);
    assert!(hand.is_on("output_safe") && hand.is_on("jaw_left_open"));
}

#[test]
fn the_bleed_discharges_the_socket_in_a_half_cycle() {
    let mut hand = Hand::new(1);
    at_60_v(&mut hand);
    hand.set("smu_to_output", false);
    hand.wait(5.0);
    assert!(!hand.is_on("output_safe"), "nothing discharges it yet");
    hand.set("bleed_open", false);
    assert!(hand.residual_v().abs() < 1.0);
    assert!(hand.is_on("output_safe"));
}

#[test]
fn a_silent_host_leaves_the_output_safe() {
    let mut hand = Hand::new(1);
    at_60_v(&mut hand);
    assert!(!hand.is_on("output_safe"));
    hand.request("board_do", "~**");
    let last_us = hand.t_us;
    hand.wait(990.0);
    assert!(!hand.is_on("output_safe"), "the source still drives");
    hand.t_us = last_us + 1_001_000;
    hand.wait(12.0);
    assert!(hand.is_on("output_safe"));
    let volts = hand.residual_v();
    assert!(volts.abs() < 1.0, "{volts}");
    assert_eq!(
        hand.ask("smu_out", ":OUTP?"),
        "1",
        "the unit itself stays on"
    );
}

#[test]
fn a_part_that_leaves_is_gone_for_the_instruments() {
    let mut hand = Hand::new(1);
    hand.feed();
    hand.control(5.0);
    assert!(hand.value("smu_in", ":READ?") > 2e-3);
    hand.set("probe_lift", false);
    hand.wait(50.0);
    let amps = hand.value("smu_in", ":READ?");
    assert!(amps.abs() < 1e-4, "{amps}");
}
