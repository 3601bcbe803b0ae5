//! What one turn of the station asks for, and what it is told.

use super::ledger::Part;
use super::moves::Move;
use super::orders::{Order, Refused};
use super::packml::Command;
use super::trouble::Alarm;
use crate::dut::em_relay::measure::TestRecord;
use crate::dut::{Bin, Calibration, Characteristic, Judgement, Reason, Verdict};
use crate::instrument::act::{Job, JobDone};
use crate::rig::image::Image;
use crate::rig::point::{DigitalInput, DigitalOut};
use crate::units::{RigTime, Second};

/// What the station is told in a turn beside the time.
#[derive(Debug)]
pub struct Inputs<'a> {
    /// Process image.
    pub image: &'a Image,
    /// Answer to the job asked for, once.
    pub job: Option<JobDone>,
    /// Ordinal up to which parts are durably recorded.
    pub recorded: u64,
    /// Trouble of a line or module, once.
    pub bus: Option<Alarm>,
    /// The operator wants the lot to end after the parts inside (Ctrl-C, once).
    pub stop: bool,
    /// The operator wants it to end at once (Ctrl-C, twice).
    pub abort: bool,
    /// Orders of screens, in the order in which they came; each is answered in [`Wants::answers`].
    pub orders: Vec<Order>,
    /// Every output has confirmed what was asked of it.
    pub settled: bool,
    /// The modules were verified after [`Wants::verify`].
    pub verified: bool,
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

/// A motion by hand, which the guard may refuse: then that is the answer to the order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Jog {
    /// What to move.
    pub movement: Move,
    /// Place of its order in [`Wants::answers`].
    pub answer: usize,
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

/// A golden check that has come out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checked {
    /// The golden part reads as certified.
    pub passed: bool,
    /// Which part, or what was found instead.
    pub text: String,
}

/// How a run ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ending {
    /// Every part was judged and binned.
    Complete,
    /// The operator stopped it; the parts inside were finished.
    Stopped,
    /// An alarm stopped it.
    Alarm,
}

/// What one turn asks for.
#[derive(Debug, Default)]
pub struct Wants {
    /// Motions, each to pass the guard.
    pub motions: Vec<Move>,
    /// Plain outputs.
    pub outputs: Vec<(DigitalOut, bool)>,
    /// Work for the measuring line.
    pub job: Option<Job>,
    /// An actuator is not where it should be: before it is named, the modules are asked whether one has restarted.
    pub suspicious: bool,
    /// Beam whose event counter is to be read with every scan.
    pub beam: Option<DigitalInput>,
    /// Orders of the buttons at the machine, each with its answer.
    pub pressed: Vec<(Command, Result<(), Refused>)>,
    /// Trouble seen in this turn, before it was compared with what stands.
    pub trouble: Vec<Alarm>,
    /// Alarms that came anew in this turn.
    pub alarms: Vec<Alarm>,
    /// A motion by hand.
    pub jog: Option<Jog>,
    /// Parts judged in this turn.
    pub judged: Vec<Judged>,
    /// Parts confirmed in this turn.
    pub landed: Vec<Landed>,
    /// Parts that left the nest in this turn.
    pub left: Vec<Left>,
    /// A calibration that is complete.
    pub calibrated: Option<Calibration>,
    /// A golden check has come out.
    pub checked: Option<Checked>,
    /// All outputs to their safe values, now.
    pub safe: bool,
    /// The lot itself has begun (after calibration and golden parts).
    pub lot_began: bool,
    /// Judged parts that were interrupted on their way to the bin.
    pub interrupted: Vec<Interrupted>,
    /// Answers to the orders of this turn, one each.
    pub answers: Vec<Result<(), Refused>>,
    /// Alarms that stand have changed.
    pub alarms_changed: bool,
    /// Forget failed writes and verify every module again.
    pub verify: bool,
    /// The run is over.
    pub ending: Option<Ending>,
    /// Next turn not later than this.
    pub wake_at: Option<RigTime>,
}
