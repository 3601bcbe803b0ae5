//! The sorter releases a part only over its bin and after its record, and its beam must count it once.

use super::Shop;
use crate::dut::em_relay::bins;
use crate::handling::moves::Move;
use crate::handling::place::{NestId, Place};
use crate::handling::sort::{Sort, confirm};
use crate::rig::axis::AxisStation;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use units::RigTime;

const HOME: Move = Move::AxisTo(AxisStation::Nest);

fn step(sort: Sort, shop: &mut Shop, test_running: bool) -> Sort {
    let table = shop.wiring.axis.clone();
    let mut turn = shop.turn();
    confirm(&mut turn, &table);
    sort.step(&mut turn, &table, test_running)
}

fn beam(shop: &mut Shop, bin: Bin, count: u16) {
    let point = shop.wiring.axis.beam(bin);
    shop.beam(point, count);
}

/// Makes a sorter whose gripper holds a part for `bin`, with z up.
fn loaded(bin: Bin) -> Shop {
    let mut shop = Shop::at_rest();
    shop.ledger.enter_pocket();
    shop.ledger.enter_nest(NestId::FIRST, None);
    shop.ledger.lift(NestId::FIRST);
    if let Some(part) = shop.ledger.part_mut(Place::Gripper) {
        part.bin = Some(bin);
    }
    shop.stands(Move::GripperClose);
    shop.scan();
    shop
}

/// Moves over the bin and reads its beam afterwards.
fn over(bin: Bin, count: u16) -> (Sort, Shop) {
    let mut shop = loaded(bin);
    let sort = step(Sort::Loaded, &mut shop, false);
    assert_eq!(sort, Sort::Carrying(bin));
    shop.carried_out(Move::AxisTo(AxisStation::Bin(bin)));
    let sort = step(sort, &mut shop, false);
    assert_eq!(sort, Sort::OverBin(bin, shop.now));
    shop.after(8);
    beam(&mut shop, bin, count);
    (sort, shop)
}

/// Opens the fingers; the part falls.
fn falling(bin: Bin, count: u16) -> (Sort, Shop) {
    let (sort, mut shop) = over(bin, count);
    shop.recorded = 1;
    let sort = step(sort, &mut shop, false);
    assert_eq!(shop.wants.rig.motions, [Move::GripperOpen]);
    let sort = let_go(sort, &mut shop);
    shop.carried_out(Move::GripperOpen);
    (sort, shop)
}

/// Drives the opening of the fingers after the guard's clearance.
fn let_go(sort: Sort, shop: &mut Shop) -> Sort {
    assert!(matches!(sort, Sort::LettingGo(..)), "{sort:?}");
    let sort = sort.driven(Move::GripperOpen, &mut shop.ledger, shop.now);
    assert_eq!(sort, Sort::Opening);
    sort
}

#[test]
fn z_comes_down_only_during_a_test() {
    let ready = || {
        let mut shop = Shop::at_rest();
        shop.carried_out(HOME);
        shop
    };
    for (running, sensor, comes) in [
        (true, None, true),
        (false, None, false),
        (true, Some(DigitalIn::PusherRetracted), false),
        (true, Some(DigitalIn::GripperOpen), false),
    ] {
        let mut shop = ready();
        if let Some(point) = sensor {
            shop.set(point, false);
        }
        shop.scan();
        assert_eq!(step(Sort::Returning, &mut shop, running), Sort::OverNest);
        let sort = step(Sort::OverNest, &mut shop, running);
        assert_eq!(sort == Sort::Lowering, comes, "{running} {sensor:?}");
        assert_eq!(shop.wants.rig.motions.contains(&Move::SortDown), comes);
    }
}

#[test]
fn the_fingers_surround_the_part_once_z_is_down() {
    let mut shop = Shop::at_rest();
    shop.carried_out(HOME);
    let sort = step(Sort::OverNest, &mut shop, true);
    shop.carried_out(Move::SortDown);
    assert!(!sort.is_at_part(&shop.turn()));
    let sort = step(sort, &mut shop, true);
    assert_eq!(sort, Sort::AtPart);
    assert!(sort.is_at_part(&shop.turn()));
    shop.set(DigitalIn::SortZDown, false);
    shop.scan();
    assert!(!sort.is_at_part(&shop.turn()));
}

