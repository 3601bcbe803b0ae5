//! Scenarios of a batch in virtual time, on a mock rack with a mock kind.
#![allow(clippy::unwrap_used)]

mod heat;
mod unlisted;

use super::loading::{ALL, AS_SEEN, LOADED, list};
use super::unloading::DONE;
use super::{Batch, BatchTurn, Phase};
use crate::handling::output::{Commands, NestDone, PartEvents};
use crate::handling::place::{NestId, Place};
use crate::handling::tests::RackRig;
use crate::handling::trouble::Trouble;
use crate::rig::bin::Bin;
use units::Span;

/// A batch on its mock rack.
struct Scenario {
    rig: RackRig,
    batch: Batch,
    parts: PartEvents,
    trouble: Vec<Trouble>,
    attended: bool,
    lacking: Option<u64>,
    /// True when the rows of judged parts reach the disk at once.
    records: bool,
    homing: bool,
    recorded: u64,
}

impl Scenario {
    fn new() -> Self {
        let rig = RackRig::cold();
        let mut batch = Batch::new(rig.wiring.rack().unwrap().clone());
        batch.begin_home(rig.now, &rig.device);
        Self {
            rig,
            batch,
            parts: PartEvents::default(),
            trouble: Vec::new(),
            attended: false,
            lacking: Some(3),
            records: true,
            homing: true,
            recorded: 0,
        }
    }

    /// Returns a scenario that waits for the person to load the rack.
    fn ready() -> Self {
        let mut scenario = Self::new();
        scenario.run(5_000);
        assert!(!scenario.homing, "not home");
        scenario
    }

    fn turn(&mut self) {
        self.rig.pass(Span::ms(100));
        let mut rig = Commands::default();
        let done = self.rig.done.take();
        let job = done.map(|done| NestDone {
            nest: NestId::FIRST,
            done,
        });
        let before = self.parts.judged.len();
        self.batch.deliver(job);
        let mut turn = BatchTurn {
            now: self.rig.now,
            image: &self.rig.image,
            ledger: &mut self.rig.ledger,
            rig: &mut rig,
            parts: &mut self.parts,
            trouble: &mut self.trouble,
            serials: &mut self.rig.serials,
            device: &self.rig.device,
            recorded: self.recorded,
            lacking: self.lacking,
            attended: self.attended,
            begins: true,
            experiment: None,
        };
        match self.homing {
            true => self.homing = !self.batch.home(&mut turn),
            false => self.batch.step(&mut turn),
        }
        let entered = (self.parts.judged.len() - before) as u64;
        if self.records && entered > 0 {
            self.recorded = self.parts.judged.last().unwrap().part.ordinal;
        }
        assert!(self.rig.ledger.balances());
        self.rig.apply(rig);
    }

    fn run(&mut self, ms: u64) {
        for _ in 0..ms / 100 {
            self.turn();
        }
    }

    /// Runs until the condition holds; fails after two hours.
    fn until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        for _ in 0..72_000 {
            if holds(self) {
                return;
            }
            self.turn();
        }
        panic!("never: {what}; {:?}", self.batch.phase());
    }

    fn load(&mut self, sockets: &[u16]) {
        self.rig.open().unwrap();
        self.rig.contacts.extend(sockets);
        self.run(1_000);
        self.rig.door_open = false;
    }

    fn until_testing(&mut self) {
        self.until("testing", |it| it.batch.test().is_some());
    }

    fn until_unlocked(&mut self) {
        self.until("unlocked", |it| {
            matches!(it.batch.phase(), Phase::Unloading(_)) && it.rig.is_unlocked()
        });
    }

    /// Returns the lists and sockets of the parts that left the rack, in their order.
    fn unloaded(&self) -> Vec<(String, u16)> {
        let landed = self.parts.landed.iter();
        landed
            .map(|it| (it.bin.to_string(), it.part.tested_in.unwrap().socket))
            .collect()
    }
}

#[test]
fn a_batch_is_loaded_tested_cooled_and_unloaded() {
    let mut it = Scenario::ready();
    it.load(&[1, 2, 3]);
    it.until_testing();
    assert!(it.rig.is_locked() && it.rig.ledger.inside() == 3);
    it.until("hot", |it| it.rig.rack_c > 60.0);
    it.until("judged", |it| it.parts.judged.len() == 3);
    it.run(1_000);
    assert!(it.rig.open().is_err() && it.rig.is_on(it.rig.fan()));
    it.until_unlocked();
    it.run(2_000);
    assert!(it.rig.rack_c < 50.0 && !it.rig.is_on(it.rig.fan()));
    it.rig.open().unwrap();
    it.run(1_000);
    assert!(it.parts.landed.is_empty(), "parts are still in the rack");
    it.rig.contacts.clear();
    it.until("unloaded", |it| it.batch.is_empty());
    assert_eq!(
        it.unloaded(),
        [1, 2, 3].map(|socket| ("pass".to_owned(), socket))
    );
    assert_eq!(it.trouble, []);
}

