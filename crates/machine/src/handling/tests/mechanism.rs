//! The known position of an actuator.

use super::Shop;
use super::shop::{LENGTH_MM, TIMEOUT};
use crate::dut::em_relay::bins;
use crate::guard::{Actuator, PartPlaces, Position};
use crate::handling::mechanism::SENSOR_AGE;
use crate::handling::moves::Move;
use crate::handling::trouble::Trouble;
use crate::rig::axis::AxisStation;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use units::{RigTime, Span};

const TO_PASS: Move = Move::AxisTo(AxisStation::Bin(Bin::PASS));

fn position(shop: &Shop, actuator: Actuator) -> Position {
    shop.mechanism.position(actuator, shop.now, &shop.image)
}

fn arrived(shop: &Shop, movement: Move) -> bool {
    shop.mechanism.has_arrived(movement, shop.now, &shop.image)
}

/// Each motion with its actuator and its end.
const MOTIONS: [(Move, Actuator, f64); 13] = [
    (Move::EscapementRelease, Actuator::Escapement, 12.0),
    (Move::EscapementHold, Actuator::Escapement, 0.0),
    (Move::PusherExtend, Actuator::Pusher, 60.0),
    (Move::PusherRetract, Actuator::Pusher, 0.0),
    (Move::ClampClose, Actuator::JawRight, 8.0),
    (Move::ClampOpen, Actuator::JawLeft, 0.0),
    (Move::ProbesUp, Actuator::ProbeLift, 12.0),
    (Move::ProbesDown, Actuator::ProbeLift, 0.0),
    (Move::SortDown, Actuator::SortZ, 40.0),
    (Move::SortUp, Actuator::SortZ, 0.0),
    (Move::GripperClose, Actuator::Gripper, 6.0),
    (Move::GripperOpen, Actuator::Gripper, 0.0),
    (TO_PASS, Actuator::SortAxis, 150.0),
];

#[test]
fn a_motion_arrives_only_with_newer_sensor_values() {
    for (movement, actuator, to_mm) in MOTIONS {
        let mut shop = Shop::at_rest();
        shop.mechanism.driven(movement, shop.now, &shop.image);
        assert!(!arrived(&shop, movement), "{movement:?} just driven");
        shop.carried_out(movement);
        assert!(arrived(&shop, movement), "{movement:?}");
        assert!(!shop.mechanism.is_moving(movement), "{movement:?}");
        if movement != Move::EscapementRelease {
            let at = position(&shop, actuator);
            assert_eq!(at, Position::At(to_mm), "{movement:?}");
        }
    }
}

#[test]
fn a_moving_actuator_is_anywhere_on_its_way() {
    let mut shop = Shop::at_rest();
    shop.mechanism
        .driven(Move::PusherExtend, shop.now, &shop.image);
    let under_way = Position::Between {
        from_mm: 0.0,
        to_mm: 60.0,
    };
    assert_eq!(position(&shop, Actuator::Pusher), under_way);
    // Its rest sensor may still be on: the motion counts, not the sensor.
    shop.after(8);
    shop.mechanism.update(shop.now, &shop.image);
    assert_eq!(position(&shop, Actuator::Pusher), under_way);
    assert_eq!(position(&shop, Actuator::ProbeLift), Position::At(0.0));
}

#[test]
fn a_moving_axis_spans_only_stations_on_its_way() {
    let mut shop = Shop::at_rest();
    shop.carried_out(TO_PASS);
    let coil = Move::AxisTo(AxisStation::Bin(bins::COIL));
    shop.mechanism.driven(coil, shop.now, &shop.image);
    let between = Position::Between {
        from_mm: 150.0,
        to_mm: 190.0,
    };
    assert_eq!(position(&shop, Actuator::SortAxis), between);
    assert!(!arrived(&shop, TO_PASS), "it has left");
}

#[test]
fn an_axis_without_a_travel_may_be_anywhere() {
    let mut shop = Shop::at_rest();
    let anywhere = Position::Between {
        from_mm: 0.0,
        to_mm: 350.0,
    };
    assert_eq!(position(&shop, Actuator::SortAxis), anywhere);
    assert!(!arrived(&shop, Move::AxisTo(AxisStation::Nest)));
    shop.carried_out(Move::AxisTo(AxisStation::Nest));
    assert_eq!(position(&shop, Actuator::SortAxis), Position::At(0.0));
}

#[test]
fn in_position_is_ignored_until_the_drive_reacts() {
    let mut shop = Shop::at_rest();
    shop.mechanism.driven(TO_PASS, shop.now, &shop.image);
    shop.after(14);
    shop.mechanism.update(shop.now, &shop.image);
    assert!(shop.mechanism.is_moving(TO_PASS), "in position is old news");
    shop.after(1);
    shop.mechanism.update(shop.now, &shop.image);
    assert!(!shop.mechanism.is_moving(TO_PASS));
}

