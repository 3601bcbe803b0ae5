//! The known position of an actuator.

use super::MockRig;
use super::mock_rig::{LENGTH_MM, SENSOR_OFF_MM, TIMEOUT};
use crate::dut::em_relay::bins;
use crate::guard::{Actuator, PartPlaces, Position};
use crate::handling::mechanism::{DEBOUNCE, HandEnd, SENSOR_AGE};
use crate::handling::moves::Move;
use crate::handling::trouble::Trouble;
use crate::rig::axis::AxisStation;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use units::{RigTime, Span};

const TO_PASS: Move = Move::AxisTo(AxisStation::Bin(Bin::PASS));

fn position(mock: &MockRig, actuator: Actuator) -> Position {
    mock.mechanism.position(actuator, mock.now, &mock.image)
}

fn arrived(mock: &MockRig, movement: Move) -> bool {
    mock.mechanism.has_arrived(movement, mock.now, &mock.image)
}

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
        let mut mock = MockRig::at_rest();
        mock.mechanism.driven(movement, mock.now, &mock.image);
        assert!(!arrived(&mock, movement), "{movement:?} just driven");
        mock.carried_out(movement);
        assert!(arrived(&mock, movement), "{movement:?}");
        assert!(!mock.mechanism.is_moving(movement), "{movement:?}");
        if movement != Move::EscapementRelease {
            let at = position(&mock, actuator);
            assert_eq!(at, Position::At(to_mm), "{movement:?}");
        }
    }
}

#[test]
fn an_end_sensor_is_awaited_shortly_before_the_motion_arrives() {
    let awaited = |mock: &MockRig| {
        let mut sensors = mock.mechanism.awaited(mock.now);
        sensors.any(|it| it == DigitalIn::ProbeUp)
    };
    let mut mock = MockRig::at_rest();
    mock.mechanism.driven(Move::ProbesUp, mock.now, &mock.image);
    assert!(awaited(&mock), "no stroke has shown its time");
    mock.carried_out(Move::ProbesUp);
    assert!(!awaited(&mock), "arrived");
    mock.mechanism
        .driven(Move::ProbesDown, mock.now, &mock.image);
    mock.carried_out(Move::ProbesDown);
    mock.mechanism.driven(Move::ProbesUp, mock.now, &mock.image);
    mock.after(60);
    assert!(!awaited(&mock), "too early");
    mock.after(60);
    assert!(awaited(&mock), "soon");
}

#[test]
fn a_moving_actuator_is_anywhere_on_its_way() {
    let mut mock = MockRig::at_rest();
    mock.mechanism
        .driven(Move::PusherExtend, mock.now, &mock.image);
    let under_way = Position::Between {
        from_mm: 0.0,
        to_mm: 60.0,
    };
    assert_eq!(position(&mock, Actuator::Pusher), under_way);
    // Its rest sensor may still be on: the motion counts, not the sensor.
    mock.after(8);
    mock.mechanism.update(mock.now, &mock.image);
    assert_eq!(position(&mock, Actuator::Pusher), under_way);
    assert_eq!(position(&mock, Actuator::ProbeLift), Position::At(0.0));
}

#[test]
fn a_moving_axis_spans_only_stations_on_its_way() {
    let mut mock = MockRig::at_rest();
    mock.carried_out(TO_PASS);
    let coil = Move::AxisTo(AxisStation::Bin(bins::COIL));
    mock.mechanism.driven(coil, mock.now, &mock.image);
    let between = Position::Between {
        from_mm: 150.0,
        to_mm: 190.0,
    };
    assert_eq!(position(&mock, Actuator::SortAxis), between);
    assert!(!arrived(&mock, TO_PASS), "it has left");
}

#[test]
fn an_axis_without_a_travel_may_be_anywhere() {
    let mut mock = MockRig::at_rest();
    let anywhere = Position::Between {
        from_mm: 0.0,
        to_mm: 350.0,
    };
    assert_eq!(position(&mock, Actuator::SortAxis), anywhere);
    assert!(!arrived(&mock, Move::AxisTo(AxisStation::Nest)));
    mock.carried_out(Move::AxisTo(AxisStation::Nest));
    assert_eq!(position(&mock, Actuator::SortAxis), Position::At(0.0));
}

