//! Every part is in exactly one place, and the places add up.

use crate::dut::em_relay::bins;
use crate::handling::ledger::BatchSocket;
use crate::handling::ledger::{Ledger, PartRole};
use crate::handling::place::{NestId, Place};
use crate::rig::bin::Bin;
use units::RigTime;

fn with_part_in_gripper() -> Ledger {
    let mut ledger = Ledger::default();
    ledger.enter_pocket();
    ledger.enter_nest(NestId::FIRST, None);
    ledger.lift(NestId::FIRST);
    ledger
}

#[test]
fn four_places_may_hold_four_parts() {
    let mut ledger = with_part_in_gripper();
    ledger.drop_over(Bin::PASS, RigTime(5), 3);
    ledger.enter_pocket();
    ledger.enter_nest(NestId::FIRST, None);
    ledger.lift(NestId::FIRST);
    ledger.enter_pocket();
    ledger.enter_nest(NestId::FIRST, None);
    ledger.enter_pocket();
    assert_eq!((ledger.inside(), ledger.came_in), (4, 4));
    assert!(ledger.balances());
    let fall = ledger.fall().unwrap();
    assert_eq!((fall.since, fall.beam_before), (RigTime(5), 3));
    assert_eq!(ledger.land().map(|part| part.ordinal), Some(1));
    assert_eq!((ledger.inside(), ledger.went_out), (3, 1));
    assert!(ledger.balances());
}

#[test]
fn parts_are_numbered_in_order_of_entering_the_nest() {
    let mut ledger = Ledger::default();
    let expected = [
        (Some("G-12-1"), PartRole::Reference("G-12-1".into())),
        (None, PartRole::Lot(1)),
        (Some("G-12-2"), PartRole::Reference("G-12-2".into())),
        (None, PartRole::Lot(2)),
    ];
    for (ordinal, (reference, kind)) in (1..).zip(expected) {
        ledger.enter_pocket();
        ledger.enter_nest(NestId::FIRST, reference.map(String::from));
        let part = ledger.part(Place::NEST).cloned().unwrap();
        assert_eq!((part.ordinal, part.role), (ordinal, kind));
        assert_eq!((part.bin, part.test, part.probed_at), (None, None, None));
        ledger.lift(NestId::FIRST);
        ledger.drop_over(Bin::RETEST, RigTime(0), 0);
        ledger.land();
    }
    assert_eq!(ledger.lot_parts(), 2);
    assert!(ledger.balances() && ledger.inside() == 0);
}

#[test]
fn a_lost_part_never_counts_as_binned() {
    let mut ledger = with_part_in_gripper();
    ledger.drop_over(bins::COIL, RigTime(0), 0);
    assert!(ledger.lose(Place::Falling) && ledger.fall().is_none());
    assert_eq!((ledger.went_out, ledger.lost, ledger.inside()), (0, 1, 0));
    assert!(ledger.balances());
}

#[test]
fn without_a_fall_no_part_lands() {
    let mut ledger = with_part_in_gripper();
    assert_eq!((ledger.land(), ledger.lose(Place::Falling)), (None, false));
    assert_eq!((ledger.went_out, ledger.lost, ledger.inside()), (0, 0, 1));
    assert!(ledger.balances());
}

#[test]
fn an_empty_gripper_that_opens_lets_no_part_fall() {
    let mut ledger = Ledger::default();
    ledger.drop_over(Bin::PASS, RigTime(0), 0);
    assert!(ledger.fall().is_none() && ledger.balances());
}

#[test]
#[should_panic(expected = "a second part in the pocket")]
fn a_second_part_in_the_pocket_panics() {
    let mut ledger = Ledger::default();
    ledger.enter_pocket();
    ledger.enter_pocket();
}

#[test]
#[should_panic(expected = "a second part in the gripper")]
fn a_second_part_in_the_gripper_panics() {
    let mut ledger = with_part_in_gripper();
    ledger.enter_pocket();
    ledger.enter_nest(NestId::FIRST, None);
    ledger.lift(NestId::FIRST);
}

