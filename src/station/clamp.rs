//! Nest: clamp the part, bring the probes, test it, hand it to the gripper.
//!
//! ```text
//! empty -> clamping -> probing -> testing -> judged -> gripping -> unclamping -> lifting -> empty
//! ```
//! Jaws close while the pusher goes back; probes rise only after it is back. The fingers close while the
//! probes go down, the jaws open only when both are done, and the part changes hands when z is up.

use super::moves::Move;
use super::sort::Sort;
use super::trouble::Alarm;
use super::turn::Turn;
use super::wants::{Judged, Left};
use crate::dut::em_relay::measure::{Bench, Progress, Stop, Test};
use crate::dut::verdict::Bin;
use crate::instrument::act::{Doing, JobDone};
use crate::rig::point::DigitalIn;
use crate::station::ledger::Kind;
use crate::units::{RigTime, Second};

/// A golden part that could not be judged is tested so often in all: what it teaches holds for every part after it, and
/// one reset status that was lost, or one reply refused, is no reason to calibrate anew.
const GOLDEN_TESTS: u8 = 3;

/// Where the nest stands.
#[derive(Debug)]
pub enum Clamp {
    /// No part, jaws open, probes down.
    Empty,
    /// Jaws close, pusher goes back.
    Clamping,
    /// Probes rise.
    Probing,
    /// The part is under test.
    Testing(Box<Test>),
    /// Judged; waits for the gripper.
    Judged,
    /// Fingers close, probes go down.
    Gripping,
    /// Jaws open.
    Unclamping,
    /// The part goes up with z.
    Lifting,
}

/// What the nest needs beside the turn.
pub struct Beside<'a> {
    /// Measuring line's answer, once.
    pub job: Option<JobDone>,
    /// What to test by.
    pub bench: &'a Bench,
    /// State of the sorter.
    pub sort: &'a mut Sort,
    /// When the part before left the nest.
    pub last_left: &'a mut Option<RigTime>,
}

impl Clamp {
    /// One turn.
    pub fn step(self, turn: &mut Turn, beside: Beside) -> Clamp {
        match self {
            Clamp::Empty if turn.ledger.nest.is_some() => {
                turn.drive(Move::ClampClose);
                Clamp::Clamping
            }
            Clamp::Empty => Clamp::Empty,
            Clamp::Clamping
                if turn.arrived(Move::ClampClose) && turn.arrived(Move::PusherRetract) =>
            {
                clamped(turn, beside)
            }
            Clamp::Clamping => Clamp::Clamping,
            Clamp::Probing if turn.arrived(Move::ProbesUp) => begin(turn, beside),
            Clamp::Probing => Clamp::Probing,
            Clamp::Testing(test) => testing(turn, beside, test),
            Clamp::Judged if beside.sort.is_at_part(turn) && !turn.resting => {
                turn.drive(Move::ProbesDown);
                turn.drive(Move::GripperClose);
                Clamp::Gripping
            }
            Clamp::Judged => Clamp::Judged,
            Clamp::Gripping
                if turn.arrived(Move::ProbesDown) && turn.arrived(Move::GripperClose) =>
            {
                turn.drive(Move::ClampOpen);
                Clamp::Unclamping
            }
            Clamp::Gripping => Clamp::Gripping,
            Clamp::Unclamping if turn.arrived(Move::ClampOpen) => {
                turn.drive(Move::SortUp);
                Clamp::Lifting
            }
            Clamp::Unclamping => Clamp::Unclamping,
            Clamp::Lifting
                if turn.arrived(Move::SortUp) && turn.seen(DigitalIn::NestPresent, false) =>
            {
                lifted(turn, beside)
            }
            Clamp::Lifting => Clamp::Lifting,
        }
    }

    /// The test under way, for screens.
    pub fn test(&self) -> Option<&Test> {
        match self {
            Clamp::Testing(test) => Some(test),
            Clamp::Empty
            | Clamp::Clamping
            | Clamp::Probing
            | Clamp::Judged
            | Clamp::Gripping
            | Clamp::Unclamping
            | Clamp::Lifting => None,
        }
    }
}