#[test]
fn in_position_is_ignored_until_the_drive_reacts() {
    let mut mock = MockRig::at_rest();
    mock.mechanism.driven(TO_PASS, mock.now, &mock.image);
    mock.after(14);
    mock.mechanism.update(mock.now, &mock.image);
    assert!(mock.mechanism.is_moving(TO_PASS), "in position is old news");
    mock.after(1);
    mock.mechanism.update(mock.now, &mock.image);
    assert!(!mock.mechanism.is_moving(TO_PASS));
}

#[test]
fn an_older_sensor_value_shows_no_arrival() {
    let mut mock = MockRig::at_rest();
    mock.now = mock.now + Span::ms(5);
    mock.mechanism
        .driven(Move::PusherRetract, mock.now, &mock.image);
    mock.now = mock.now + Span::ms(5);
    assert!(seen(&mut mock).is_empty());
    assert!(!arrived(&mock, Move::PusherRetract));
    mock.after(5);
    mock.mechanism.update(mock.now, &mock.image);
    assert!(arrived(&mock, Move::PusherRetract));
}

fn seen(mock: &mut MockRig) -> Vec<Trouble> {
    mock.mechanism.update(mock.now, &mock.image).trouble
}

/// The stroke runs back and forth once more, and fails again.
fn second_try(mock: &mut MockRig, movement: Move, back: Move, first: &[Trouble]) -> Vec<Trouble> {
    assert_eq!(first[0], Trouble::Retried(movement, TIMEOUT));
    mock.mechanism.driven(back, mock.now, &mock.image);
    mock.show_end(back);
    mock.after(50);
    let found = mock.mechanism.update(mock.now, &mock.image);
    assert_eq!(found.motions, [movement], "forth again");
    assert!(found.trouble.is_empty() && mock.mechanism.is_moving(movement));
    for (point, state) in movement.arrival() {
        mock.set(*point, !state);
    }
    mock.mechanism.driven(movement, mock.now, &mock.image);
    mock.after(TIMEOUT.0 / 1000 + 1);
    seen(mock)
}

#[test]
fn fingers_closed_on_nothing_by_hand_are_no_trouble() {
    let closing = Move::GripperClose;
    let mut mock = MockRig::at_rest();
    mock.mechanism.driven(closing, mock.now, &mock.image);
    mock.mechanism.driven_by_hand(closing);
    mock.set(DigitalIn::GripperOpen, false);
    mock.after(TIMEOUT.0 / 1000 - 1);
    assert!(seen(&mut mock).is_empty());
    assert_eq!(hand_end(&mut mock), None, "it moves");
    mock.after(2);
    assert!(seen(&mut mock).is_empty());
    assert_eq!(hand_end(&mut mock), Some(HandEnd::ClosedOnNothing));
    assert_eq!(hand_end(&mut mock), None, "it ends once");
    mock.after(500);
    assert!(seen(&mut mock).is_empty(), "nothing is held");

    mock.mechanism
        .driven(Move::GripperOpen, mock.now, &mock.image);
    mock.mechanism.driven_by_hand(Move::GripperOpen);
    mock.carried_out(Move::GripperOpen);
    assert_eq!(hand_end(&mut mock), Some(HandEnd::Arrived));
}

fn hand_end(mock: &mut MockRig) -> Option<HandEnd> {
    mock.mechanism.take_hand_end(mock.now, &mock.image)
}

#[test]
fn a_motion_by_hand_may_be_cut() {
    let mut mock = MockRig::at_rest();
    let motion = Move::PusherExtend;
    mock.mechanism.driven(motion, mock.now, &mock.image);
    mock.mechanism.driven_by_hand(motion);
    mock.mechanism.forget();
    assert_eq!(hand_end(&mut mock), Some(HandEnd::Cut));
    // Fingers that stay open are late even when a person ordered the motion.
    let motion = Move::GripperClose;
    mock.mechanism.driven(motion, mock.now, &mock.image);
    mock.mechanism.driven_by_hand(motion);
    mock.after(TIMEOUT.0 / 1000 + 1);
    assert_eq!(seen(&mut mock), [Trouble::Retried(motion, TIMEOUT)]);
}

