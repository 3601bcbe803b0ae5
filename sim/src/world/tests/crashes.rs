//! Tests of strokes that make bodies crash, and of strokes that only seem to.

use super::hand::{Hand, options};
use crate::truth::WorldRecord;

/// Asserts that these two bodies have crashed.
fn assert_touched(hand: &Hand, one: &str, other: &str) {
    let crashes = hand.world.crashes();
    let of = |crash: &String| crash.contains(one) && crash.contains(other);
    assert!(crashes.iter().any(of), "{one} and {other}: {crashes:?}");
}

fn assert_untouched(hand: &Hand) {
    assert_eq!(hand.world.crashes(), Vec::<String>::new());
}

#[test]
fn the_pusher_crashes_into_raised_probes() {
    let mut hand = Hand::new(options(false));
    hand.set("probe_lift", true);
    hand.wait(300.0);
    hand.set("pusher_extend", true);
    hand.wait(500.0);
    assert_touched(&hand, "pusher_keel", "probe_housing");
}

#[test]
fn descending_fingers_crash_into_an_extended_pusher() {
    let mut hand = Hand::new(options(false));
    hand.set("axis_servo_on", true);
    hand.axis(0);
    hand.set("pusher_extend", true);
    hand.wait(500.0);
    hand.set("sort_z_lower", true);
    hand.wait(500.0);
    assert_touched(&hand, "pusher_head", "finger_rear");
}

#[test]
fn an_axis_move_with_z_down_hits_a_bracket() {
    let mut hand = Hand::new(options(false));
    hand.set("axis_servo_on", true);
    hand.axis(0);
    assert_untouched(&hand);
    hand.set("sort_z_lower", true);
    hand.wait(500.0);
    assert_untouched(&hand);
    hand.axis(1);
    assert_touched(&hand, "gripper_palm", "nest_sensor_bracket_left");
}

/// Returns a rig with a part that jaws and fingers both hold.
fn gripped_in_jaws() -> Hand {
    let mut hand = Hand::new(options(false));
    hand.feed();
    hand.set("clamp_close", true);
    hand.set("axis_servo_on", true);
    hand.axis(0);
    hand.set("sort_z_lower", true);
    hand.wait(400.0);
    hand.set("gripper_close", true);
    hand.wait(300.0);
    hand.set("probe_lift", false);
    hand.wait(300.0);
    assert_untouched(&hand);
    hand
}

#[test]
fn raising_z_while_the_jaws_hold_the_part_crashes() {
    let mut hand = gripped_in_jaws();
    hand.set("sort_z_lower", false);
    hand.wait(400.0);
    assert_touched(&hand, "part_nest", "finger_");
}

#[test]
fn without_valves_fingers_slide_off_and_jaws_hold() {
    let mut hand = gripped_in_jaws();
    for point in ["clamp_close", "gripper_close", "sort_z_lower"] {
        hand.set(point, false);
    }
    hand.wait(500.0);
    assert_untouched(&hand);
    assert!(hand.is_on("nest_present") && hand.is_on("sort_z_up") && !hand.is_on("gripper_part"));
}

#[test]
fn a_part_pushed_into_an_occupied_nest_crashes() {
    let mut hand = Hand::new(options(false));
    for _ in 0..2 {
        hand.pulse("escapement_release", 300.0);
        hand.wait(300.0);
        hand.pulse("pusher_extend", 600.0);
        hand.wait(600.0);
    }
    assert_touched(&hand, "part_pusher", "part_nest");
}

#[test]
fn fingers_that_leave_their_part_do_not_crash() {
    let mut o = options(false);
    o.faults = vec![("part_stays".into(), 1.0)];
    let mut hand = Hand::new(o);
    hand.feed();
    hand.set("probe_lift", false);
    hand.wait(250.0);
    hand.set("axis_servo_on", true);
    hand.axis(0);
    hand.set("sort_z_lower", true);
    hand.wait(400.0);
    hand.pulse("gripper_close", 200.0);
    hand.pulse("clamp_open", 200.0);
    hand.set("sort_z_lower", false);
    hand.wait(400.0);
    assert!(hand.is_on("nest_present") && hand.is_on("sort_z_up"));
    assert_untouched(&hand);
}