/// A part that was interrupted is not tested; it goes on to retest, with a row when it has none yet.
fn clamped(turn: &mut Turn, beside: Beside) -> Clamp {
    let interrupted = turn
        .ledger
        .nest
        .as_ref()
        .and_then(|part| part.interrupted.clone());
    let Some(why) = interrupted else {
        turn.drive(Move::ProbesUp);
        return Clamp::Probing;
    };
    if let Some(part) = turn.ledger.nest.as_mut().filter(|part| part.bin.is_none()) {
        part.bin = Some(Bin::RETEST);
        let judged = Judged::interrupted(part.clone(), &why, beside.bench, turn.now);
        turn.wants.judged.push(judged);
    }
    Clamp::Judged
}

fn begin(turn: &mut Turn, beside: Beside) -> Clamp {
    if let Some(part) = &mut turn.ledger.nest {
        part.probed_at = Some(turn.now);
    }
    let test = Test::begin(beside.bench.clone(), turn.now);
    begun(turn, beside, test)
}

fn begun(turn: &mut Turn, beside: Beside, test: Test) -> Clamp {
    testing(
        turn,
        Beside {
            job: None,
            ..beside
        },
        Box::new(test),
    )
}

fn testing(turn: &mut Turn, beside: Beside, mut test: Box<Test>) -> Clamp {
    match test.step(turn.now, beside.job.as_ref(), turn.image) {
        Progress::Doing(Doing::Job(job)) => turn.wants.job = Some(job),
        Progress::Doing(Doing::Wait(until)) => turn.wants.wake_at = Some(until),
        Progress::Doing(Doing::Busy | Doing::Done | Doing::Trouble(_)) => {}
        Progress::Judged => {
            if let Some(again) = worth_another(turn, &test) {
                turn.alarm(again);
                let fresh = Test::begin(beside.bench.clone(), turn.now);
                return begun(turn, beside, fresh.another(test.number() + 1));
            }
            judged(turn, beside.bench, *test);
            return Clamp::Judged;
        }
    }
    Clamp::Testing(test)
}

/// What to tell before a golden part is tested again, if it is.
fn worth_another(turn: &Turn, test: &Test) -> Option<Alarm> {
    let Kind::Golden(serial) = &turn.ledger.nest.as_ref()?.kind else {
        return None;
    };
    // What ran to its end proves nothing either while the lags are being taught, and is all that is wanted.
    let (Stop::Void(why) | Stop::Trouble(why)) = test.findings.why_stopped()? else {
        return None;
    };
    (test.number() < GOLDEN_TESTS).then(|| Alarm::golden_repeated(serial, why))
}

fn judged(turn: &mut Turn, bench: &Bench, test: Test) {
    let verdict = test.verdict();
    let judgements = test.judgements();
    let now = turn.now;
    let Some(part) = &mut turn.ledger.nest else {
        return;
    };
    part.test = part.probed_at.map(|at| Second(now.since(at).as_seconds()));
    part.bin = Some(match part.kind {
        Kind::Golden(_) => Bin::RETEST,
        Kind::Lot(_) => verdict.bin(),
    });
    turn.wants.judged.push(Judged {
        part: part.clone(),
        verdict,
        judgements,
        findings: test.findings,
        bench: bench.clone(),
        at: now,
    });
}

fn lifted(turn: &mut Turn, beside: Beside) -> Clamp {
    turn.ledger.lift();
    if let Some(part) = &turn.ledger.gripper {
        let cycle = beside
            .last_left
            .map(|before| Second(turn.now.since(before).as_seconds()));
        turn.wants.left.push(Left {
            ordinal: part.ordinal,
            cycle,
        });
    }
    *beside.last_left = Some(turn.now);
    beside.sort.carry();
    Clamp::Empty
}
