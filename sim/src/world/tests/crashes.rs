//! Which strokes make bodies touch, and which do not although they look like it.

use super::hand::{Hand, options};

/// These two are among the bodies that touched.
fn assert_touched(hand: &Hand, one: &str, other: &str) {
    let crashes = hand.world.crashes();
    let of = |crash: &String| crash.contains(one) && crash.contains(other);
    assert!(crashes.iter().any(of), "{one} and {other}: {crashes:?}");
}

fn assert_untouched(hand: &Hand) {
    assert_eq!(hand.world.crashes(), Vec::<String>::new());
}

#[test]
fn the_pusher_against_raised_probes_is_a_crash() {
    let mut hand = Hand::new(options(false));
    hand.set("probe_lift", true);
    hand.wait(300.0);
    hand.set("pusher_extend", true);
    hand.wait(500.0);
    assert_touched(&hand, "pusher_keel", "probe_housing");
}

#[test]
fn fingers_that_come_down_on_an_extended_pusher_crash() {
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
fn an_axis_that_leaves_the_nest_with_z_down_crashes_into_a_bracket() {
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

/// A part in closed jaws that the closed fingers hold too.
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
fn z_that_is_raised_while_jaws_and_fingers_hold_the_part_crashes() {
    let mut hand = gripped_in_jaws();
    hand.set("sort_z_lower", false);
    hand.wait(400.0);
    assert_touched(&hand, "part_nest", "finger_");
}

#[test]
fn when_every_valve_falls_off_fingers_slide_off_the_part_and_the_jaws_keep_it() {
    let mut hand = gripped_in_jaws();
    for point in ["clamp_close", "gripper_close", "sort_z_lower"] {
        hand.set(point, false);
    }
    hand.wait(500.0);
    assert_untouched(&hand);
    assert!(hand.sees("nest_present") && hand.sees("sort_z_up") && !hand.sees("gripper_part"));
}

#[test]
fn a_part_that_is_pushed_into_an_occupied_nest_crashes_into_the_one_there() {
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
fn fingers_that_leave_their_part_in_the_nest_slide_off_without_a_crash() {
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
    assert!(hand.sees("nest_present") && hand.sees("sort_z_up"));
    assert_untouched(&hand);
}
