//! Tests of contactors, interlocks, limits and faults of the output circuit.

use super::*;

fn line() -> Hand {
    let mut hand = rig("ac_zero_cross", EUROPE, 3, QUIET);
    hand.line(EUROPE);
    hand
}

/// Returns the highest voltage at the socket in 200 ms, volts.
fn socket_v(hand: &mut Hand) -> f64 {
    hand.scales([1.0, 1.0, 3.0, 0.05], (0.02, 10_000));
    let [_, volts, _, _] = hand.record(10_000);
    volts.iter().fold(0.0, |most, it| most.max(it.abs()))
}

#[test]
fn contactors_exclude_each_other_until_their_contacts_are_open() {
    let mut hand = line();
    hand.set("line_contactor", false);
    hand.set("loop_contactor", true);
    assert!(!hand.is_on("line_open") && hand.is_on("loop_open"));
    hand.wait(10.0);
    assert!(hand.is_on("line_open") && hand.is_on("loop_open"));
    hand.wait(20.0);
    assert!(hand.is_on("line_open") && !hand.is_on("loop_open"));
}

#[test]
fn the_socket_is_safe_a_half_cycle_after_its_contactor_opens() {
    let mut hand = line();
    assert!(!hand.is_on("output_safe"));
    assert!((socket_v(&mut hand) - 325.0).abs() < 2.0);
    hand.set("clamp_open", true);
    hand.wait(500.0);
    assert!(hand.is_on("jaw_left_closed"), "230 V at the socket");
    hand.set("line_contactor", false);
    hand.set("bleed_open", false);
    hand.wait(40.0);
    assert!(hand.is_on("line_open") && hand.is_on("output_safe"));
    assert!(hand.residual_v().abs() < 1.0);
}

#[test]
fn door_and_probes_open_the_contactor() {
    for end in ["door", "probes"] {
        let mut hand = line();
        match end {
            "door" => hand.rig.inject("door").expect("a fault"),
            _ => hand.set("probe_lift", false),
        }
        hand.set("bleed_open", false);
        hand.wait(40.0);
        assert!(hand.is_on("line_open"), "{end}");
        assert!(hand.residual_v().abs() < 30.0, "{end}");
    }
}

#[test]
fn a_dead_host_leaves_no_line_on_the_socket() {
    for later_ms in [0.0, 3.7, 511.0, 990.0] {
        let mut hand = line();
        hand.set("drive_select", true);
        hand.control(5.0);
        hand.request("board_do", "~**");
        let last_us = hand.t_us;
        hand.wait(later_ms);
        assert!(!hand.is_on("line_open"), "{later_ms}");
        hand.t_us = last_us + 1_012_000;
        assert!(hand.is_on("line_open"), "{later_ms}");
        hand.wait(20.0);
        assert!(hand.is_on("output_safe") && hand.residual_v().abs() < 1.0);
        assert_eq!(hand.ask(AC, ":OUTP?"), "1", "the source itself stays on");
    }
}

#[test]
fn an_overload_trips_the_ac_source() {
    // 230 V on the loop of 4.7 ohm overload the source.
    let mut hand = rig("ac_zero_cross", EUROPE, 3, QUIET);
    hand.feed();
    hand.supply(230.0, 50.0, 2.0);
    hand.set("bleed_open", true);
    hand.control(5.0);
    hand.set("loop_contactor", true);
    hand.wait(60.0);
    assert_eq!(hand.ask(AC, ":OUTP?"), "0");
    assert_eq!(hand.ask(AC, ":STAT:QUES:COND?"), "2");
    let error = hand.ask(AC, ":SYST:ERR?");
    assert!(error.starts_with("-300,"), "{error}");
    hand.tell(AC, "VOLT:AC 24;:CURR:LIM 8;:OUTP ON");
    hand.wait(200.0);
    assert_eq!(hand.ask(AC, ":OUTP?"), "1");
    assert_eq!(hand.ask(AC, ":STAT:QUES:COND?"), "0");
    let amps = hand.value(AC, "MEAS:CURR:AC?");
    assert!((amps - 5.0).abs() < 0.3, "{amps}");
}

