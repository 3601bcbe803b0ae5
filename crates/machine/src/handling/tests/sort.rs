//! The sorter releases a part only over its bin and after its record, and its beam must count it once.

use super::MockRig;
use crate::dut::em_relay::bins;
use crate::handling::moves::Move;
use crate::handling::place::{NestId, Place};
use crate::handling::sort::{Sort, confirm};
use crate::rig::axis::AxisStation;
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use units::RigTime;

const HOME: Move = Move::AxisTo(AxisStation::Nest);

fn step(sort: Sort, mock: &mut MockRig, test_running: bool) -> Sort {
    let table = mock.wiring.axis().clone();
    let mut turn = mock.turn();
    confirm(&mut turn, &table);
    sort.step(&mut turn, &table, test_running)
}

fn beam(mock: &mut MockRig, bin: Bin, count: u16) {
    let point = mock.wiring.axis().beam(bin);
    mock.beam(point, count);
}

/// Makes a sorter whose gripper holds a part for `bin`, with z up.
fn loaded(bin: Bin) -> MockRig {
    let mut mock = MockRig::at_rest();
    mock.ledger.enter_pocket();
    mock.ledger.enter_nest(NestId::FIRST, None);
    mock.ledger.lift(NestId::FIRST);
    if let Some(part) = mock.ledger.part_mut(Place::Gripper) {
        part.bin = Some(bin);
    }
    mock.show_end(Move::GripperClose);
    mock.scan();
    mock
}

fn over(bin: Bin, count: u16) -> (Sort, MockRig) {
    let mut mock = loaded(bin);
    let sort = step(Sort::Loaded, &mut mock, false);
    assert_eq!(sort, Sort::Carrying(bin));
    mock.carried_out(Move::AxisTo(AxisStation::Bin(bin)));
    let sort = step(sort, &mut mock, false);
    assert_eq!(sort, Sort::OverBin(bin, mock.now));
    mock.after(8);
    beam(&mut mock, bin, count);
    (sort, mock)
}

fn falling(bin: Bin, count: u16) -> (Sort, MockRig) {
    let (sort, mut mock) = over(bin, count);
    mock.recorded = 1;
    let sort = step(sort, &mut mock, false);
    assert_eq!(mock.output.rig.motions, [Move::GripperOpen]);
    let sort = let_go(sort, &mut mock);
    mock.carried_out(Move::GripperOpen);
    (sort, mock)
}

/// Drives the opening of the fingers after the guard's clearance.
fn let_go(sort: Sort, mock: &mut MockRig) -> Sort {
    assert!(matches!(sort, Sort::LettingGo(..)), "{sort:?}");
    let sort = sort.driven(Move::GripperOpen, &mut mock.ledger, mock.now);
    assert_eq!(sort, Sort::Opening);
    sort
}

#[test]
fn z_comes_down_only_during_a_test() {
    let ready = || {
        let mut mock = MockRig::at_rest();
        mock.carried_out(HOME);
        mock
    };
    for (running, sensor, comes) in [
        (true, None, true),
        (false, None, false),
        (true, Some(DigitalIn::PusherRetracted), false),
        (true, Some(DigitalIn::GripperOpen), false),
    ] {
        let mut mock = ready();
        if let Some(point) = sensor {
            mock.set(point, false);
        }
        mock.scan();
        assert_eq!(step(Sort::Returning, &mut mock, running), Sort::OverNest);
        let sort = step(Sort::OverNest, &mut mock, running);
        assert_eq!(sort == Sort::Lowering, comes, "{running} {sensor:?}");
        assert_eq!(mock.output.rig.motions.contains(&Move::SortDown), comes);
    }
}

#[test]
fn the_fingers_surround_the_part_once_z_is_down() {
    let mut mock = MockRig::at_rest();
    mock.carried_out(HOME);
    let sort = step(Sort::OverNest, &mut mock, true);
    mock.carried_out(Move::SortDown);
    assert!(!sort.is_at_part(&mock.turn()));
    let sort = step(sort, &mut mock, true);
    assert_eq!(sort, Sort::AtPart);
    assert!(sort.is_at_part(&mock.turn()));
    mock.set(DigitalIn::SortZDown, false);
    mock.scan();
    assert!(!sort.is_at_part(&mock.turn()));
}

