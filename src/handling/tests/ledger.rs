//! Every part is in exactly one place, and the places add up.

use crate::dut::em_relay::bins;
use crate::handling::ledger::{Kind, Ledger};
use crate::rig::bin::Bin;
use crate::units::RigTime;

fn with_part_in_gripper() -> Ledger {
    let mut ledger = Ledger::default();
    ledger.enter_pocket();
    ledger.enter_nest(None);
    ledger.lift();
    ledger
}

#[test]
fn four_parts_may_be_inside_at_once_one_in_each_place() {
    let mut ledger = with_part_in_gripper();
    ledger.drop_over(Bin::PASS, RigTime(5), 3);
    ledger.enter_pocket();
    ledger.enter_nest(None);
    ledger.lift();
    ledger.enter_pocket();
    ledger.enter_nest(None);
    ledger.enter_pocket();
    assert_eq!((ledger.inside(), ledger.came_in), (4, 4));
    assert!(ledger.balances());
    let falling = ledger.land().unwrap();
    assert_eq!((falling.since, falling.beam_before), (RigTime(5), 3));
    assert_eq!((ledger.inside(), ledger.went_out), (3, 1));
    assert!(ledger.balances());
}

#[test]
fn parts_are_numbered_in_the_order_in_which_they_enter_the_nest() {
    let mut ledger = Ledger::default();
    let expected = [
        (Some("G-12-1"), Kind::Golden("G-12-1".into())),
        (None, Kind::Lot(1)),
        (Some("G-12-2"), Kind::Golden("G-12-2".into())),
        (None, Kind::Lot(2)),
    ];
    for (ordinal, (golden, kind)) in (1..).zip(expected) {
        ledger.enter_pocket();
        ledger.enter_nest(golden.map(String::from));
        let part = ledger.nest.clone().unwrap();
        assert_eq!((part.ordinal, part.kind), (ordinal, kind));
        assert_eq!((part.bin, part.test, part.probed_at), (None, None, None));
        ledger.lift();
        ledger.drop_over(Bin::RETEST, RigTime(0), 0);
        ledger.land();
    }
    assert_eq!(ledger.lot_parts(), 2);
    assert!(ledger.balances() && ledger.inside() == 0);
}

#[test]
fn a_lost_part_is_counted_as_lost_and_never_as_binned() {
    let mut ledger = with_part_in_gripper();
    ledger.drop_over(bins::COIL, RigTime(0), 0);
    assert_eq!(ledger.lose_falling().unwrap().bin, bins::COIL);
    assert_eq!((ledger.went_out, ledger.lost, ledger.inside()), (0, 1, 0));
    assert!(ledger.balances());
}

#[test]
fn nothing_lands_and_nothing_is_lost_when_nothing_falls() {
    let mut ledger = with_part_in_gripper();
    assert_eq!((ledger.land(), ledger.lose_falling()), (None, None));
    assert_eq!((ledger.went_out, ledger.lost, ledger.inside()), (0, 0, 1));
    assert!(ledger.balances());
}

#[test]
fn an_empty_gripper_that_opens_lets_no_part_fall() {
    let mut ledger = Ledger::default();
    ledger.drop_over(Bin::PASS, RigTime(0), 0);
    assert!(ledger.falling.is_none() && ledger.balances());
}

#[test]
#[should_panic(expected = "occupied pocket")]
fn two_parts_in_the_pocket_are_a_mistake_of_the_program() {
    let mut ledger = Ledger::default();
    ledger.enter_pocket();
    ledger.enter_pocket();
}

#[test]
#[should_panic(expected = "two parts in the gripper")]
fn two_parts_in_the_gripper_are_a_mistake_of_the_program() {
    let mut ledger = with_part_in_gripper();
    ledger.enter_pocket();
    ledger.enter_nest(None);
    ledger.lift();
}

#[test]
#[should_panic(expected = "without a part or a place")]
fn the_nest_takes_no_second_part() {
    let mut ledger = Ledger::default();
    ledger.enter_pocket();
    ledger.enter_nest(None);
    ledger.enter_pocket();
    ledger.enter_nest(None);
}