#[test]
fn an_older_sensor_value_shows_no_arrival() {
    let mut shop = Shop::at_rest();
    shop.now = shop.now + Span::ms(5);
    shop.mechanism
        .driven(Move::PusherRetract, shop.now, &shop.image);
    shop.now = shop.now + Span::ms(5);
    assert!(seen(&mut shop).is_empty());
    assert!(!arrived(&shop, Move::PusherRetract));
    shop.after(5);
    shop.mechanism.update(shop.now, &shop.image);
    assert!(arrived(&shop, Move::PusherRetract));
}

/// Returns the troubles of an update.
fn seen(shop: &mut Shop) -> Vec<Trouble> {
    shop.mechanism.update(shop.now, &shop.image).trouble
}

/// The stroke runs back and forth once more, and fails again.
fn second_try(shop: &mut Shop, movement: Move, back: Move, first: &[Trouble]) -> Vec<Trouble> {
    assert_eq!(first[0], Trouble::Retried(movement, TIMEOUT));
    shop.mechanism.driven(back, shop.now, &shop.image);
    shop.stands(back);
    shop.after(50);
    let found = shop.mechanism.update(shop.now, &shop.image);
    assert_eq!(found.motions, [movement], "forth again");
    assert!(found.trouble.is_empty() && shop.mechanism.is_moving(movement));
    for (point, state) in movement.arrival() {
        shop.set(*point, !state);
    }
    shop.mechanism.driven(movement, shop.now, &shop.image);
    shop.after(TIMEOUT.0 / 1000 + 1);
    seen(shop)
}

#[test]
fn a_late_actuator_is_an_alarm_with_its_name() {
    for (movement, ..) in MOTIONS {
        let mut shop = Shop::at_rest();
        for (point, state) in movement.arrival() {
            shop.set(*point, !state);
        }
        shop.mechanism.driven(movement, shop.now, &shop.image);
        let limit = shop.now + TIMEOUT;
        shop.now = RigTime(limit.0 - 1);
        shop.scan();
        assert!(seen(&mut shop).is_empty());
        shop.now = limit + Span::ms(30);
        assert!(seen(&mut shop).is_empty(), "the look is from before");
        shop.scan();
        let first = seen(&mut shop);
        let told = match movement.way_back() {
            Some(back) => second_try(&mut shop, movement, back, &first),
            None => first,
        };
        assert_eq!(told, [Trouble::NotReached(movement, TIMEOUT)]);
    }
}

#[test]
fn the_opposite_order_replaces_a_motion_under_way() {
    let mut shop = Shop::at_rest();
    shop.mechanism.driven(Move::SortDown, shop.now, &shop.image);
    shop.after(20);
    shop.mechanism.driven(Move::SortUp, shop.now, &shop.image);
    let anywhere = Position::Between {
        from_mm: 0.0,
        to_mm: 40.0,
    };
    assert_eq!(position(&shop, Actuator::SortZ), anywhere);
    shop.after(20);
    shop.mechanism.update(shop.now, &shop.image);
    assert_eq!(position(&shop, Actuator::SortZ), Position::At(0.0));
}

#[test]
fn stale_sensors_leave_the_whole_stroke() {
    let mut shop = Shop::at_rest();
    shop.now = shop.now + SENSOR_AGE;
    assert!(arrived(&shop, Move::PusherRetract), "old but believed");
    shop.now = shop.now + Span(1);
    assert!(!arrived(&shop, Move::PusherRetract));
    for (actuator, length) in Actuator::ALL.into_iter().zip(LENGTH_MM) {
        let length = if actuator == Actuator::SortAxis {
            350.0
        } else {
            length
        };
        let whole = Position::Between {
            from_mm: 0.0,
            to_mm: length,
        };
        assert_eq!(position(&shop, actuator), whole, "{actuator:?}");
    }
}

#[test]
fn two_or_no_end_sensors_leave_the_position_open() {
    for both in [true, false] {
        let mut shop = Shop::at_rest();
        shop.set(DigitalIn::PusherRetracted, both);
        shop.set(DigitalIn::PusherExtended, both);
        shop.scan();
        let at = position(&shop, Actuator::Pusher);
        assert!(matches!(at, Position::Between { .. }), "{both}: {at:?}");
    }
}

#[test]
fn the_situation_has_every_position_and_every_part() {
    let shop = Shop::at_rest();
    let parts = PartPlaces {
        nest: true,
        ..PartPlaces::default()
    };
    let situation = shop.mechanism.situation(parts, shop.now, &shop.image);
    assert_eq!(situation.parts, parts);
    for actuator in Actuator::ALL {
        let known = situation.position(actuator);
        assert_eq!(known, Some(position(&shop, actuator)), "{actuator:?}");
    }
}