#[test]
fn an_unjudged_part_is_carried_to_retest() {
    for bin in MockRig::at_rest().wiring.axis().bins() {
        let mut mock = loaded(bin);
        assert_eq!(step(Sort::Loaded, &mut mock, false), Sort::Carrying(bin));
        let station = AxisStation::Bin(bin);
        assert_eq!(mock.output.rig.motions, [Move::AxisTo(station)]);
    }
    let mut mock = loaded(Bin::PASS);
    if let Some(part) = mock.ledger.part_mut(Place::Gripper) {
        part.bin = None;
    }
    let sort = step(Sort::Loaded, &mut mock, false);
    assert_eq!(sort, Sort::Carrying(Bin::RETEST));
}

#[test]
fn a_release_needs_a_durable_record() {
    let (sort, mut mock) = over(Bin::PASS, 3);
    for recorded in [0, 1] {
        mock.recorded = recorded;
        let next = step(sort, &mut mock, false);
        assert_eq!(next == Sort::LettingGo(Bin::PASS, 3), recorded == 1);
    }
}

#[test]
fn the_fingers_own_the_part_until_they_open() {
    let (sort, mut mock) = over(Bin::PASS, 3);
    mock.recorded = 1;
    let requested = step(sort, &mut mock, false);
    let waiting = step(requested, &mut mock, false);
    assert_eq!(
        waiting, requested,
        "a person releases it, or the guard refuses"
    );
    assert_eq!(
        waiting.driven(Move::SortUp, &mut mock.ledger, mock.now),
        waiting
    );
    assert!(mock.ledger.holds(Place::Gripper) && mock.ledger.fall().is_none());
    let_go(waiting, &mut mock);
    assert!(!mock.ledger.holds(Place::Gripper) && mock.ledger.fall().is_some());
}

#[test]
fn a_release_needs_a_fresh_count_of_the_beam() {
    let mut mock = loaded(bins::TIME);
    mock.recorded = 1;
    beam(&mut mock, bins::TIME, 5);
    let since = mock.now;
    let sort = step(Sort::OverBin(bins::TIME, since), &mut mock, false);
    assert_eq!(sort, Sort::OverBin(bins::TIME, since), "read too early");
    let watched = mock.wiring.axis().beam(bins::TIME);
    assert_eq!(mock.output.rig.beam, Some(watched));
    mock.after(1);
    beam(&mut mock, bins::TIME, 5);
    let requested = step(sort, &mut mock, false);
    let_go(requested, &mut mock);
    let falling = mock.ledger.fall();
    assert_eq!(falling.map(|falling| falling.beam_before), Some(5));
}

#[test]
fn a_release_waits_for_the_previous_fall() {
    let (sort, mut mock) = over(Bin::PASS, 0);
    mock.recorded = 2;
    mock.ledger.drop_over(bins::COIL, mock.now, 0);
    mock.ledger.enter_pocket();
    mock.ledger.enter_nest(NestId::FIRST, None);
    mock.ledger.lift(NestId::FIRST);
    assert_eq!(step(sort, &mut mock, false), sort);
    assert!(mock.output.rig.motions.is_empty());
}

#[test]
fn one_count_lands_the_part_across_the_wrap() {
    for (before, after) in [(3, 4), (u16::MAX, 0)] {
        let (sort, mut mock) = falling(bins::VOLTAGE, before);
        beam(&mut mock, bins::VOLTAGE, after);
        let sort = step(sort, &mut mock, false);
        assert_eq!(
            (sort, &*mock.output.rig.motions),
            (Sort::Returning, &[HOME][..])
        );
        assert!(
            mock.output.parts.landed.is_empty(),
            "a second body may follow"
        );
        mock.after(79);
        beam(&mut mock, bins::VOLTAGE, after);
        step(sort, &mut mock, false);
        assert!(mock.output.parts.landed.is_empty());
        mock.after(1);
        step(sort, &mut mock, false);
        assert!(mock.output.parts.landed.is_empty(), "that count is too old");
        beam(&mut mock, bins::VOLTAGE, after);
        step(sort, &mut mock, false);
        let landed = &mock.output.parts.landed[0];
        assert_eq!((landed.bin, landed.part.ordinal), (bins::VOLTAGE, 1));
        assert!(mock.ledger.fall().is_none() && mock.ledger.balances());
    }
}

#[test]
fn a_second_body_behind_the_part_is_an_alarm() {
    for bodies in [2, 3] {
        let (sort, mut mock) = falling(Bin::PASS, 10);
        beam(&mut mock, Bin::PASS, 11);
        step(sort, &mut mock, false);
        mock.after(20);
        beam(&mut mock, Bin::PASS, 10 + bodies);
        step(sort, &mut mock, false);
        assert_eq!(mock.alarms(), ["bin_beam"], "{bodies}");
        assert_eq!(
            mock.output.parts.landed.len(),
            1,
            "the part itself is in the bin"
        );
    }
}

