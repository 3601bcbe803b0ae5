//! Tests of what cuts the heat whatever the program does, and of the state in which a dead host leaves the chamber.

use super::hand::Hand;

/// Returns a chamber after 20 s at full power, with the heater some 60 K above ambient.
fn heating(faults: &[&str]) -> Hand {
    let mut hand = Hand::new(faults);
    hand.start();
    hand.drive(1.0, 0.0);
    hand.wait(20.0);
    hand
}

#[test]
fn the_heater_heats_behind_a_closed_chain_only() {
    let mut hand = heating(&[]);
    let before = hand.heater_c();
    hand.wait(20.0);
    assert!(hand.heater_c() > before + 15.0);
    hand.set(&["fan"], false);
    hand.wait(0.2);
    assert!(!hand.is_on("airflow_ok"));
    let before = hand.heater_c();
    hand.wait(20.0);
    assert!(hand.heater_c() < before + 5.0);
}

#[test]
fn each_fault_of_the_chain_cuts_the_heat() {
    for (fault, signal) in [
        ("door", "door_closed"),
        ("estop", "emergency_stop_ok"),
        ("limiter", "limiter_ok"),
        ("mains_off", "mains_ok"),
    ] {
        let mut hand = heating(&[]);
        assert!(hand.is_on(signal), "{fault}");
        hand.rig.inject(fault).expect(fault);
        hand.wait(0.3);
        assert!(!hand.is_on(signal), "{fault}");
        if fault == "mains_off" {
            hand.wait(5.0);
            let before = hand.heater_c();
            hand.wait(60.0);
            assert!(hand.heater_c() < before, "without fan it cools slowly");
        } else {
            hand.drive(1.0, 0.0);
            assert_cools_while_cut(&mut hand, fault);
        }
    }
}

fn assert_cools_while_cut(hand: &mut Hand, fault: &str) {
    let before = hand.heater_c();
    hand.wait(15.0);
    assert!(hand.heater_c() < before - 3.0, "{fault}");
}

#[test]
fn the_limiter_stays_tripped_until_somebody_resets_it() {
    let mut hand = heating(&["fan_slow=0"]);
    hand.rig.inject("limiter").expect("a fault");
    hand.wait(60.0);
    assert!(!hand.is_on("limiter_ok"));
    hand.rig.inject("limiter_reset").expect("a fault");
    hand.wait(1.0);
    assert!(hand.is_on("limiter_ok"));
}

#[test]
fn the_limiter_ends_what_a_stuck_power_unit_begins() {
    let mut hand = heating(&["ssr_stuck=10"]);
    hand.drive(0.0, 0.0);
    let mut hottest: f64 = 0.0;
    for _ in 0..1200 {
        hand.wait(1.0);
        hottest = hottest.max(hand.heater_c());
    }
    assert!(!hand.is_on("limiter_ok"));
    assert!((225.0..255.0).contains(&hottest), "{hottest}");
    let last = hand.heater_c();
    assert!(last < hottest - 50.0, "{hottest} {last}");
}

#[test]
fn a_dead_host_leaves_a_cooling_chamber() {
    let mut hand = heating(&[]);
    // The watchdogs expire 3 s after the last host OK.
    hand.t_us += 4_000_000;
    hand.rig.advance(hand.t_us);
    assert_eq!(hand.request("#230+05.000"), "!", "outputs locked");
    assert_eq!(hand.request("@2703"), "!");
    assert!(!hand.is_on("airflow_ok") && hand.is_on("door_locked"));
    let before = hand.heater_c();
    hand.wait(20.0);
    assert!(hand.heater_c() < before);
}

#[test]
fn the_vent_cools_and_sticks_where_it_is() {
    let cooled_k = |faults: &[&str]| {
        let mut hand = Hand::new(&[]);
        hand.start();
        hand.drive(0.4, 0.0);
        hand.wait(400.0);
        for fault in faults {
            hand.rig.inject(fault).expect("a fault");
        }
        hand.wait(0.2);
        hand.drive(0.0, 1.0);
        let before = hand.temperatures()[0];
        hand.wait(240.0);
        before - hand.temperatures()[0]
    };
    let (free, stuck) = (cooled_k(&[]), cooled_k(&["vent_stuck"]));
    assert!(free > stuck + 4.0, "{free} {stuck}");
}
