//! The batch: a person fills the sockets of a rack, all parts are tested together, the person unloads one list per bin.
//!
//! ```text
//! loading -> locking -> testing -> cooling -> unloading -> loading
//! ```
//! Signals: the contact of each socket, the door (closed, locked), the thermometer in the rack. A closed contact shows
//! a part. Nothing shows a part whose contact is open: its socket looks empty. A person therefore says whether all
//! sockets are filled, and must take such parts out unprompted.
//!
//! Normal sequence: in [`Phase::Loading`] the door is unlocked. The phase ends when the door stays closed; with a
//! screen, the person must also answer the prompt. When the door is locked, the parts get their numbers; from then on
//! they have rows. The kind of device tests them. The rack cools; the door is unlocked when the rack itself is cool,
//! not only the air, which cools faster. A list opens once the rows of all its parts are on the disk: the person takes
//! out its parts and confirms it; without a screen, an opened door and open contacts confirm it. Loading begins again
//! only when every contact is open, so that no old part passes for a new one.
//!
//! Troubles: the door does not lock, the rack has no temperature or its reading does not follow the air, the rack cools
//! too slowly, the test takes too long or has met trouble of the rig, no contact is closed in a rack that was loaded
//! without a screen.
//!
//! After safe outputs or a restart: a rack without a reading counts as hot. [`Batch::home`] cools it, the door locked.
//! Then parts of an interrupted batch leave by the list for retest, and parts of an earlier run without a list.
//!
//! Not handled here: heater, vent and fan are points of the kind of device, which drives them in its test and in
//! [`crate::dut::device::DeviceUnderTest::cooling`]. The station has the reactions to an open door and the emergency
//! stop.

mod ended;
mod loading;
mod rack_trust;
mod rack_watch;
mod testing;
#[cfg(test)]
mod tests;
mod turn;
mod unloading;

use super::ledger::BatchSocket;
use super::output::NestDone;
use super::place::Place;
use super::trouble::Trouble;
use crate::dut::Device;
use crate::dut::batch::{BatchCurve, BatchOrder, BatchTest};
use crate::dut::batch_shown::BatchShown;
use crate::dut::prompt::Prompt;
use crate::instrument::act::JobDone;
use crate::rig::point::{DigitalIn, DigitalOut};
use crate::rig::rack::Rack;
use loading::Loading;
use rack_trust::RackTrust;
use rack_watch::RackWatch;
pub use turn::BatchTurn;
use units::{RigTime, Span};
use unloading::Unloading;

/// Time within which the closed door must report that it is locked.
const LOCKS: Span = Span::ms(5_000);
/// Cooling time after which an alarm asks a person to check fan and vent; cooling goes on.
const COOLS: Span = Span::ms(3_600_000);

/// Phase of a batch.
#[derive(Debug)]
pub enum Phase {
    /// A person fills the sockets.
    Loading(Loading),
    /// The closed door is locking.
    Locking {
        /// Time at which the rack was loaded.
        since: RigTime,
        /// Sockets that hold a part.
        sockets: Vec<u16>,
    },
    /// The kind of device tests the parts.
    Testing {
        /// Time at which the test began.
        since: RigTime,
        /// The test.
        test: Box<dyn BatchTest>,
    },
    /// The rack cools behind the locked door.
    Cooling {
        /// Time at which the cooling began.
        since: RigTime,
        /// True once [`Trouble::CoolsSlowly`] is reported.
        reported: bool,
    },
    /// A person unloads the rack, list by list.
    Unloading(Unloading),
}

impl Phase {
    /// Returns the name that pages know.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Loading(_) => "loading",
            Self::Locking { .. } => "locking",
            Self::Testing { .. } => "testing",
            Self::Cooling { .. } => "cooling",
            Self::Unloading(_) => "unloading",
        }
    }
}