#[test]
fn an_uncounted_part_is_lost_after_its_time() {
    let (sort, mut mock) = falling(Bin::PASS, 10);
    let since = mock.ledger.fall().map(|f| f.since).unwrap();
    mock.now = RigTime(since.0 + 1_500_000);
    mock.scan();
    beam(&mut mock, Bin::PASS, 10);
    let sort = step(sort, &mut mock, false);
    assert!(mock.alarms().is_empty());
    mock.after(1);
    step(sort, &mut mock, false);
    assert_eq!(mock.alarms(), ["bin_beam"]);
    assert_eq!((mock.ledger.lost, mock.ledger.went_out), (1, 0));
    assert!(mock.ledger.balances());
}

#[test]
fn a_count_before_the_release_is_ignored() {
    let (sort, mut mock) = over(Bin::PASS, 10);
    mock.recorded = 1;
    let requested = step(sort, &mut mock, false);
    let sort = let_go(requested, &mut mock);
    beam(&mut mock, Bin::PASS, 11);
    step(sort, &mut mock, false);
    assert!(mock.output.parts.landed.is_empty());
    let falling = mock.ledger.fall().unwrap();
    assert_eq!(falling.seen, None);
}

#[test]
fn open_fingers_return_only_when_empty() {
    let (sort, mut mock) = falling(Bin::PASS, 0);
    mock.set(DigitalIn::GripperPart, true);
    mock.scan();
    assert_eq!(step(sort, &mut mock, false), Sort::Opening);
    assert!(mock.output.rig.motions.is_empty());
    mock.set(DigitalIn::GripperPart, false);
    mock.scan();
    assert_eq!(step(sort, &mut mock, false), Sort::Returning);
    assert_eq!(mock.output.rig.motions, [HOME]);
}

#[test]
fn a_sticking_part_is_reported_and_kept() {
    let (sort, mut mock) = falling(Bin::PASS, 0);
    mock.set(DigitalIn::GripperPart, true);
    mock.after(500);
    assert_eq!(step(sort, &mut mock, false), Sort::Opening);
    assert_eq!(mock.alarms(), ["part_stuck"]);
    assert!(mock.ledger.fall().is_none() && mock.ledger.holds(Place::Gripper));
    assert!(mock.ledger.balances());
}

/// The opening of the fingers is requested, then all outputs go safe: the sensor still shows the part.
fn never_opened() -> MockRig {
    let (sort, mut mock) = over(Bin::PASS, 3);
    mock.recorded = 1;
    let requested = step(sort, &mut mock, false);
    let_go(requested, &mut mock);
    mock.mechanism.forget();
    mock
}

fn time_is_over(mock: &mut MockRig) {
    let since = mock.ledger.fall().map(|it| it.since).unwrap();
    mock.now = RigTime(since.0 + 1_500_001);
}

#[test]
fn a_part_in_closed_fingers_is_not_lost() {
    let mut mock = never_opened();
    time_is_over(&mut mock);
    mock.scan();
    beam(&mut mock, Bin::PASS, 3);
    step(Sort::Returning, &mut mock, false);
    assert!(mock.alarms().is_empty(), "{:?}", mock.alarms());
    assert!(mock.ledger.fall().is_none() && mock.ledger.lost == 0);
    let part = mock.ledger.part(Place::Gripper).unwrap();
    assert_eq!((part.ordinal, part.bin), (1, Some(Bin::PASS)));
}

#[test]
fn a_part_is_not_lost_while_fingers_are_unread() {
    let mut mock = never_opened();
    time_is_over(&mut mock);
    step(Sort::Returning, &mut mock, false);
    assert!(mock.alarms().is_empty());
    assert!(mock.ledger.fall().is_some() && mock.ledger.lost == 0);
    mock.set(DigitalIn::GripperPart, false);
    mock.scan();
    step(Sort::Returning, &mut mock, false);
    assert_eq!(
        (mock.alarms(), mock.ledger.lost),
        (vec!["bin_beam".to_owned()], 1)
    );
}

#[test]
fn the_next_part_does_not_replace_the_fallen_one() {
    let (sort, mut mock) = falling(Bin::PASS, 10);
    step(sort, &mut mock, false);
    mock.set(DigitalIn::GripperPart, true);
    time_is_over(&mut mock);
    mock.scan();
    step(Sort::AtPart, &mut mock, true);
    assert_eq!(
        (mock.alarms(), mock.ledger.lost),
        (vec!["bin_beam".to_owned()], 1)
    );
}
