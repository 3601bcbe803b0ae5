//! Nest: clamp the part, bring the probes, test it, hand it to the gripper.
//!
//! ```text
//! empty -> clamping -> probing -> testing -> judged -> gripping -> unclamping -> lifting -> empty
//! ```
//! Jaws close while the pusher goes back; probes rise only after it is back. The fingers close while the
//! probes go down, the jaws open only when both are done, and the part changes hands when z is up.

use super::ledger::Kind;
use super::moves::Move;
use super::place::{NestId, Place};
use super::sort::Sort;
use super::trouble::Trouble;
use super::turn::Turn;
use super::wants::{Judged, Left, NestDone, NestJob};
use crate::dut::Device;
use crate::dut::device::TestOrder;
use crate::dut::procedure::{Procedure, Progress};
use crate::instrument::act::{Doing, JobDone};
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use units::{RigTime, Second};

/// A golden part that could not be judged is tested so often in all: what it teaches holds for every part after it, and
/// one reset status that was lost, or one reply refused, is no reason to calibrate anew.
const GOLDEN_TESTS: u8 = 3;

/// Where a nest stands.
#[derive(Debug)]
pub enum NestState {
    /// No part, jaws open, probes down.
    Empty,
    /// Jaws close, pusher goes back.
    Clamping,
    /// Probes rise.
    Probing,
    /// The part is under test.
    Testing(Procedure),
    /// Judged; waits for the gripper.
    Judged,
    /// Fingers close, probes go down.
    Gripping,
    /// Jaws open.
    Unclamping,
    /// The part goes up with z.
    Lifting,
}

/// One nest.
#[derive(Debug)]
pub struct Nest {
    /// Which one.
    pub id: NestId,
    /// Where it stands.
    pub state: NestState,
}

/// What the part in the nest is tested by.
#[derive(Debug, Clone, Copy)]
pub struct TestTerms<'a> {
    /// The kind under test: recipe, calibration and what parts have taught.
    pub device: &'a Device,
    /// Every result is a mean of the slow strategy.
    pub thorough: bool,
    /// Serial number of the part, when it is a golden one that teaches.
    pub teaching: Option<&'a str>,
}

impl TestTerms<'_> {
    /// Begins the test with this number of the part in the nest.
    fn begin(&self, number: u8, now: RigTime) -> Procedure {
        let order = TestOrder {
            thorough: self.thorough,
            teaching: self.teaching,
            number,
        };
        self.device.begin(&order, now)
    }
}

/// What a nest needs beside the turn.
pub struct NestContext<'a> {
    /// Answer to the job of this nest, once.
    pub done: Option<JobDone>,
    /// What to test by.
    pub terms: TestTerms<'a>,
    /// State of the sorter.
    pub sort: &'a mut Sort,
    /// When the part before left the nest.
    pub last_left: &'a mut Option<RigTime>,
}

impl Nest {
    /// An empty one.
    pub fn new(id: NestId) -> Self {
        Self {
            id,
            state: NestState::Empty,
        }
    }

    /// One turn.
    pub fn step(&mut self, turn: &mut Turn, context: NestContext) {
        if let Some(next) = self.next(turn, context) {
            self.state = next;
        }
    }

    /// The state that follows, when it is another one.
    fn next(&mut self, turn: &mut Turn, mut context: NestContext) -> Option<NestState> {
        match &mut self.state {
            NestState::Empty => turn.ledger.holds(Place::Nest(self.id)).then(|| {
                turn.drive(Move::ClampClose);
                NestState::Clamping
            }),
            NestState::Clamping => (turn.arrived(Move::ClampClose)
                && turn.arrived(Move::PusherRetract))
            .then(|| clamped(self.id, turn)),
            NestState::Probing => turn
                .arrived(Move::ProbesUp)
                .then(|| begin(self.id, turn, &context)),
            NestState::Testing(test) => {
                let done = context.done.take();
                testing(self.id, turn, &context, test, done.as_ref()).then_some(NestState::Judged)
            }
            NestState::Judged => (context.sort.is_at_part(turn) && !turn.resting).then(|| {
                turn.drive(Move::ProbesDown);
                turn.drive(Move::GripperClose);
                NestState::Gripping
            }),
            NestState::Gripping => {
                (turn.arrived(Move::ProbesDown) && turn.arrived(Move::GripperClose)).then(|| {
                    turn.drive(Move::ClampOpen);
                    NestState::Unclamping
                })
            }
            NestState::Unclamping => turn.arrived(Move::ClampOpen).then(|| {
                turn.drive(Move::SortUp);
                NestState::Lifting
            }),
            NestState::Lifting => (turn.arrived(Move::SortUp)
                && turn.seen(DigitalIn::NestPresent, false))
            .then(|| lifted(self.id, turn, context)),
        }
    }