#[test]
fn a_late_actuator_is_an_alarm_with_its_name() {
    for (movement, ..) in MOTIONS {
        let mut mock = MockRig::at_rest();
        for (point, state) in movement.arrival() {
            mock.set(*point, !state);
        }
        mock.mechanism.driven(movement, mock.now, &mock.image);
        let limit = mock.now + TIMEOUT;
        mock.now = RigTime(limit.0 - 1);
        mock.scan();
        assert!(seen(&mut mock).is_empty());
        mock.now = limit + Span::ms(30);
        assert!(seen(&mut mock).is_empty(), "the look is from before");
        mock.scan();
        let first = seen(&mut mock);
        let troubles = match movement.way_back() {
            Some(back) => second_try(&mut mock, movement, back, &first),
            None => first,
        };
        assert_eq!(troubles, [Trouble::NotReached(movement, TIMEOUT)]);
    }
}

#[test]
fn the_opposite_order_replaces_a_motion_under_way() {
    let mut mock = MockRig::at_rest();
    mock.mechanism.driven(Move::SortDown, mock.now, &mock.image);
    mock.after(20);
    mock.mechanism.driven(Move::SortUp, mock.now, &mock.image);
    let anywhere = Position::Between {
        from_mm: 0.0,
        to_mm: 40.0,
    };
    assert_eq!(position(&mock, Actuator::SortZ), anywhere);
    mock.after(20);
    mock.mechanism.update(mock.now, &mock.image);
    assert_eq!(position(&mock, Actuator::SortZ), Position::At(0.0));
}

#[test]
fn stale_sensors_leave_the_whole_stroke() {
    let mut mock = MockRig::at_rest();
    mock.now = mock.now + SENSOR_AGE;
    assert!(arrived(&mock, Move::PusherRetract), "old but believed");
    mock.now = mock.now + Span(1);
    assert!(!arrived(&mock, Move::PusherRetract));
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
        assert_eq!(position(&mock, actuator), whole, "{actuator:?}");
    }
}

#[test]
fn a_debounced_sensor_shows_that_the_pusher_left() {
    let mut mock = MockRig::at_rest();
    mock.show_end(Move::PusherExtend);
    mock.scan();
    mock.mechanism
        .driven(Move::PusherRetract, mock.now, &mock.image);
    let to = |to_mm| Position::Between {
        from_mm: 0.0,
        to_mm,
    };
    let debounce_ms = DEBOUNCE.0 / 1000;
    // Sensor of the extended pusher, and how long the reading lasts.
    let readings = [
        (true, debounce_ms, 60.0),
        (false, debounce_ms - 1, 60.0),
        (true, 1, 60.0),
        (false, debounce_ms - 1, 60.0),
        (false, 1, 60.0 - SENSOR_OFF_MM),
        (true, 1, 60.0),
    ];
    for (number, (is_on, ms, high_mm)) in readings.into_iter().enumerate() {
        mock.set(DigitalIn::PusherExtended, is_on);
        mock.scan();
        mock.mechanism.update(mock.now, &mock.image);
        mock.after(ms);
        mock.scan();
        mock.mechanism.update(mock.now, &mock.image);
        let found = position(&mock, Actuator::Pusher);
        assert_eq!(found, to(high_mm), "reading {number}");
        let left = mock.mechanism.pusher_left_the_probes(mock.now);
        assert_eq!(left, high_mm < 60.0, "reading {number}");
    }
}

#[test]
fn two_or_no_end_sensors_leave_the_position_open() {
    for both in [true, false] {
        let mut mock = MockRig::at_rest();
        mock.set(DigitalIn::PusherRetracted, both);
        mock.set(DigitalIn::PusherExtended, both);
        mock.scan();
        let at = position(&mock, Actuator::Pusher);
        assert!(matches!(at, Position::Between { .. }), "{both}: {at:?}");
    }
}

#[test]
fn the_situation_has_every_position_and_every_part() {
    let mock = MockRig::at_rest();
    let parts = PartPlaces {
        nest: true,
        ..PartPlaces::default()
    };
    let situation = mock.mechanism.situation(parts, mock.now, &mock.image);
    assert_eq!(situation.parts, parts);
    for actuator in Actuator::ALL {
        let known = situation.position(actuator);
        assert_eq!(known, Some(position(&mock, actuator)), "{actuator:?}");
    }
}