#[test]
#[should_panic(expected = "a second part in the nest")]
fn the_nest_takes_no_second_part() {
    let mut ledger = Ledger::default();
    ledger.enter_pocket();
    ledger.enter_nest(NestId::FIRST, None);
    ledger.enter_pocket();
    ledger.enter_nest(NestId::FIRST, None);
}

#[test]
#[should_panic(expected = "no part to take from the nest")]
fn an_empty_nest_hands_over_no_part() {
    Ledger::default().lift(NestId::FIRST);
}

#[test]
fn a_part_is_always_in_exactly_one_place() {
    let mut ledger = Ledger::default();
    ledger.enter_pocket();
    assert!(ledger.holds(Place::Pocket) && ledger.part(Place::Pocket).is_none());
    ledger.enter_nest(NestId::FIRST, None);
    let places = |ledger: &Ledger| ledger.each().map(|(place, _)| place).collect::<Vec<_>>();
    assert_eq!(places(&ledger), [Place::NEST]);
    ledger.lift(NestId::FIRST);
    ledger.set_down(NestId::FIRST);
    ledger.lift(NestId::FIRST);
    ledger.drop_over(Bin::PASS, RigTime(0), 0);
    ledger.return_to_gripper();
    assert_eq!(places(&ledger), [Place::Gripper]);
    ledger.drop_over(Bin::PASS, RigTime(0), 0);
    assert_eq!(ledger.land().map(|part| part.role), Some(PartRole::Lot(1)));
    assert!(ledger.balances() && ledger.inside() == 0);
}

/// Makes a ledger with sockets filled by hand; the first holds a reference part.
fn filled(sockets: u16) -> Ledger {
    let mut ledger = Ledger::default();
    for socket in 0..sockets {
        let reference = (socket == 0).then(|| "G-12-1".to_owned());
        ledger.fill_socket(BatchSocket { batch: 1, socket }, reference);
    }
    ledger
}

#[test]
fn sockets_are_judged_together_and_unloaded_by_list() {
    let mut ledger = filled(8);
    assert_eq!((ledger.inside(), ledger.lot_parts()), (8, 7));
    let bins = [Bin::PASS, bins::COIL, Bin::RETEST];
    for socket in 0..8 {
        let part = ledger.part_mut(Place::Socket(socket)).unwrap();
        assert_eq!(part.ordinal, u64::from(socket) + 1);
        part.bin = Some(bins[usize::from(socket) % 3]);
    }
    // A person unloads by bins, not by sockets.
    let mut list: Vec<(Bin, u16)> = (0..8).map(|n| (bins[usize::from(n) % 3], n)).collect();
    list.sort();
    for (taken, (bin, socket)) in (1..).zip(list) {
        assert_eq!(ledger.unload_socket(socket).bin, Some(bin));
        assert_eq!((ledger.went_out, ledger.inside()), (taken, 8 - taken));
        assert!(ledger.balances());
    }
}

#[test]
fn a_part_missing_from_its_socket_is_lost() {
    let mut ledger = filled(3);
    assert!(ledger.lose(Place::Socket(1)) && !ledger.lose(Place::Socket(1)));
    assert_eq!((ledger.lost, ledger.inside()), (1, 2));
    assert!(ledger.balances());
    ledger.fill_socket(
        BatchSocket {
            batch: 1,
            socket: 1,
        },
        None,
    );
    assert_eq!(ledger.part(Place::Socket(1)).map(|it| it.ordinal), Some(4));
}

#[test]
#[should_panic(expected = "unloaded before its verdict")]
fn no_part_leaves_its_socket_unjudged() {
    filled(2).unload_socket(1);
}

#[test]
#[should_panic(expected = "a second part in the socket")]
fn a_socket_takes_no_second_part() {
    filled(2).fill_socket(
        BatchSocket {
            batch: 1,
            socket: 1,
        },
        None,
    );
}