    /// The test under way, for screens.
    pub fn test(&self) -> Option<&Procedure> {
        match &self.state {
            NestState::Testing(test) => Some(test),
            NestState::Empty
            | NestState::Clamping
            | NestState::Probing
            | NestState::Judged
            | NestState::Gripping
            | NestState::Unclamping
            | NestState::Lifting => None,
        }
    }
}

/// A part that was interrupted is not tested; it goes on to retest, with a row when it has none yet.
fn clamped(id: NestId, turn: &mut Turn) -> NestState {
    let part = turn.ledger.part_mut(Place::Nest(id));
    let interrupted = part.as_ref().and_then(|part| part.interrupted.clone());
    let Some(why) = interrupted else {
        turn.drive(Move::ProbesUp);
        return NestState::Probing;
    };
    if let Some(part) = part.filter(|part| part.bin.is_none()) {
        part.bin = Some(Bin::RETEST);
        let judged = Judged::interrupted(part.clone(), &why, turn.now);
        turn.parts.judged.push(judged);
    }
    NestState::Judged
}

fn begin(id: NestId, turn: &mut Turn, context: &NestContext) -> NestState {
    assert!(turn.ledger.holds(Place::Nest(id)), "a test without a part");
    if let Some(part) = turn.ledger.part_mut(Place::Nest(id)) {
        part.probed_at = Some(turn.now);
    }
    let mut test = context.terms.begin(1, turn.now);
    if testing(id, turn, context, &mut test, None) {
        return NestState::Judged;
    }
    NestState::Testing(test)
}

/// True when the part is judged.
fn testing(
    id: NestId,
    turn: &mut Turn,
    context: &NestContext,
    test: &mut Procedure,
    done: Option<&JobDone>,
) -> bool {
    match test.step(turn.now, done, turn.image) {
        Progress::Doing(Doing::Job(job)) => {
            assert!(turn.rig.job.is_none(), "two jobs in one turn");
            turn.rig.job = Some(NestJob { nest: id, job });
        }
        Progress::Doing(Doing::Wait(until)) => turn.rig.wake_at = Some(until),
        Progress::Doing(Doing::Busy | Doing::Done | Doing::Trouble(_)) => {}
        Progress::Judged => {
            if let Some(again) = worth_another(id, turn, test) {
                turn.tell(again);
                *test = context.terms.begin(test.number() + 1, turn.now);
                return testing(id, turn, context, test, None);
            }
            judged(id, turn, test);
            return true;
        }
    }
    false
}

/// What to tell before a golden part is tested again, if it is.
fn worth_another(id: NestId, turn: &Turn, test: &Procedure) -> Option<Trouble> {
    let Kind::Golden(serial) = &turn.ledger.part(Place::Nest(id))?.kind else {
        return None;
    };
    // What ran to its end proves nothing either while the lags are being taught, and is all that is wanted.
    let why = test.why_void()?;
    (test.number() < GOLDEN_TESTS).then(|| Trouble::GoldenRepeated(serial.clone(), why.to_string()))
}

fn judged(id: NestId, turn: &mut Turn, test: &mut Procedure) {
    let verdict = test.verdict();
    let judgements = test.judgements();
    let now = turn.now;
    let Some(part) = turn.ledger.part_mut(Place::Nest(id)) else {
        panic!("a part was judged that is not in its nest");
    };
    part.test = part.probed_at.map(|at| Second(now.since(at).as_seconds()));
    part.bin = Some(match part.kind {
        Kind::Golden(_) => Bin::RETEST,
        Kind::Lot(_) => verdict.bin(),
    });
    turn.parts.judged.push(Judged {
        part: part.clone(),
        verdict,
        judgements,
        record: test.take_record(),
        at: now,
    });
}

fn lifted(id: NestId, turn: &mut Turn, context: NestContext) -> NestState {
    turn.ledger.lift(id);
    if let Some(part) = turn.ledger.part(Place::Gripper) {
        assert!(part.bin.is_some(), "an unjudged part leaves its nest");
        let cycle = context
            .last_left
            .map(|before| Second(turn.now.since(before).as_seconds()));
        turn.parts.left.push(Left {
            ordinal: part.ordinal,
            cycle,
        });
    }
    let before = context.last_left.replace(turn.now);
    assert!(before <= Some(turn.now), "the part before left later");
    context.sort.carry();
    NestState::Empty
}

/// The answer to the job of this nest; another nest's answer stays for that one.
pub(super) fn answer_for(id: NestId, job: &mut Option<NestDone>) -> Option<JobDone> {
    job.take_if(|job| job.nest == id).map(|job| job.done)
}
