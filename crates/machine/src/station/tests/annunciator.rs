//! Alarms in the list: states of ISA-18.2, first-out, repeats, shelf.

use crate::handling::{Move, Place};
use crate::rig::bin::Bin;
use crate::station::annunciator::{Annunciator, Condition};
use crate::station::catalogue::{AlarmCode, Reaction};
use crate::station::trouble::Alarm;
use units::{RigTime, Span};

fn door() -> Alarm {
    AlarmCode::DoorOpen.into()
}

fn jam() -> Alarm {
    Alarm::not_reached(Move::PusherExtend, Span::ms(900))
}

fn states(list: &Annunciator) -> Vec<(String, Condition)> {
    let of = |one: &crate::station::annunciator::ListedAlarm| one.condition;
    list.listed()
        .iter()
        .map(|one| (one.alarm.code.name(), of(one)))
        .collect()
}

#[test]
fn an_alarm_ends_when_acknowledged_and_without_cause() {
    for seen_first in [true, false] {
        let mut list = Annunciator::default();
        assert!(list.raise(&door(), RigTime(1)));
        assert_eq!(
            states(&list),
            [("door_open".to_owned(), Condition::Unacknowledged)]
        );
        if seen_first {
            assert!(list.acknowledge(None));
            assert_eq!(
                states(&list),
                [("door_open".to_owned(), Condition::Acknowledged)]
            );
            list.sensed(&[]);
        } else {
            list.sensed(&[]);
            assert_eq!(
                states(&list),
                [("door_open".to_owned(), Condition::Returned)]
            );
            assert!(list.acknowledge(Some("door_open")));
        }
        assert!(list.listed().is_empty());
    }
}

#[test]
fn an_order_does_not_clear_a_sensed_cause() {
    let mut list = Annunciator::default();
    list.raise(&door(), RigTime(1));
    list.cleared();
    list.sensed(&[door()]);
    assert_eq!(
        states(&list),
        [("door_open".to_owned(), Condition::Unacknowledged)]
    );
    assert_eq!(
        list.still_sensed().map(|one| one.alarm.clone()),
        Some(door())
    );
}

#[test]
fn an_order_clears_a_cause_without_sensor() {
    let mut list = Annunciator::default();
    list.raise(&jam(), RigTime(1));
    list.sensed(&[]);
    assert_eq!(
        states(&list),
        [("pusher_not_reached".to_owned(), Condition::Unacknowledged)]
    );
    list.cleared();
    assert_eq!(
        states(&list),
        [("pusher_not_reached".to_owned(), Condition::Returned)]
    );
}

#[test]
fn the_first_alarm_is_first_out_and_repeats_count() {
    let mut list = Annunciator::default();
    list.raise(&jam(), RigTime(1));
    list.raise(&door(), RigTime(2));
    assert!(!list.raise(&jam(), RigTime(3)), "it is active already");
    let listed: Vec<_> = list
        .listed()
        .iter()
        .map(|one| (one.first_out, one.count))
        .collect();
    assert_eq!(listed, [(true, 1), (false, 1)]);
    list.cleared();
    assert!(list.raise(&jam(), RigTime(4)), "it came again");
    assert_eq!(list.listed()[0].count, 2);
    assert!(!list.listed()[0].first_out, "the door was open before");
}

#[test]
fn a_new_first_alarm_takes_the_mark_over() {
    let mut list = Annunciator::default();
    list.raise(&jam(), RigTime(1));
    list.cleared();
    list.raise(&door(), RigTime(2));
    let listed = list.listed().iter();
    let first: Vec<_> = listed.filter(|one| one.first_out).collect();
    assert_eq!(first.len(), 1, "the jam has returned");
    assert_eq!(first[0].alarm, door());
}

#[test]
fn a_shelved_alarm_returns_after_its_time() {
    let mut list = Annunciator::default();
    list.raise(&door(), RigTime(0));
    let until = RigTime(0) + Span::ms(60_000);
    assert!(list.shelve("door_open", until) && !list.shelve("air_lost", until));
    list.unshelve(RigTime(59_999_999));
    assert!(list.listed()[0].shelved_until.is_some());
    list.unshelve(until);
    assert!(list.listed()[0].shelved_until.is_none());
}

#[test]
fn shelving_hides_every_alarm_of_the_code() {
    let mut list = Annunciator::default();
    for bin in [Bin::PASS, Bin::RETEST] {
        list.raise(&Alarm::bin_full(bin), RigTime(0));
    }
    let until = RigTime(60_000_000);
    assert!(list.shelve(&AlarmCode::BinFull.name(), until));
    let shelved = list.listed().iter().map(|one| one.shelved_until);
    assert_eq!(shelved.collect::<Vec<_>>(), [Some(until); 2]);
}

#[test]
fn unacknowledged_alarms_survive_a_restart() {
    let mut list = Annunciator::default();
    list.inherit(jam(), 3, Some(RigTime(10)));
    assert_eq!(
        states(&list),
        [("pusher_not_reached".to_owned(), Condition::Returned)]
    );
    assert!(
        list.stopping(Reaction::Abort).is_none(),
        "its cause is found out anew"
    );
    assert!(list.listed()[0].shelved_until.is_some());
    list.unshelve(RigTime(10));
    assert!(list.listed()[0].shelved_until.is_none());
    assert_eq!(list.listed()[0].count, 3);
}

#[test]
fn every_miscounted_part_raises_its_own_alarm() {
    let mut list = Annunciator::default();
    assert!(list.raise(&Alarm::beam(Bin::RETEST, 2), RigTime(1)));
    assert!(list.raise(&Alarm::beam(Bin::PASS, 0), RigTime(2)));
    assert!(list.raise(&Alarm::beam(Bin::PASS, 2), RigTime(3)));
    let counts: Vec<u32> = list.listed().iter().map(|one| one.count).collect();
    assert_eq!(counts, [1, 2]);
}

#[test]
fn two_lost_parts_are_two_lines() {
    let mut list = Annunciator::default();
    for place in [Place::NEST, Place::Gripper] {
        assert!(list.raise(&Alarm::part_lost(place), RigTime(1)));
    }
    let places: Vec<_> = list
        .listed()
        .iter()
        .map(|one| one.alarm.args.get("place"))
        .collect();
    assert_eq!(places, [Some("nest"), Some("gripper")]);
    assert!(list.acknowledge(Some("part_lost")));
    assert!(list.listed().is_empty(), "one order acknowledges both");
}

#[test]
fn each_full_bin_goes_by_itself() {
    let mut list = Annunciator::default();
    let both = [Bin::PASS, Bin::RETEST].map(Alarm::bin_full);
    for full in &both {
        assert!(list.raise(full, RigTime(1)));
    }
    list.sensed(&both[..1]);
    let active: Vec<bool> = list.listed().iter().map(|one| one.is_active()).collect();
    assert_eq!(active, [true, false]);
}