#[test]
fn an_unjudged_part_is_carried_to_retest() {
    for bin in Shop::at_rest().wiring.axis.bins() {
        let mut shop = loaded(bin);
        assert_eq!(step(Sort::Loaded, &mut shop, false), Sort::Carrying(bin));
        let station = AxisStation::Bin(bin);
        assert_eq!(shop.wants.rig.motions, [Move::AxisTo(station)]);
    }
    let mut shop = loaded(Bin::PASS);
    if let Some(part) = shop.ledger.part_mut(Place::Gripper) {
        part.bin = None;
    }
    let sort = step(Sort::Loaded, &mut shop, false);
    assert_eq!(sort, Sort::Carrying(Bin::RETEST));
}

#[test]
fn a_release_needs_a_durable_record() {
    let (sort, mut shop) = over(Bin::PASS, 3);
    for recorded in [0, 1] {
        shop.recorded = recorded;
        let next = step(sort, &mut shop, false);
        assert_eq!(next == Sort::LettingGo(Bin::PASS, 3), recorded == 1);
    }
}

#[test]
fn the_fingers_own_the_part_until_they_open() {
    let (sort, mut shop) = over(Bin::PASS, 3);
    shop.recorded = 1;
    let asked = step(sort, &mut shop, false);
    let waiting = step(asked, &mut shop, false);
    assert_eq!(waiting, asked, "a person releases it, or the guard refuses");
    assert_eq!(
        waiting.driven(Move::SortUp, &mut shop.ledger, shop.now),
        waiting
    );
    assert!(shop.ledger.holds(Place::Gripper) && shop.ledger.fall().is_none());
    let_go(waiting, &mut shop);
    assert!(!shop.ledger.holds(Place::Gripper) && shop.ledger.fall().is_some());
}

#[test]
fn a_release_needs_a_fresh_count_of_the_beam() {
    let mut shop = loaded(bins::TIME);
    shop.recorded = 1;
    beam(&mut shop, bins::TIME, 5);
    let since = shop.now;
    let sort = step(Sort::OverBin(bins::TIME, since), &mut shop, false);
    assert_eq!(sort, Sort::OverBin(bins::TIME, since), "read too early");
    let watched = shop.wiring.axis.beam(bins::TIME);
    assert_eq!(shop.wants.rig.beam, Some(watched));
    shop.after(1);
    beam(&mut shop, bins::TIME, 5);
    let asked = step(sort, &mut shop, false);
    let_go(asked, &mut shop);
    let falling = shop.ledger.fall();
    assert_eq!(falling.map(|falling| falling.beam_before), Some(5));
}

#[test]
fn a_release_waits_for_the_previous_fall() {
    let (sort, mut shop) = over(Bin::PASS, 0);
    shop.recorded = 2;
    shop.ledger.drop_over(bins::COIL, shop.now, 0);
    shop.ledger.enter_pocket();
    shop.ledger.enter_nest(NestId::FIRST, None);
    shop.ledger.lift(NestId::FIRST);
    assert_eq!(step(sort, &mut shop, false), sort);
    assert!(shop.wants.rig.motions.is_empty());
}

#[test]
fn one_count_lands_the_part_across_the_wrap() {
    for (before, after) in [(3, 4), (u16::MAX, 0)] {
        let (sort, mut shop) = falling(bins::VOLTAGE, before);
        beam(&mut shop, bins::VOLTAGE, after);
        let sort = step(sort, &mut shop, false);
        assert_eq!(
            (sort, &*shop.wants.rig.motions),
            (Sort::Returning, &[HOME][..])
        );
        assert!(
            shop.wants.parts.landed.is_empty(),
            "a second body may follow"
        );
        shop.after(79);
        beam(&mut shop, bins::VOLTAGE, after);
        step(sort, &mut shop, false);
        assert!(shop.wants.parts.landed.is_empty());
        shop.after(1);
        step(sort, &mut shop, false);
        assert!(shop.wants.parts.landed.is_empty(), "that count is too old");
        beam(&mut shop, bins::VOLTAGE, after);
        step(sort, &mut shop, false);
        let landed = &shop.wants.parts.landed[0];
        assert_eq!((landed.bin, landed.part.ordinal), (bins::VOLTAGE, 1));
        assert!(shop.ledger.fall().is_none() && shop.ledger.balances());
    }
}

#[test]
fn a_second_body_behind_the_part_is_an_alarm() {
    for bodies in [2, 3] {
        let (sort, mut shop) = falling(Bin::PASS, 10);
        beam(&mut shop, Bin::PASS, 11);
        step(sort, &mut shop, false);
        shop.after(20);
        beam(&mut shop, Bin::PASS, 10 + bodies);
        step(sort, &mut shop, false);
        assert_eq!(shop.alarms(), ["bin_beam"], "{bodies}");
        assert_eq!(
            shop.wants.parts.landed.len(),
            1,
            "the part itself is in the bin"
        );
    }
}

