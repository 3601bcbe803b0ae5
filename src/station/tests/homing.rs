//! Every actuator goes to its rest end, one after the other, z first.

use super::Shop;
use crate::rig::axis::AxisStation;
use crate::rig::point::{DigitalIn, DigitalOut};
use crate::station::homing::Homing;
use crate::station::moves::Move;

const ORDER: [Move; 7] = [
    Move::SortUp,
    Move::ProbesDown,
    Move::PusherRetract,
    Move::EscapementHold,
    Move::ClampOpen,
    Move::GripperOpen,
    Move::AxisTo(AxisStation::Nest),
];

/// Everything stands at its far end.
fn nothing_home() -> Shop {
    let mut shop = Shop::at_rest();
    for movement in [
        Move::SortDown,
        Move::ProbesUp,
        Move::PusherExtend,
        Move::EscapementRelease,
        Move::ClampClose,
    ] {
        shop.stands(movement);
    }
    shop.set(DigitalIn::GripperOpen, false);
    shop.scan();
    shop
}

#[test]
fn actuators_go_home_one_after_the_other_with_z_first() {
    let mut shop = nothing_home();
    let mut homing = Homing::default();
    let mut driven = Vec::new();
    for _ in 0..30 {
        if homing.step(&mut shop.turn()) {
            break;
        }
        let motions = shop.wants.motions.clone();
        assert!(motions.len() < 2, "one at a time");
        for movement in motions {
            driven.push(movement);
            shop.carried_out(movement);
        }
    }
    assert_eq!(driven, ORDER);
    assert!(homing.step(&mut shop.turn()), "home stays home");
}

#[test]
fn a_motion_is_asked_for_once_and_waited_for() {
    let mut shop = nothing_home();
    let mut homing = Homing::default();
    homing.step(&mut shop.turn());
    homing.step(&mut shop.turn());
    assert_eq!(shop.wants.motions, [Move::SortUp]);
    shop.mechanism.driven(Move::SortUp, shop.now, &shop.image);
    for _ in 0..3 {
        shop.after(8);
        assert!(!homing.step(&mut shop.turn()));
        assert!(shop.wants.motions.is_empty());
    }
}

#[test]
fn what_is_at_home_already_is_not_moved_but_the_axis_is() {
    let mut shop = Shop::at_rest();
    let mut homing = Homing::default();
    let mut driven = Vec::new();
    for _ in 0..10 {
        homing.step(&mut shop.turn());
        driven.append(&mut shop.wants.motions);
    }
    assert_eq!(driven, [Move::AxisTo(AxisStation::Nest)]);
}

#[test]
fn the_servo_is_on_before_anything_moves() {
    let mut shop = nothing_home();
    let mut homing = Homing::default();
    homing.step(&mut shop.turn());
    assert_eq!(shop.wants.outputs, [(DigitalOut::AxisServoOn, true)]);
    assert!(shop.wants.motions.is_empty());
}

#[test]
fn a_part_found_at_the_start_is_an_alarm_that_names_its_place() {
    for (point, place) in [
        (DigitalIn::NestPresent, "nest"),
        (DigitalIn::GripperPart, "gripper"),
    ] {
        let mut shop = Shop::at_rest();
        shop.set(point, true);
        shop.scan();
        Homing::default().step(&mut shop.turn());
        assert_eq!(shop.alarms(), ["part_found_at_start"]);
        let text = &shop.wants.alarms[0].text_en;
        assert!(text.contains(place), "{text}");
    }
}

#[test]
fn nothing_moves_before_nest_and_gripper_were_looked_at() {
    let mut shop = Shop::unread();
    let mut homing = Homing::default();
    for _ in 0..3 {
        assert!(!homing.step(&mut shop.turn()));
        assert!(shop.wants.motions.is_empty() && shop.wants.outputs.is_empty());
    }
}
