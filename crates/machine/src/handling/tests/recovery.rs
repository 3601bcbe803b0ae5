//! Homing moves in an order proven clear, and places parts where the sensors show them.

use super::MockRig;
use crate::handling::ledger::{Ledger, PartRole};
use crate::handling::moves::Move;
use crate::handling::place::{NestId, Place};
use crate::handling::recovery::Recovery;
use crate::handling::serial::{Serials, Source};
use crate::rig::axis::AxisStation;
use crate::rig::bin::Bin;
use crate::rig::point::{DigitalIn, DigitalOut};
use std::collections::BTreeSet;

const ORDER: [Move; 7] = [
    Move::SortUp,
    Move::ProbesDown,
    Move::PusherRetract,
    Move::EscapementHold,
    Move::ClampOpen,
    Move::GripperOpen,
    Move::AxisTo(AxisStation::Nest),
];

fn nothing_home() -> MockRig {
    let mut mock = MockRig::at_rest();
    for movement in [
        Move::SortDown,
        Move::ProbesUp,
        Move::PusherExtend,
        Move::EscapementRelease,
        Move::ClampClose,
    ] {
        mock.show_end(movement);
    }
    mock.set(DigitalIn::GripperOpen, false);
    mock.scan();
    mock
}

/// Carries out all commands of homing; returns the motions in order.
fn carried_out(mock: &mut MockRig) -> Vec<Move> {
    homed(mock, false)
}

fn homed(mock: &mut MockRig, releasing: bool) -> Vec<Move> {
    let mut recovery = Recovery::default();
    let mut driven = Vec::new();
    for _ in 0..40 {
        if recovery.step(&mut mock.turn(), releasing) {
            break;
        }
        let motions = mock.output.rig.motions.clone();
        assert!(motions.len() < 2, "one at a time");
        if motions.is_empty() {
            mock.after(20);
        }
        for movement in motions {
            driven.push(movement);
            mock.carried_out(movement);
        }
    }
    assert!(
        recovery.step(&mut mock.turn(), releasing),
        "home stays home"
    );
    driven
}

#[test]
fn homing_moves_z_first_then_one_by_one() {
    assert_eq!(carried_out(&mut nothing_home()), ORDER);
}

#[test]
fn homing_moves_only_the_axis_from_rest() {
    let driven = carried_out(&mut MockRig::at_rest());
    assert_eq!(driven, [Move::AxisTo(AxisStation::Nest)]);
}

#[test]
fn a_delivered_part_is_neither_lost_nor_found() {
    let mut mock = MockRig::at_rest();
    mock.ledger.enter_pocket();
    mock.set(DigitalIn::NestPresent, true);
    mock.scan();
    carried_out(&mut mock);
    assert!(!mock.ledger.holds(Place::Pocket) && mock.ledger.holds(Place::NEST));
    assert_eq!((mock.ledger.lost, mock.ledger.found), (0, 0));
}

#[test]
fn a_part_that_came_during_an_abort_takes_its_scan() {
    for (releasing, serial) in [(true, Some("S-1")), (false, None)] {
        let mut mock = MockRig::at_rest();
        mock.serials = Serials::new(Source::Wedge, BTreeSet::new());
        for serial in ["S-1", "S-2"] {
            assert_eq!(mock.serials.scan(serial, &mock.ledger), Ok(()));
        }
        mock.serials.released();
        mock.set(DigitalIn::PocketPresent, true);
        mock.scan();
        homed(&mut mock, releasing);
        mock.turn().enter_nest(NestId::FIRST);
        let part = mock.ledger.part(Place::NEST).unwrap();
        assert_eq!(part.serial.as_deref(), serial);
        let waiting: Vec<&String> = mock.serials.waiting().unwrap().collect();
        assert_eq!(waiting, ["S-2"]);
    }
}

#[test]
fn the_drive_is_reset_before_anything_moves() {
    let mut mock = nothing_home();
    let mut recovery = Recovery::default();
    let mut outputs = Vec::new();
    for _ in 0..4 {
        recovery.step(&mut mock.turn(), false);
        assert!(mock.output.rig.motions.is_empty());
        outputs.append(&mut mock.output.rig.outputs);
        mock.after(20);
    }
    let expected = [
        (DigitalOut::AxisReset, true),
        (DigitalOut::AxisReset, false),
        (DigitalOut::AxisServoOn, true),
    ];
    assert_eq!(outputs, expected);
}

#[test]
fn nothing_moves_before_the_part_sensors_are_read() {
    let mut mock = MockRig::unread();
    let mut recovery = Recovery::default();
    for _ in 0..3 {
        assert!(!recovery.step(&mut mock.turn(), false));
        assert!(mock.output.rig.motions.is_empty() && mock.output.rig.outputs.is_empty());
    }
}

