//! Tests with parts that no list has, that no contact shows, or that a person forgets.

use super::Scenario;
use crate::handling::batch::Phase;
use crate::handling::batch::loading::{ALL, AS_SEEN, LOADED};
use crate::handling::batch::unloading::{DONE, EMPTY};
use crate::handling::place::Place;
use crate::handling::trouble::Trouble;

/// Returns the sockets whose part has a number.
fn numbered(it: &Scenario) -> Vec<u16> {
    let filled = |socket: &u16| it.rig.ledger.holds(Place::Socket(*socket));
    (1..=40).filter(filled).collect()
}

fn says(it: &Scenario, words: &str) -> bool {
    it.batch
        .prompt()
        .is_some_and(|it| it.text_en.contains(words))
}

#[test]
fn parts_of_an_earlier_run_come_out_first() {
    let mut it = Scenario::new();
    it.attended = true;
    it.rig.contacts.extend([2, 5]);
    it.until("asked", |it| it.batch.prompt().is_some());
    assert_eq!(it.batch.prompt().unwrap().name, EMPTY);
    assert!(says(&it, "2, 5"));
    it.rig.contacts.remove(&2);
    assert!(it.batch.answer(EMPTY, DONE));
    it.run(1_000);
    assert!(it.homing && says(&it, ": 5"), "a contact is closed");
    it.rig.contacts.clear();
    it.run(1_000);
    assert!(it.homing, "nobody has confirmed");
    assert!(it.batch.answer(EMPTY, DONE));
    it.until("home", |it| !it.homing);
    assert_eq!(it.rig.ledger.inside(), 0);
}

#[test]
fn a_closed_door_loads_nothing() {
    let mut it = Scenario::ready();
    it.rig.contacts.extend([1, 2, 3]);
    it.run(60_000);
    assert!(matches!(it.batch.phase(), Phase::Loading(_)));
}

#[test]
fn every_part_that_shows_is_tested() {
    for (lacking, shown, tested) in [
        (3, vec![1, 3, 40], vec![1, 3, 40]),
        (3, vec![1, 40], vec![1, 2, 40]),
        (2, vec![1, 3, 40], vec![1, 3, 40]),
        (4, vec![2, 3, 40], vec![1, 2, 3, 40]),
    ] {
        let mut it = Scenario::ready();
        it.lacking = Some(lacking);
        it.load(&shown);
        it.until_testing();
        assert_eq!(numbered(&it), tested, "{lacking} lacking, {shown:?} shown");
    }
}

#[test]
fn parts_that_do_not_show_are_asked_for() {
    let mut it = Scenario::ready();
    it.attended = true;
    it.run(60_000);
    assert!(it.batch.prompt().is_none(), "nobody has opened the door");
    it.load(&[]);
    it.until("asked", |it| it.batch.prompt().is_some());
    assert!(says(&it, "no contact at 1-3"));
    assert!(!it.batch.answer(LOADED, AS_SEEN));
    assert!(it.batch.answer(LOADED, ALL));
    it.until_testing();
    assert_eq!(numbered(&it), [1, 2, 3]);
}

#[test]
fn without_a_screen_a_silent_rack_is_trouble() {
    let mut it = Scenario::ready();
    it.load(&[]);
    it.run(60_000);
    assert_eq!(it.trouble, []);
    it.run(600_000);
    let late = |it: &Trouble| matches!(it, Trouble::TooLong("loading", _));
    assert!(it.trouble.iter().any(late));
    assert!(it.batch.test().is_none());
}

#[test]
fn a_contradicted_confirmation_names_the_sockets() {
    let mut it = Scenario::ready();
    it.attended = true;
    it.load(&[1, 2, 3]);
    it.until("asked", |it| it.batch.prompt().is_some());
    assert!(it.batch.answer(LOADED, AS_SEEN));
    it.until_unlocked();
    it.until("list", |it| it.batch.prompt().is_some());
    it.rig.open().unwrap();
    it.rig.contacts.remove(&1);
    assert!(it.batch.answer("batch_unload_pass", DONE));
    it.run(1_000);
    assert!(says(&it, "still show a part: 2, 3"));
    it.rig.contacts.clear();
    assert!(it.batch.answer("batch_unload_pass", DONE));
    it.until("unloaded", |it| it.batch.is_empty());
}

#[test]
fn a_rest_forgets_the_closed_door_and_the_answer() {
    let mut it = Scenario::ready();
    it.attended = true;
    it.load(&[1, 2, 3]);
    it.until("asked", |it| it.batch.prompt().is_some());
    assert!(it.batch.answer(LOADED, AS_SEEN));
    it.batch.rest();
    assert!(it.batch.prompt().is_none());
    it.run(2_000);
    assert!(
        it.batch.prompt().is_none(),
        "the door has just been watched"
    );
    it.run(2_000);
    assert!(it.batch.prompt().is_some() && it.batch.test().is_none());
}