#[test]
fn rows_are_on_disk_before_a_list_opens() {
    let mut it = Scenario::ready();
    (it.records, it.attended) = (false, true);
    it.load(&[1, 2, 3]);
    it.until("asked", |it| it.batch.prompt().is_some());
    assert!(it.batch.answer(LOADED, AS_SEEN));
    it.until_unlocked();
    it.run(10_000);
    assert!(it.batch.prompt().is_none());
    it.recorded = 3;
    it.run(200);
    let prompt = it.batch.prompt().unwrap();
    assert_eq!(prompt.name, "batch_unload_pass");
    assert!(prompt.text_en.contains("1-3"), "{}", prompt.text_en);
}

#[test]
fn each_list_needs_its_own_confirmation() {
    let mut it = Scenario::ready();
    it.attended = true;
    it.rig.void(&[2]);
    it.load(&[1, 2, 3]);
    it.until("asked", |it| it.batch.prompt().is_some());
    assert!(!it.batch.answer(LOADED, "other") && !it.batch.answer("other", AS_SEEN));
    assert!(it.batch.answer(LOADED, AS_SEEN));
    it.until_unlocked();
    it.until("list", |it| it.batch.prompt().is_some());
    it.rig.open().unwrap();
    assert!(it.batch.answer("batch_unload_pass", DONE));
    it.run(1_000);
    assert!(it.parts.landed.is_empty(), "contacts contradict the person");
    it.rig.contacts.retain(|socket| *socket == 2);
    it.run(1_000);
    assert!(it.parts.landed.is_empty(), "nobody has confirmed");
    assert!(it.batch.answer("batch_unload_pass", DONE));
    it.run(1_000);
    assert_eq!(it.batch.prompt().unwrap().name, "batch_unload_retest");
    it.rig.contacts.clear();
    assert!(it.batch.answer("batch_unload_retest", DONE));
    it.until("unloaded", |it| it.batch.is_empty());
    let lists = ["pass", "pass", "retest"].map(String::from);
    let sockets = [1, 3, 2];
    assert_eq!(
        it.unloaded(),
        lists.into_iter().zip(sockets).collect::<Vec<_>>()
    );
}

#[test]
fn a_person_says_which_silent_sockets_are_filled() {
    for (choice, tested) in [(AS_SEEN, vec![1, 3]), (ALL, vec![1, 2, 3])] {
        let mut it = Scenario::ready();
        it.attended = true;
        it.load(&[1, 3]);
        it.until("asked", |it| it.batch.prompt().is_some());
        let prompt = it.batch.prompt().unwrap();
        assert!(
            prompt.text_en.contains("no contact at 2"),
            "{}",
            prompt.text_en
        );
        assert!(it.batch.answer(LOADED, choice));
        it.until_testing();
        let filled = |socket: &u16| it.rig.ledger.holds(Place::Socket(*socket));
        let sockets: Vec<u16> = (1..=40).filter(filled).collect();
        assert_eq!(sockets, tested);
    }
}

#[test]
fn without_a_screen_the_count_says_what_is_loaded() {
    let mut it = Scenario::ready();
    it.lacking = Some(3);
    it.load(&[1, 3]);
    it.until_testing();
    assert_eq!(it.rig.ledger.inside(), 3, "socket 2 has a silent part");
    let mut endless = Scenario::ready();
    endless.lacking = None;
    endless.load(&[1, 3]);
    endless.until_testing();
    assert_eq!(endless.rig.ledger.inside(), 2);
}

#[test]
fn an_empty_rack_or_an_open_door_begins_nothing() {
    let mut it = Scenario::ready();
    it.run(60_000);
    assert!(matches!(it.batch.phase(), Phase::Loading(_)), "empty");
    it.rig.open().unwrap();
    it.rig.contacts.extend([1, 2, 3]);
    it.run(60_000);
    assert!(matches!(it.batch.phase(), Phase::Loading(_)), "open");
    it.rig.door_open = false;
    it.run(1_000);
    it.rig.open().unwrap();
    it.run(10_000);
    assert!(
        matches!(it.batch.phase(), Phase::Loading(_)),
        "opened again"
    );
}

