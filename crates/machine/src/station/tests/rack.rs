//! The station of a rig with a rack: whole lots, interruptions and orders, in virtual time with a mock kind.

use super::machine::quiet;
use crate::dut::Verdict;
use crate::handling::output::{Judged, Landed, NestDone};
use crate::handling::place::NestId;
use crate::handling::tests::RackRig;
use crate::rig::point::DigitalOut;
use crate::station::gates::LotSettings;
use crate::station::orders::{Order, Refused};
use crate::station::packml::{Command, Mode, State};
use crate::station::turn::{Ending, Inputs};
use crate::station::{Plan, Station};
use units::Span;

/// A station with a rack, and the person in front of it.
struct Plant {
    station: Station,
    rig: RackRig,
    judged: Vec<Judged>,
    landed: Vec<Landed>,
    alarms: Vec<String>,
    ending: Option<Ending>,
    orders: Vec<Order>,
    answers: Vec<Result<(), Refused>>,
    verified: bool,
    /// Number of parts that the person puts into the rack; 0 for a person who does nothing.
    loads: u16,
}

impl Plant {
    fn new(count: u64, attended: bool) -> Self {
        let rig = RackRig::cold();
        let plan = Plan {
            attended,
            between_lots: None,
            simulated: true,
            count: Some(count),
            reference_serials: Vec::new(),
            calibrated: true,
            valid_us: 0,
            epoch_us: 0,
            lot: LotSettings::default(),
            worn: Default::default(),
            left: Default::default(),
            serials: Default::default(),
            prompts: Vec::new(),
            experiment: None,
        };
        let rack = rig.wiring.rack().unwrap().clone();
        Self {
            station: Station::with_rack(plan, rig.device.clone(), rack),
            rig,
            judged: Vec::new(),
            landed: Vec::new(),
            alarms: Vec::new(),
            ending: None,
            orders: Vec::new(),
            answers: Vec::new(),
            verified: false,
            loads: u16::try_from(count).unwrap(),
        }
    }

    fn turn(&mut self) {
        self.rig.pass(Span::ms(100));
        let done = self.rig.done.take();
        let nest = NestId::FIRST;
        let inputs = Inputs {
            job: done.map(|done| NestDone { nest, done }),
            recorded: self.judged.last().map_or(0, |it| it.part.ordinal),
            orders: std::mem::take(&mut self.orders),
            verified: std::mem::take(&mut self.verified),
            ..quiet(&self.rig.image)
        };
        let output = self.station.step(self.rig.now, inputs);
        self.judged.extend(output.record.parts.judged);
        self.landed.extend(output.record.parts.landed);
        let alarms = output.record.alarms.iter();
        self.alarms.extend(alarms.map(|it| it.code.name()));
        self.answers.extend(output.answers);
        self.ending = output.record.ending.or(self.ending.take());
        self.verified = output.rig.verify;
        self.rig.apply(output.rig);
        self.person();
    }

    /// Opens an unlocked door, exchanges all parts, closes the door.
    fn person(&mut self) {
        if self.loads == 0 {
            return;
        }
        let out = self.landed.len();
        if self.rig.is_unlocked() && !self.rig.door_open && self.works() {
            self.rig.open().unwrap();
        } else if self.rig.door_open && self.is_unloading() {
            self.rig.contacts.clear();
        } else if self.rig.door_open && self.rig.is_on(DigitalOut::LampReady) {
            let more = (usize::from(self.loads) - out).min(40) as u16;
            self.rig.contacts.extend(1..=more);
            self.rig.door_open = false;
        }
    }

    fn works(&self) -> bool {
        self.is_unloading() || self.rig.contacts.is_empty()
    }

    fn is_unloading(&self) -> bool {
        self.rig.is_on(DigitalOut::LampUnload)
    }

    fn order(&mut self, order: Order) -> Result<(), Refused> {
        self.orders.push(order);
        self.turn();
        self.answers.pop().unwrap()
    }

    fn until(&mut self, what: &str, holds: impl Fn(&Self) -> bool) {
        for _ in 0..72_000 {
            if holds(self) {
                return;
            }
            self.turn();
        }
        panic!(
            "never: {what}; {:?}, {:?}",
            self.station.outer(),
            self.alarms
        );
    }

    fn until_hot(&mut self) {
        self.until("hot", |it| it.rig.rack_c > 60.0);
    }

    fn is_safe(&self) -> bool {
        !self.rig.is_on(self.rig.heater()) && !self.rig.is_unlocked()
    }

    fn all_are_void(&self) -> bool {
        let void = |it: &Judged| matches!(it.verdict, Verdict::Void(_));
        !self.judged.is_empty() && self.judged.iter().all(void)
    }
}

#[test]
fn a_lot_of_two_batches_ends_complete() {
    let mut it = Plant::new(45, false);
    it.until("the end", |it| it.ending.is_some());
    assert_eq!(it.ending, Some(Ending::Complete), "{:?}", it.alarms);
    assert_eq!((it.judged.len(), it.landed.len()), (45, 45));
    let batches: Vec<u64> = it
        .landed
        .iter()
        .map(|it| it.part.tested_in.unwrap().batch)
        .collect();
    assert_eq!((batches[0], batches[39], batches[40]), (1, 1, 2));
    assert!(it.is_safe() && it.alarms.is_empty());
}

