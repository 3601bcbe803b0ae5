//! Alarms in the list: states of ISA-18.2, first-out, repeats, shelf.

use crate::handling::Move;
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
    let of = |one: &crate::station::annunciator::Standing| one.condition;
    list.standing()
        .iter()
        .map(|one| (one.alarm.code.name(), of(one)))
        .collect()
}

#[test]
fn an_alarm_is_normal_again_only_when_it_was_seen_and_its_cause_is_gone() {
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
        assert!(list.standing().is_empty());
    }
}

#[test]
fn a_cause_that_a_sensor_still_shows_is_not_cleared_by_a_person() {
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
fn what_no_sensor_shows_goes_when_a_person_says_so() {
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
fn the_first_alarm_after_quiet_is_pinned_and_repeats_are_counted() {
    let mut list = Annunciator::default();
    list.raise(&jam(), RigTime(1));
    list.raise(&door(), RigTime(2));
    assert!(!list.raise(&jam(), RigTime(3)), "it stands already");
    let told: Vec<_> = list
        .standing()
        .iter()
        .map(|one| (one.first_out, one.count))
        .collect();
    assert_eq!(told, [(true, 2), (false, 1)]);
    list.cleared();
    assert!(list.raise(&jam(), RigTime(4)), "it came again");
    assert!(!list.standing()[0].first_out, "the door was open before");
}

#[test]
fn a_shelved_alarm_comes_back_when_its_time_is_over() {
    let mut list = Annunciator::default();
    list.raise(&door(), RigTime(0));
    let until = RigTime(0) + Span::ms(60_000);
    assert!(list.shelve("door_open", until) && !list.shelve("air_lost", until));
    list.unshelve(RigTime(59_999_999));
    assert!(list.standing()[0].shelved_until.is_some());
    list.unshelve(until);
    assert!(list.standing()[0].shelved_until.is_none());
}

#[test]
fn what_nobody_had_seen_before_a_restart_is_still_unseen_after_it() {
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
    assert!(list.standing()[0].shelved_until.is_some());
    list.unshelve(RigTime(10));
    assert!(list.standing()[0].shelved_until.is_none());
    assert_eq!(list.standing()[0].count, 3);
}

#[test]
fn a_second_body_that_no_beam_saw_is_told_although_the_first_alarm_stands() {
    let mut list = Annunciator::default();
    assert!(list.raise(&Alarm::beam(Bin::RETEST, 2), RigTime(1)));
    assert!(list.raise(&Alarm::beam(Bin::PASS, 0), RigTime(2)));
    let standing = list.standing();
    assert_eq!((standing.len(), standing[0].count), (1, 2));
    assert!(standing[0].alarm.args.get("bin") == Some("pass"));
}