#[test]
fn a_hot_rack_at_power_up_cools_behind_the_lock() {
    let mut it = Scenario::new();
    it.rig.rack_c = 90.0;
    it.rig.contacts.extend([1, 2, 3]);
    while !it.rig.is_unlocked() {
        it.turn();
        assert!(
            it.rig.rack_c < 50.0 || !it.rig.is_unlocked(),
            "open while hot"
        );
    }
    it.run(60_000);
    assert!(it.homing, "parts of an earlier run are in the rack");
    it.rig.open().unwrap();
    it.rig.contacts.clear();
    it.until("home", |it| !it.homing);
    it.run(60_000);
    assert!(it.batch.test().is_none(), "nothing is loaded");
    assert!(it.rig.ledger.inside() == 0 && !it.rig.is_on(it.rig.heater()));
    it.load(&[1, 2, 3]);
    it.until_testing();
}

#[test]
fn safe_outputs_end_the_test_and_lock_the_door() {
    let mut it = Scenario::ready();
    it.load(&[1, 2, 3]);
    it.until("hot", |it| it.rig.rack_c > 60.0);
    for part in it.rig.ledger.held_mut() {
        part.interrupt("door_open");
        part.bin = Some(Bin::RETEST);
    }
    it.recorded = 3;
    it.rig.everything_off();
    it.batch.cut_off(it.rig.now);
    assert!(it.batch.test().is_none());
    assert!(it.rig.is_locked());
    it.batch.begin_home(it.rig.now, &it.rig.device);
    it.homing = true;
    it.until_unlocked();
    assert!(it.rig.rack_c < 50.0 && it.homing, "parts are inside");
    it.rig.open().unwrap();
    it.rig.contacts.clear();
    it.until("home", |it| !it.homing);
    let lists: Vec<String> = it.unloaded().into_iter().map(|(list, _)| list).collect();
    assert_eq!(lists, ["retest", "retest", "retest"]);
}

#[test]
fn a_door_that_does_not_lock_is_trouble() {
    let mut it = Scenario::ready();
    it.rig.lock_works = false;
    it.load(&[1, 2, 3]);
    it.run(10_000);
    assert!(it.trouble.contains(&Trouble::DoorNotLocked));
    assert!(it.batch.test().is_none());
}

#[test]
fn an_unlocked_door_during_the_test_is_trouble() {
    let mut it = Scenario::ready();
    it.load(&[1, 2, 3]);
    it.until_testing();
    it.rig.lock_works = false;
    it.run(500);
    assert!(it.trouble.contains(&Trouble::DoorNotLocked));
    assert!(it.batch.needs_closed_door());
}

#[test]
fn a_rack_without_temperature_stays_locked() {
    let mut it = Scenario::ready();
    it.load(&[1, 2, 3]);
    it.until("judged", |it| it.parts.judged.len() == 3);
    it.rig.is_thermometer_broken = true;
    it.run(60_000);
    assert!(it.trouble.contains(&Trouble::RackUnread));
    assert!(it.rig.is_locked());
}

#[test]
fn slow_cooling_is_reported_once() {
    let mut it = Scenario::ready();
    it.load(&[1, 2, 3]);
    it.until("judged", |it| it.parts.judged.len() == 3);
    it.rig.cools = false;
    it.run(2 * 3_600_000);
    let slow = it.trouble.iter();
    let slow = slow.filter(|it| matches!(it, Trouble::CoolsSlowly(_)));
    assert_eq!(slow.count(), 1);
    assert!(it.rig.is_locked());
}

#[test]
fn a_stuck_test_is_trouble() {
    let mut it = Scenario::ready();
    it.rig.longest(Span::ms(30_000));
    it.load(&[1, 2, 3]);
    it.run(120_000);
    let late = |it: &Trouble| matches!(it, Trouble::TooLong("testing", _));
    assert!(it.trouble.iter().any(late));
}

#[test]
fn a_second_batch_counts_on() {
    let mut it = Scenario::ready();
    for batch in 1..=2 {
        it.load(&[1, 2]);
        it.until_testing();
        it.until_unlocked();
        it.rig.open().unwrap();
        it.rig.contacts.clear();
        it.until("unloaded", |it| it.batch.is_empty());
        let last = it.parts.landed.last().unwrap().part.tested_in.unwrap();
        assert_eq!(last.batch, batch);
        it.lacking = Some(2);
    }
    let ordinals: Vec<u64> = it.parts.landed.iter().map(|it| it.part.ordinal).collect();
    assert_eq!(ordinals, [1, 2, 3, 4, 5]);
}

#[test]
fn numbers_of_sockets_are_joined_to_runs() {
    for (sockets, words) in [
        (vec![], ""),
        (vec![4], "4"),
        (vec![1, 2], "1, 2"),
        (vec![1, 2, 3, 7, 9, 10, 11, 12], "1-3, 7, 9-12"),
    ] {
        assert_eq!(list(&sockets), words);
    }
}
