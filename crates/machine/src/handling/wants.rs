//! What a turn asks of the rig, and what it tells of parts.

use super::ledger::Part;
use super::moves::Move;
use super::place::NestId;
use crate::dut::{Characteristic, Judgement, Reason, TestRecord, Verdict};
use crate::instrument::act::{Job, JobDone};
use crate::rig::bin::Bin;
use crate::rig::point::{DigitalInput, DigitalOut};
use units::{RigTime, Second};

/// Work for the measuring line on the part of one nest.
#[derive(Debug, Clone, PartialEq)]
pub struct NestJob {
    /// Whose part is measured.
    pub nest: NestId,
    /// What is to be done.
    pub job: Job,
}

/// Answer to a [`NestJob`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NestDone {
    /// The nest that asked.
    pub nest: NestId,
    /// What became of its job.
    pub done: JobDone,
}

/// A motion by hand, which the guard may refuse: then that is the answer to the order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Jog {
    /// What to move.
    pub movement: Move,
    /// Place of its order among the answers of the turn.
    pub answer: usize,
}

/// Commands to the rig.
#[derive(Debug, Default)]
pub struct Commands {
    /// Motions, each to pass the guard.
    pub motions: Vec<Move>,
    /// A motion by hand.
    pub jog: Option<Jog>,
    /// Plain outputs.
    pub outputs: Vec<(DigitalOut, bool)>,
    /// Work for the measuring line; one at a time.
    pub job: Option<NestJob>,
    /// Beam whose event counter is to be read with every scan.
    pub beam: Option<DigitalInput>,
    /// An actuator is not where it should be: before it is named, the modules are asked whether one has restarted.
    pub suspicious: bool,
    /// All outputs to their safe values, now.
    pub safe: bool,
    /// Forget failed writes and verify every module again.
    pub verify: bool,
    /// Next turn not later than this.
    pub wake_at: Option<RigTime>,
}

/// What has happened to parts, for the record.
#[derive(Debug, Default)]
pub struct PartEvents {
    /// Parts judged in this turn.
    pub judged: Vec<Judged>,
    /// Judged parts that were interrupted on their way to the bin.
    pub interrupted: Vec<Interrupted>,
    /// Parts that left a nest in this turn.
    pub left: Vec<Left>,
    /// Parts confirmed in this turn.
    pub landed: Vec<Landed>,
}

/// A judged part on its way to the history.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Who it is, with test time and bin.
    pub part: Part,
    /// What is said of it.
    pub verdict: Verdict,
    /// Each result against its limit.
    pub judgements: Vec<(Characteristic, Judgement)>,
    /// Results and the replies they came from.
    pub record: TestRecord,
    /// When it was judged.
    pub at: RigTime,
}

impl Judged {
    /// A part that was not tested to the end.
    pub fn interrupted(part: Part, why: &str, at: RigTime) -> Self {
        Self {
            part,
            verdict: Verdict::Void(vec![Reason::interrupted(why)]),
            judgements: Vec::new(),
            record: TestRecord::default(),
            at,
        }
    }
}

/// A judged part that goes to retest all the same.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Interrupted {
    /// Ordinal of the part.
    pub ordinal: u64,
    /// Why.
    pub why: String,
}

/// A part whose beam has confirmed it.
#[derive(Debug, Clone)]
pub struct Landed {
    /// Who it is.
    pub part: Part,
    /// Bin whose beam saw it.
    pub bin: Bin,
    /// When.
    pub at: RigTime,
}

/// A part that has left the nest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Left {
    /// Ordinal of the part.
    pub ordinal: u64,
    /// Since the part before left; `None` for the first.
    pub cycle: Option<Second>,
}