/// State of the rack and its batch.
#[derive(Debug)]
pub struct Batch {
    rack: Rack,
    phase: Phase,
    /// Number of batches that have begun.
    number: u64,
    watch: RackWatch,
    trust: RackTrust,
    /// State of the lock and of the three lamps as commanded; `None` when safe outputs have changed them.
    shown: Option<[bool; 4]>,
    /// Outcome of the last job, until the next step takes it.
    done: Option<JobDone>,
    /// The prompt that [`Self::take_opened`] returned last.
    announced: Option<Prompt>,
    /// What pages show of the last test that has ended; `None` before it.
    last: Option<BatchShown>,
    /// Curve of a test that has ended, and when, until the next step hands it over.
    ended: Option<(BatchCurve, RigTime)>,
}

impl Batch {
    /// Makes the batch of a rack in an unknown state.
    pub fn new(rack: Rack) -> Self {
        Self {
            watch: RackWatch::new(&rack),
            trust: RackTrust::default(),
            rack,
            phase: Phase::Loading(Loading::default()),
            number: 0,
            shown: None,
            done: None,
            announced: None,
            last: None,
            ended: None,
        }
    }

    /// Returns the rack.
    pub fn rack(&self) -> &Rack {
        &self.rack
    }

    /// Returns the phase.
    pub fn phase(&self) -> &Phase {
        &self.phase
    }

    /// Returns the number of batches that have begun.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Returns what pages show of the test under way, else of the last one; `None` before the first one.
    pub fn shown(&self) -> Option<BatchShown> {
        let present = self.test().map(BatchTest::shown);
        present.or_else(|| self.last.clone())
    }

    /// Returns the prompt that waits for an answer, if there is one.
    pub fn prompt(&self) -> Option<&Prompt> {
        match &self.phase {
            Phase::Loading(loading) => loading.prompt(),
            Phase::Unloading(unloading) => unloading.prompt(),
            Phase::Locking { .. } | Phase::Testing { .. } | Phase::Cooling { .. } => None,
        }
    }

    /// Returns the open prompt, once after it has opened.
    pub fn take_opened(&mut self) -> Option<Prompt> {
        let open = self.prompt().cloned();
        if open == self.announced {
            return None;
        }
        self.announced = open.clone();
        open
    }

    /// Answers the open prompt; returns false unless it is open and has this choice.
    pub fn answer(&mut self, prompt: &str, choice: &str) -> bool {
        match &mut self.phase {
            Phase::Loading(loading) => loading.answer(prompt, choice),
            Phase::Unloading(unloading) => unloading.answer(prompt, choice),
            Phase::Locking { .. } | Phase::Testing { .. } | Phase::Cooling { .. } => false,
        }
    }

    /// Returns true when an open door is trouble: the test is under way, or the rack may be hot.
    pub fn needs_closed_door(&self) -> bool {
        match &self.phase {
            Phase::Loading(_) | Phase::Locking { .. } | Phase::Unloading(_) => false,
            Phase::Testing { .. } => true,
            Phase::Cooling { .. } => self.watch.may_be_hot(),
        }
    }

    /// Returns true in the phases in which a person works at the rack.
    pub fn is_at_rest(&self) -> bool {
        match &self.phase {
            Phase::Loading(_) | Phase::Unloading(_) => true,
            Phase::Locking { .. } | Phase::Testing { .. } | Phase::Cooling { .. } => false,
        }
    }

    /// Returns true while a person loads the rack: no part in it has a number yet.
    pub fn is_empty(&self) -> bool {
        matches!(self.phase, Phase::Loading(_))
    }

    /// Returns the test under way, if there is one.
    pub fn test(&self) -> Option<&dyn BatchTest> {
        match &self.phase {
            Phase::Testing { test, .. } => Some(test.as_ref()),
            Phase::Loading(_)
            | Phase::Locking { .. }
            | Phase::Cooling { .. }
            | Phase::Unloading(_) => None,
        }
    }

