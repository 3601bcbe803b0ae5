//! The nest: holds a part between its jaws, raises the probes, tests the part, hands it to the gripper.
//!
//! ```text
//! empty -> clamping -> probing -> testing -> judged -> gripping -> unclamping -> lifting -> empty
//! ```
//! The jaws close while the pusher returns; the probes rise once the jaws are closed and the pusher has left their way.
//! The fingers close while the probes go down, the jaws open only after both, and the ledger moves the part to the
//! gripper once z is up.

use super::ledger::PartRole;
use super::moves::Move;
use super::output::{Judged, NestDone, NestExit, NestJob};
use super::place::{NestId, Place};
use super::sort::Sort;
use super::trouble::Trouble;
use super::turn::Turn;
use crate::dut::Device;
use crate::dut::device::TestOrder;
use crate::dut::procedure::{Procedure, Progress};
use crate::instrument::act::{JobDone, RunnerState};
use crate::rig::bin::Bin;
use crate::rig::point::DigitalIn;
use units::{RigTime, Second};

/// Greatest number of tests of a reference part whose test is void. Its result affects every later part, and one lost
/// reply should not cost a new calibration.
const REFERENCE_TESTS: u8 = 3;

/// State of a nest.
#[derive(Debug)]
pub enum NestState {
    /// No part, jaws open, probes down.
    Empty,
    /// The jaws close, the pusher returns.
    Clamping,
    /// The probes rise.
    Probing,
    /// The part is under test.
    Testing(Procedure),
    /// The part has its verdict and waits for the gripper.
    Judged,
    /// The fingers close, the probes go down.
    Gripping,
    /// The jaws open.
    Unclamping,
    /// The part rises with z.
    Lifting,
}

/// One nest.
#[derive(Debug)]
pub struct Nest {
    /// Number of the nest.
    pub id: NestId,
    /// State of the nest.
    pub state: NestState,
}

/// Conditions under which a part is tested.
#[derive(Debug, Clone, Copy)]
pub struct TestTerms<'a> {
    /// Device under test: recipe, calibration and the values learned from parts.
    pub device: &'a Device,
    /// True when confirmation measurements repeat every result.
    pub thorough: bool,
    /// Serial number of the part while reference parts calibrate the rig; `None` otherwise.
    pub teaching: Option<&'a str>,
}

impl TestTerms<'_> {
    fn begin(&self, number: u8, now: RigTime) -> Procedure {
        let order = TestOrder {
            thorough: self.thorough,
            teaching: self.teaching,
            number,
        };
        self.device.begin(&order, now)
    }
}

/// Inputs of a nest's step in addition to [`Turn`].
pub struct NestContext<'a> {
    /// Completion of the nest's job; present in one turn only.
    pub done: Option<JobDone>,
    /// Conditions of the test.
    pub terms: TestTerms<'a>,
    /// State of the sorter.
    pub sort: &'a mut Sort,
    /// Time at which the previous part left the nest.
    pub last_left: &'a mut Option<RigTime>,
}

impl Nest {
    /// Makes an empty nest.
    pub fn new(id: NestId) -> Self {
        Self {
            id,
            state: NestState::Empty,
        }
    }

    /// Steps the nest once.
    pub fn step(&mut self, turn: &mut Turn, context: NestContext) {
        if let Some(next) = self.next(turn, context) {
            self.state = next;
        }
    }

    fn next(&mut self, turn: &mut Turn, mut context: NestContext) -> Option<NestState> {
        match &mut self.state {
            NestState::Empty => turn.ledger.holds(Place::Nest(self.id)).then(|| {
                turn.drive(Move::ClampClose);
                NestState::Clamping
            }),
            NestState::Clamping => (turn.arrived(Move::ClampClose) && turn.probes_may_rise())
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
                && turn.shows(DigitalIn::NestPresent, false))
            .then(|| lifted(self.id, turn, context)),
        }
    }

    /// Returns the test under way, if there is one.
    pub fn test(&self) -> Option<&Procedure> {
        let NestState::Testing(test) = &self.state else {
            return None;
        };
        Some(test)
    }
}

/// Raises the probes for the test of a clamped part. A part that was interrupted or is not identified goes to retest
/// without a test, with a row in the history unless it has one already.
fn clamped(id: NestId, turn: &mut Turn) -> NestState {
    let part = turn.ledger.part_mut(Place::Nest(id));
    let Some(why) = part.as_ref().and_then(|part| part.why_untested()) else {
        turn.drive(Move::ProbesUp);
        return NestState::Probing;
    };
    if let Some(part) = part.filter(|part| part.bin.is_none()) {
        part.bin = Some(Bin::RETEST);
        let judged = Judged::untested(part.clone(), why, turn.now);
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

/// Advances the test; returns true when the part has its verdict.
fn testing(
    id: NestId,
    turn: &mut Turn,
    context: &NestContext,
    test: &mut Procedure,
    done: Option<&JobDone>,
) -> bool {
    match test.step(turn.now, done, turn.image) {
        Progress::Running(RunnerState::Job(job)) => {
            assert!(turn.rig.job.is_none(), "two jobs in one turn");
            turn.rig.job = Some(NestJob { nest: id, job });
        }
        Progress::Running(RunnerState::Wait(until)) => turn.rig.wake_at = Some(until),
        Progress::Running(RunnerState::Busy | RunnerState::Done | RunnerState::Trouble(_)) => {}
        Progress::Judged => {
            if test.is_live() {
                turn.report(Trouble::SocketLive);
            } else if let Some(mismatch) = test.range_mismatch() {
                turn.report(Trouble::SupplyRange(mismatch.clone()));
            } else if let Some(again) = repeat_reason(id, turn, test) {
                turn.report(again);
                *test = context.terms.begin(test.number() + 1, turn.now);
                return testing(id, turn, context, test, None);
            }
            judged(id, turn, test);
            return true;
        }
    }
    false
}

/// Returns the trouble to report before a reference part with a void test is tested again; `None` when there is no
/// further test.
fn repeat_reason(id: NestId, turn: &Turn, test: &Procedure) -> Option<Trouble> {
    let PartRole::Reference(serial) = &turn.ledger.part(Place::Nest(id))?.role else {
        return None;
    };
    // While overshoots are learned, a complete test may be inconclusive; it needs no repetition.
    let why = test.why_void()?;
    (test.number() < REFERENCE_TESTS)
        .then(|| Trouble::ReferenceRepeated(serial.clone(), why.clone()))
}

fn judged(id: NestId, turn: &mut Turn, test: &mut Procedure) {
    let verdict = test.verdict();
    let judgements = test.judgements();
    let now = turn.now;
    let Some(part) = turn.ledger.part_mut(Place::Nest(id)) else {
        panic!("the judged part is not in its nest");
    };
    part.test = part.probed_at.map(|at| Second(now.since(at).as_seconds()));
    part.bin = Some(match part.role {
        PartRole::Reference(_) => Bin::RETEST,
        PartRole::Lot(_) => verdict.bin(),
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
        turn.parts.left.push(NestExit {
            ordinal: part.ordinal,
            cycle,
        });
    }
    let before = context.last_left.replace(turn.now);
    assert!(before <= Some(turn.now), "the previous part left later");
    context.sort.carry();
    NestState::Empty
}

/// Takes the completion of this nest's job out of `job`; leaves that of another nest there.
pub(super) fn answer_for(id: NestId, job: &mut Option<NestDone>) -> Option<JobDone> {
    job.take_if(|job| job.nest == id).map(|job| job.done)
}