#[test]
fn a_source_that_restarts_or_is_local_feeds_no_line() {
    let mut hand = line();
    hand.rig
        .inject("power_cycle=ac_source:1@0..0.2")
        .expect("a fault");
    hand.tell(AC, "FREQ 50");
    hand.wait(100.0);
    assert!(socket_v(&mut hand) < 1.0);
    hand.wait(8_000.0);
    assert_eq!(hand.ask(AC, ":OUTP?"), "0");
    hand.rig
        .inject("local=ac_source:1@0..0.2")
        .expect("a fault");
    hand.tell(AC, ":OUTP ON");
    assert_eq!(hand.ask(AC, ":OUTP?"), "0");
}

#[test]
fn a_welded_contactor_shows_in_its_mirror_contact() {
    let mut hand = line();
    hand.rig.inject("line_contactor_welded").expect("a fault");
    hand.set("line_contactor", false);
    hand.wait(50.0);
    assert!(!hand.is_on("line_open") && !hand.is_on("output_safe"));
    hand.set("loop_contactor", true);
    hand.wait(50.0);
    assert!(hand.is_on("loop_open"), "the other one stays open");
}

#[test]
fn a_broken_coil_closes_no_contactor() {
    for contactor in ["line", "loop"] {
        let mut hand = rig("ac_zero_cross", EUROPE, 3, QUIET);
        hand.feed();
        let fault = format!("{contactor}_contactor_broken");
        hand.rig.inject(&fault).expect("a fault");
        hand.set(&format!("{contactor}_contactor"), true);
        hand.wait(50.0);
        assert!(hand.is_on(&format!("{contactor}_open")));
    }
}

#[test]
fn stuck_mirror_contacts_tell_the_state_of_before() {
    let mut hand = line();
    hand.rig.inject("mirrors_stuck").expect("a fault");
    hand.wait(1.0);
    hand.set("line_contactor", false);
    hand.set("bleed_open", false);
    hand.wait(50.0);
    assert!(!hand.is_on("line_open") && hand.is_on("output_safe"));
}

#[test]
fn a_short_in_the_socket_shows_at_five_volts() {
    let mut hand = rig("ac_zero_cross", EUROPE, 3, QUIET);
    hand.feed();
    hand.set("short_check", true);
    assert!(!hand.is_on("short_seen"));
    hand.rig.inject("socket_short").expect("a fault");
    hand.wait(1.0);
    assert!(hand.is_on("short_seen"));
    hand.set("output_polarity", true);
    assert!(hand.is_on("short_seen"));
}

#[test]
fn a_blown_fuse_of_the_line_spares_the_loop() {
    let mut hand = rig("ac_zero_cross", EUROPE, 3, QUIET);
    hand.rig.inject("line_dead").expect("a fault");
    hand.line(EUROPE);
    assert!(socket_v(&mut hand) < 1.0);
    assert_eq!(hand.ask(AC, ":OUTP?"), "1");
    hand.set("line_contactor", false);
    hand.wait(40.0);
    hand.tell(AC, "VOLT:AC 24;:CURR:LIM 8");
    hand.set("loop_contactor", true);
    hand.control(5.0);
    hand.wait(200.0);
    let amps = hand.value(AC, "MEAS:CURR:AC?");
    assert!((amps - 5.0).abs() < 0.3, "{amps}");
}

#[test]
fn a_blown_fuse_of_the_loop_spares_the_line() {
    let mut hand = rig("ac_zero_cross", EUROPE, 3, QUIET);
    hand.line(EUROPE);
    hand.rig.inject("loop_dead").expect("a fault");
    assert!(socket_v(&mut hand) > 200.0);
    hand.set("line_contactor", false);
    hand.wait(40.0);
    hand.tell(AC, "VOLT:AC 24;:CURR:LIM 8");
    // The first one has ended by now.
    hand.rig.inject("loop_dead").expect("a fault");
    hand.set("loop_contactor", true);
    hand.control(5.0);
    hand.wait(200.0);
    let amps = hand.value(AC, "MEAS:CURR:AC?");
    assert!(amps < 0.02, "{amps}");
}

#[test]
fn equal_seeds_give_equal_bytes() {
    let heard = |seed: u64| {
        let mut hand = rig("ac_zero_cross", EUROPE, seed, "");
        hand.line(EUROPE);
        hand.scales([1.0, 1.0, 3.0, 0.05], (0.1, 10_000));
        hand.pulsed((0.05, 0.03, 2), 10_000);
        hand.heard
    };
    assert!(heard(1) == heard(1));
    assert!(heard(1) != heard(2));
}