    /// Records that all outputs are safe: the test has ended, the door is locked, nothing cools.
    pub fn cut_off(&mut self, now: RigTime) {
        self.watch = match &self.phase {
            Phase::Testing { test, .. } => {
                self.last = Some(test.shown());
                self.ended = test.curve().map(|it| (it, now));
                RackWatch::new(&self.rack)
            }
            Phase::Loading(_)
            | Phase::Locking { .. }
            | Phase::Cooling { .. }
            | Phase::Unloading(_) => self.watch.cut_off(&self.rack),
        };
        self.trust.pause();
        self.phase = Phase::Cooling {
            since: now,
            reported: false,
        };
        (self.shown, self.done) = (None, None);
    }

    /// Begins to home: the rack cools, in whatever phase it was.
    pub fn begin_home(&mut self, now: RigTime, device: &Device) {
        self.cut_off(now);
        self.watch.await_reading(now);
        self.watch.then(device.cooling(true));
    }

    /// Forgets how long the door has been closed, because the station does not watch it while it rests.
    pub fn rest(&mut self) {
        if let Phase::Loading(loading) = &mut self.phase {
            loading.rest();
        }
    }

    /// Performs a turn of homing; returns true when the rack is cool and holds no part of an interrupted batch.
    pub fn home(&mut self, turn: &mut BatchTurn) -> bool {
        turn.begins = false;
        self.step(turn);
        self.is_empty()
    }

    /// Takes the outcome of the job under way, in any state of the station: a job may begin in one state and end in
    /// another.
    pub fn deliver(&mut self, job: Option<NestDone>) {
        self.done = job.map(|job| job.done).or(self.done.take());
    }

    /// Performs a turn.
    pub fn step(&mut self, turn: &mut BatchTurn) {
        let done = self.done.take();
        match &self.phase {
            Phase::Testing { .. } | Phase::Cooling { .. } => {
                self.watch.compare(&mut self.trust, turn);
            }
            // The fan is off.
            Phase::Loading(_) | Phase::Locking { .. } | Phase::Unloading(_) => self.trust.pause(),
        }
        let next = match &mut self.phase {
            Phase::Testing { since, test } => {
                let since = *since;
                let next = testing::advance(turn, since, test.as_mut(), done.as_ref());
                if next.is_some() {
                    self.last = Some(test.shown());
                    self.ended = test.curve().map(|it| (it, turn.now));
                }
                next
            }
            Phase::Loading(_)
            | Phase::Locking { .. }
            | Phase::Cooling { .. }
            | Phase::Unloading(_) => {
                let idle = self.watch.step(turn, done.as_ref());
                self.at_rest(turn, idle)
            }
        };
        self.hand_over(turn);
        if let Some(next) = next {
            self.enter(next, turn);
        }
        self.show(turn);
    }

    /// Performs a turn without a test; `idle` is true when no job is under way.
    fn at_rest(&mut self, turn: &mut BatchTurn, idle: bool) -> Option<Phase> {
        let is_cool = self.watch.is_cool(&self.trust, turn);
        self.watch.check(turn);
        match &mut self.phase {
            Phase::Loading(loading) => {
                let sockets = match turn.experiment {
                    Some(_) => loading.is_shut(turn).then(Vec::new)?,
                    None => loading.step(turn, &self.rack)?,
                };
                let since = turn.now;
                Some(Phase::Locking { since, sockets })
            }
            Phase::Locking { since, sockets } => {
                let (since, sockets) = (*since, std::mem::take(sockets));
                self.locking(turn, idle, since, sockets)
            }
            Phase::Cooling { since, reported } => {
                let took = turn.now.since(*since);
                if !*reported && took > COOLS && !self.trust.is_in_doubt() {
                    *reported = true;
                    turn.trouble.push(Trouble::CoolsSlowly(COOLS));
                }
                let is_unlocked = turn.input(DigitalIn::DoorLocked) == Some(false);
                if is_unlocked && took > LOCKS && self.watch.may_be_hot() {
                    turn.trouble.push(Trouble::DoorNotLocked);
                }
                is_cool.then(|| Phase::Unloading(Unloading::default()))
            }
            Phase::Unloading(unloading) => {
                let is_done = unloading.step(turn, &self.rack);
                is_done.then(|| Phase::Loading(Loading::begin(turn)))
            }
            Phase::Testing { .. } => None,
        }
    }