#[test]
fn an_emergency_stop_voids_the_batch_and_keeps_the_lock() {
    let mut it = Plant::new(3, true);
    begin(&mut it);
    it.rig.emergency_stop = true;
    it.until("aborted", |it| it.station.outer() == State::Aborted);
    assert!(it.is_safe() && it.all_are_void(), "{:?}", it.judged);
    it.rig.emergency_stop = false;
    it.turn();
    assert_eq!(it.order(Order::Command(Command::Clear)), Ok(()));
    it.until("stopped", |it| it.station.outer() == State::Stopped);
    assert!(it.rig.rack_c > 50.0);
    assert_eq!(it.order(Order::Command(Command::Reset)), Ok(()));
    while !it.rig.is_unlocked() {
        it.turn();
        assert!(it.rig.rack_c < 50.0 || !it.rig.is_unlocked());
    }
    assert_eq!(it.station.outer(), State::Resetting);
    it.until("a list", |it| it.station.prompt().is_some());
    it.until("open", |it| it.rig.door_open);
    it.turn();
    answer(&mut it, "batch_unload_retest", "unloaded");
    it.until("idle", |it| it.station.outer() == State::Idle);
    assert_eq!(it.landed.len(), 3);
}

#[test]
fn a_door_that_opens_during_the_test_aborts() {
    let mut it = Plant::new(3, true);
    begin(&mut it);
    it.rig.door_open = true;
    it.until("aborted", |it| it.station.outer() == State::Aborted);
    assert!(it.alarms.contains(&"door_open".to_owned()));
    assert!(it.is_safe() && it.all_are_void());
}

#[test]
fn a_door_open_for_loading_is_no_alarm() {
    let mut it = Plant::new(3, true);
    it.until("open", |it| it.rig.door_open);
    it.loads = 0;
    for _ in 0..600 {
        it.turn();
    }
    assert_eq!(it.alarms, Vec::<String>::new());
    assert_eq!(it.station.outer(), State::Execute);
}

#[test]
fn a_hold_finishes_the_test_before_it_rests() {
    let mut it = Plant::new(3, true);
    begin(&mut it);
    assert_eq!(it.order(Order::Command(Command::Hold)), Ok(()));
    it.until("held", |it| it.station.outer() == State::Held);
    assert_eq!(it.judged.len(), 3);
    assert!(it.rig.rack_c < 50.0 && it.landed.is_empty());
    assert_eq!(it.order(Order::Command(Command::Unhold)), Ok(()));
    it.until("a list", |it| it.station.prompt().is_some());
    it.until("open", |it| it.rig.door_open);
    it.turn();
    answer(&mut it, "batch_unload_pass", "unloaded");
    it.until("the end", |it| it.ending.is_some());
    assert_eq!(it.ending, Some(Ending::Complete));
}

#[test]
fn a_stop_while_loading_ends_without_a_test() {
    let mut it = Plant::new(3, true);
    it.until("open", |it| it.rig.door_open);
    it.loads = 0;
    assert_eq!(it.order(Order::Command(Command::Stop)), Ok(()));
    it.until("stopped", |it| it.station.outer() == State::Stopped);
    assert!(it.judged.is_empty() && it.is_safe());
}

#[test]
fn a_reset_with_a_hot_rack_cools_first() {
    let mut it = Plant::new(3, false);
    it.rig.rack_c = 100.0;
    while it.station.outer() != State::Execute {
        it.turn();
        assert!(
            it.rig.rack_c < 50.0 || !it.rig.is_unlocked(),
            "open while hot"
        );
    }
    assert!(it.rig.rack_c < 50.0 && it.alarms.is_empty());
}

#[test]
fn an_open_door_at_a_hot_rack_blocks_the_clear() {
    let mut it = Plant::new(3, true);
    begin(&mut it);
    it.rig.emergency_stop = true;
    it.until("aborted", |it| it.station.outer() == State::Aborted);
    (it.rig.emergency_stop, it.rig.door_open) = (false, true);
    it.turn();
    assert!(it.alarms.contains(&"door_open".to_owned()));
    assert!(it.order(Order::Command(Command::Clear)).is_err());
    it.rig.door_open = false;
    it.turn();
    assert_eq!(it.order(Order::Command(Command::Clear)), Ok(()));
}

#[test]
fn a_cold_rack_with_an_open_door_starts() {
    let mut it = Plant::new(3, false);
    it.rig.door_open = true;
    it.until("the end", |it| it.ending.is_some());
    assert_eq!(it.ending, Some(Ending::Complete), "{:?}", it.alarms);
}

#[test]
fn a_filled_rack_at_the_start_is_no_load() {
    let mut it = Plant::new(3, false);
    it.loads = 0;
    it.rig.contacts.extend([1, 2, 3]);
    for _ in 0..600 {
        it.turn();
    }
    assert_eq!(it.station.outer(), State::Resetting);
    it.loads = 3;
    it.until("the end", |it| it.ending.is_some());
    assert_eq!(it.judged.len(), 3);
}

#[test]
fn nothing_can_be_jogged_at_a_rack() {
    let mut it = Plant::new(3, true);
    it.loads = 0;
    it.until("execute", |it| it.station.outer() == State::Execute);
    assert_eq!(it.station.may_jog(), Err(Refused::NothingMoves));
    assert_eq!(it.order(Order::Command(Command::Stop)), Ok(()));
    it.until("stopped", |it| it.station.outer() == State::Stopped);
    assert_eq!(it.order(Order::Mode(Mode::Maintenance)), Ok(()));
    assert_eq!(it.station.may_step(), Err(Refused::NoMotionWaits));
}

/// Runs an attended lot until the rack is hot.
fn begin(it: &mut Plant) {
    it.until("asked", |it| it.station.prompt().is_some());
    answer(it, "batch_loaded", "as_seen");
    it.until_hot();
}

fn answer(it: &mut Plant, prompt: &str, choice: &str) {
    let answer = Order::Answer(prompt.to_owned(), choice.to_owned());
    assert_eq!(it.order(answer), Ok(()));
}