#[test]
fn a_refused_motion_waits_for_the_others() {
    let mut mock = nothing_home();
    mock.show_end(Move::SortUp);
    mock.scan();
    let mut recovery = Recovery::default();
    while mock.output.rig.motions.is_empty() {
        recovery.step(&mut mock.turn(), false);
        mock.after(20);
    }
    assert_eq!(mock.output.rig.motions, [Move::ProbesDown]);
    assert!(recovery.refused(Move::ProbesDown), "another one goes first");
    recovery.step(&mut mock.turn(), false);
    assert_eq!(mock.output.rig.motions, [Move::PusherRetract]);
    let mut again = true;
    for _ in 0..6 {
        let requested = mock.output.rig.motions.clone();
        again = requested.iter().all(|movement| recovery.refused(*movement));
        recovery.step(&mut mock.turn(), false);
    }
    assert!(
        !again,
        "when all that are left are refused, that is trouble"
    );
}

#[test]
fn fingers_that_hold_a_found_part_stay_closed() {
    for (point, place) in [
        (DigitalIn::PocketPresent, "pocket"),
        (DigitalIn::NestPresent, "nest"),
        (DigitalIn::GripperPart, "gripper"),
    ] {
        let mut mock = nothing_home();
        mock.set(point, true);
        mock.scan();
        let driven = carried_out(&mut mock);
        let opened = driven.contains(&Move::GripperOpen);
        assert_eq!(opened, place != "gripper", "{place}");
        let ledger = &mock.ledger;
        assert!(ledger.balances() && ledger.found == 1 && ledger.inside() == 1);
        let mut parts = ledger.each().filter_map(|(_, part)| part);
        let is_recorded = parts.any(|part| part.interrupted.is_some());
        assert!(is_recorded || ledger.is_pocket_found(), "{place}");
    }
}

/// Every combination of ledger and sensors.
#[test]
fn after_homing_the_ledger_agrees_with_the_sensors() {
    for before in 0..8_u8 {
        for seen in 0..8_u8 {
            let mut mock = MockRig::at_rest();
            mock.ledger = ledger(before);
            let came_in = mock.ledger.came_in;
            for (bit, point) in [
                (1, DigitalIn::PocketPresent),
                (2, DigitalIn::NestPresent),
                (4, DigitalIn::GripperPart),
            ] {
                mock.set(point, seen & bit != 0);
            }
            mock.set(DigitalIn::GripperOpen, seen & 4 == 0);
            mock.scan();
            carried_out(&mut mock);
            let after = &mock.ledger;
            let places = [
                after.holds(Place::Pocket),
                after.holds(Place::NEST),
                after.holds(Place::Gripper),
            ];
            let wanted = [1, 2, 4].map(|bit| seen & bit != 0);
            assert_eq!(places, wanted, "{before:03b} {seen:03b}");
            assert!(after.balances(), "{before:03b} {seen:03b}");
            let known = after.came_in - after.found;
            assert_eq!(known, came_in, "a part was counted twice");
        }
    }
}

#[test]
fn a_pushed_part_never_counts_as_the_lost_one() {
    let mut mock = MockRig::at_rest();
    mock.ledger = ledger(0b101);
    mock.set(DigitalIn::NestPresent, true);
    mock.scan();
    carried_out(&mut mock);
    let kind = mock.ledger.part(Place::NEST).map(|part| part.role.clone());
    assert_eq!(kind, Some(PartRole::Lot(2)), "the first one fell");
    assert_eq!((mock.ledger.lost, mock.ledger.found), (1, 0));
}

#[test]
fn a_part_still_in_the_fingers_is_not_lost() {
    for in_the_fingers in [true, false] {
        let mut mock = MockRig::at_rest();
        mock.ledger = ledger(0b100);
        mock.ledger.drop_over(Bin::PASS, mock.now, 0);
        mock.set(DigitalIn::GripperPart, in_the_fingers);
        mock.set(DigitalIn::GripperOpen, !in_the_fingers);
        mock.scan();
        carried_out(&mut mock);
        let ledger = &mock.ledger;
        assert_eq!((ledger.lost, ledger.found, ledger.inside()), (0, 0, 1));
        assert_eq!(ledger.holds(Place::Gripper), in_the_fingers);
    }
}

fn ledger(places: u8) -> Ledger {
    let mut ledger = Ledger::default();
    if places & 4 != 0 {
        ledger.enter_pocket();
        ledger.enter_nest(NestId::FIRST, None);
        ledger.lift(NestId::FIRST);
    }
    if places & 2 != 0 {
        ledger.enter_pocket();
        ledger.enter_nest(NestId::FIRST, None);
    }
    if places & 1 != 0 {
        ledger.enter_pocket();
    }
    ledger
}