    /// Waits until the door is locked, then begins the test.
    fn locking(
        &mut self,
        turn: &mut BatchTurn,
        idle: bool,
        since: RigTime,
        sockets: Vec<u16>,
    ) -> Option<Phase> {
        let is_locked = turn.input(DigitalIn::DoorLocked) == Some(true)
            && turn.input(DigitalIn::DoorClosed) == Some(true)
            && turn.image.input_at(DigitalIn::DoorLocked) > Some(since);
        if turn.input(DigitalIn::DoorClosed) == Some(false) {
            return Some(Phase::Loading(Loading::begin(turn)));
        }
        if is_locked && idle {
            return Some(self.begin(turn, sockets));
        }
        if turn.now.since(since) > LOCKS {
            turn.trouble.push(Trouble::DoorNotLocked);
        }
        self.phase = Phase::Locking { since, sockets };
        None
    }

    /// Numbers the parts and begins their test, or begins an experiment without parts.
    fn begin(&mut self, turn: &mut BatchTurn, sockets: Vec<u16>) -> Phase {
        if let Some(what) = turn.experiment {
            return Phase::Testing {
                since: turn.now,
                test: turn.device.begin_experiment(what, turn.now),
            };
        }
        assert!(!sockets.is_empty(), "a batch without parts");
        self.number += 1;
        for socket in &sockets {
            let place = Place::Socket(*socket);
            let (batch, socket) = (self.number, *socket);
            turn.ledger.fill_socket(BatchSocket { batch, socket }, None);
            turn.serials.assign(turn.ledger, place);
            if let Some(part) = turn.ledger.part_mut(place) {
                part.probed_at = Some(turn.now);
            }
        }
        let number = self.number;
        let order = BatchOrder { sockets, number };
        Phase::Testing {
            since: turn.now,
            test: turn.device.begin_batch(&order, turn.now),
        }
    }

    fn enter(&mut self, next: Phase, turn: &mut BatchTurn) {
        turn.rig.wake_at = Some(turn.now);
        match &next {
            Phase::Cooling { .. } => {
                self.watch = RackWatch::new(&self.rack);
                self.watch.then(turn.device.cooling(true));
            }
            Phase::Unloading(_) => self.watch.then(turn.device.cooling(false)),
            Phase::Loading(_) | Phase::Locking { .. } | Phase::Testing { .. } => {}
        }
        self.phase = next;
    }

    /// Sets lock and lamps. The door is unlocked only while a person works at the rack, and only when the last
    /// temperature of the rack is fresh, below its limit and not in doubt.
    fn show(&mut self, turn: &mut BatchTurn) {
        let is_cool = self.watch.is_cool(&self.trust, turn);
        let (loads, unloads) = match &self.phase {
            Phase::Loading(_) => (true, false),
            Phase::Unloading(_) => (false, true),
            Phase::Locking { .. } | Phase::Testing { .. } | Phase::Cooling { .. } => (false, false),
        };
        let states = [
            is_cool && (loads || unloads),
            is_cool && loads,
            !loads && !unloads,
            is_cool && unloads,
        ];
        let before = self.shown.replace(states);
        let points = [
            DigitalOut::DoorLockRelease,
            DigitalOut::LampReady,
            DigitalOut::LampTesting,
            DigitalOut::LampUnload,
        ];
        for (index, (point, on)) in points.into_iter().zip(states).enumerate() {
            if before.is_none_or(|before| before[index] != on) {
                turn.rig.outputs.push((point, on));
            }
        }
    }
}
