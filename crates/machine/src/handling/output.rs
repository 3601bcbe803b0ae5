//! Commands that a turn gives to the rig, and events of parts in that turn.

use super::ledger::Part;
use super::moves::Move;
use super::place::NestId;
use crate::dut::batch::BatchCurve;
use crate::dut::experiment::Found;
use crate::dut::{Characteristic, Judgement, Reason, TestRecord, Verdict};
use crate::instrument::act::{Job, JobDone};
use crate::rig::bin::Bin;
use crate::rig::point::{DigitalIn, DigitalInput, DigitalOut};
use units::{RigTime, Second};

/// A job of the measuring line on the part in one nest.
#[derive(Debug, Clone, PartialEq)]
pub struct NestJob {
    /// Nest of the measured part.
    pub nest: NestId,
    /// The job.
    pub job: Job,
}

/// Completion of a [`NestJob`].
#[derive(Debug, Clone, PartialEq)]
pub struct NestDone {
    /// Nest that requested the job.
    pub nest: NestId,
    /// Outcome of the job.
    pub done: JobDone,
}

/// A motion by hand; if the guard refuses it, the refusal becomes the answer to its order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Jog {
    /// The motion.
    pub movement: Move,
    /// Index of the order's answer among the answers of the turn.
    pub answer: usize,
}

/// Commands to the rig.
#[derive(Debug, Default)]
pub struct Commands {
    /// Motions that the guard must clear and the rig then carries out.
    pub motions: Vec<Move>,
    /// A motion by hand.
    pub jog: Option<Jog>,
    /// Digital outputs that move nothing, with their values.
    pub outputs: Vec<(DigitalOut, bool)>,
    /// Job for the measuring line; one at a time.
    pub job: Option<NestJob>,
    /// Beam whose event counter the scan polls.
    pub beam: Option<DigitalInput>,
    /// End sensors of the motions that may arrive now: the scan polls their modules most often and without rest.
    pub awaited: Vec<DigitalIn>,
    /// True while an actuator deviates and no alarm explains it: the cycle then reads the reset status of the modules
    /// (restart check).
    pub restart_check: bool,
    /// True to set all outputs to their safe values immediately.
    pub safe: bool,
    /// True to discard failed writes and verify every module again.
    pub verify: bool,
    /// Latest time at which the next turn must begin.
    pub wake_at: Option<RigTime>,
}

/// Events of parts, for the history.
#[derive(Debug, Default)]
pub struct PartEvents {
    /// Parts judged in this turn.
    pub judged: Vec<Judged>,
    /// Judged parts interrupted on their way to the bin.
    pub interrupted: Vec<Interrupted>,
    /// Parts that left a nest in this turn.
    pub left: Vec<NestExit>,
    /// Parts that a beam confirmed in this turn.
    pub landed: Vec<Landed>,
    /// What an experiment without parts has found in this turn.
    pub found: Option<Found>,
    /// Batch whose test has ended, with its curve.
    pub batch: Option<Box<EndedBatch>>,
}

/// A batch whose test has ended.
#[derive(Debug, Clone, PartialEq)]
pub struct EndedBatch {
    /// Number of the batch in its run, from 1.
    pub number: u64,
    /// What the test has recorded.
    pub curve: BatchCurve,
    /// Time at which the test ended.
    pub ended: RigTime,
    /// Sockets with the numbers of their parts.
    pub parts: Vec<(u16, u64)>,
}

/// A judged part on its way to the history.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Role and numbers of the part, with test time and bin.
    pub part: Part,
    /// Verdict of the part.
    pub verdict: Verdict,
    /// Each result against its limit.
    pub judgements: Vec<(Characteristic, Judgement)>,
    /// Results, with the replies from which they came.
    pub record: TestRecord,
    /// Time of the verdict.
    pub at: RigTime,
}

impl Judged {
    /// Makes the record of a part without a complete test.
    pub fn untested(part: Part, why: Reason, at: RigTime) -> Self {
        Self {
            part,
            verdict: Verdict::Void(vec![why]),
            judgements: Vec::new(),
            record: TestRecord::default(),
            at,
        }
    }
}

/// A judged part that goes to retest after an interruption.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interrupted {
    /// Ordinal of the part.
    pub ordinal: u64,
    /// Reason for the interruption.
    pub why: String,
}

/// A part that the beam of its bin has confirmed.
#[derive(Debug, Clone)]
pub struct Landed {
    /// Role and numbers of the part.
    pub part: Part,
    /// Bin whose beam counted the part.
    pub bin: Bin,
    /// Time of the count.
    pub at: RigTime,
}

/// A part that has left the nest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NestExit {
    /// Ordinal of the part.
    pub ordinal: u64,
    /// Time since the previous part left the nest; `None` for the first part.
    pub cycle: Option<Second>,
}