#[test]
fn an_uncounted_part_is_lost_after_its_time() {
    let (sort, mut shop) = falling(Bin::PASS, 10);
    let since = shop.ledger.fall().map(|f| f.since).unwrap();
    shop.now = RigTime(since.0 + 1_500_000);
    shop.scan();
    beam(&mut shop, Bin::PASS, 10);
    let sort = step(sort, &mut shop, false);
    assert!(shop.alarms().is_empty());
    shop.after(1);
    step(sort, &mut shop, false);
    assert_eq!(shop.alarms(), ["bin_beam"]);
    assert_eq!((shop.ledger.lost, shop.ledger.went_out), (1, 0));
    assert!(shop.ledger.balances());
}

#[test]
fn a_count_before_the_release_is_ignored() {
    let (sort, mut shop) = over(Bin::PASS, 10);
    shop.recorded = 1;
    let asked = step(sort, &mut shop, false);
    let sort = let_go(asked, &mut shop);
    beam(&mut shop, Bin::PASS, 11);
    step(sort, &mut shop, false);
    assert!(shop.wants.parts.landed.is_empty());
    let falling = shop.ledger.fall().unwrap();
    assert_eq!(falling.seen, None);
}

#[test]
fn open_fingers_return_only_when_empty() {
    let (sort, mut shop) = falling(Bin::PASS, 0);
    shop.set(DigitalIn::GripperPart, true);
    shop.scan();
    assert_eq!(step(sort, &mut shop, false), Sort::Opening);
    assert!(shop.wants.rig.motions.is_empty());
    shop.set(DigitalIn::GripperPart, false);
    shop.scan();
    assert_eq!(step(sort, &mut shop, false), Sort::Returning);
    assert_eq!(shop.wants.rig.motions, [HOME]);
}

#[test]
fn a_sticking_part_is_reported_and_kept() {
    let (sort, mut shop) = falling(Bin::PASS, 0);
    shop.set(DigitalIn::GripperPart, true);
    shop.after(500);
    assert_eq!(step(sort, &mut shop, false), Sort::Opening);
    assert_eq!(shop.alarms(), ["part_stuck"]);
    assert!(shop.ledger.fall().is_none() && shop.ledger.holds(Place::Gripper));
    assert!(shop.ledger.balances());
}

/// The opening of the fingers is requested, then all outputs go safe: the sensor still shows the part.
fn never_opened() -> Shop {
    let (sort, mut shop) = over(Bin::PASS, 3);
    shop.recorded = 1;
    let asked = step(sort, &mut shop, false);
    let_go(asked, &mut shop);
    shop.mechanism.forget();
    shop
}

/// Lets the time pass without a count of the beam.
fn time_is_over(shop: &mut Shop) {
    let since = shop.ledger.fall().map(|it| it.since).unwrap();
    shop.now = RigTime(since.0 + 1_500_001);
}

#[test]
fn a_part_in_closed_fingers_is_not_lost() {
    let mut shop = never_opened();
    time_is_over(&mut shop);
    shop.scan();
    beam(&mut shop, Bin::PASS, 3);
    step(Sort::Returning, &mut shop, false);
    assert!(shop.alarms().is_empty(), "{:?}", shop.alarms());
    assert!(shop.ledger.fall().is_none() && shop.ledger.lost == 0);
    let part = shop.ledger.part(Place::Gripper).unwrap();
    assert_eq!((part.ordinal, part.bin), (1, Some(Bin::PASS)));
}

#[test]
fn a_part_is_not_lost_while_fingers_are_unread() {
    let mut shop = never_opened();
    time_is_over(&mut shop);
    step(Sort::Returning, &mut shop, false);
    assert!(shop.alarms().is_empty());
    assert!(shop.ledger.fall().is_some() && shop.ledger.lost == 0);
    shop.set(DigitalIn::GripperPart, false);
    shop.scan();
    step(Sort::Returning, &mut shop, false);
    assert_eq!(
        (shop.alarms(), shop.ledger.lost),
        (vec!["bin_beam".to_owned()], 1)
    );
}

#[test]
fn the_next_part_does_not_replace_the_fallen_one() {
    let (sort, mut shop) = falling(Bin::PASS, 10);
    step(sort, &mut shop, false);
    shop.set(DigitalIn::GripperPart, true);
    time_is_over(&mut shop);
    shop.scan();
    step(Sort::AtPart, &mut shop, true);
    assert_eq!(
        (shop.alarms(), shop.ledger.lost),
        (vec!["bin_beam".to_owned()], 1)
    );
}
