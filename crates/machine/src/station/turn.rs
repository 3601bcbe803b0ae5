//! Inputs and outputs of one turn of the station; the outputs are grouped by their receiver.

use super::orders::{Order, Refused};
use super::packml::Command;
use super::trouble::Alarm;
use crate::dut::Calibration;
use crate::dut::promise::Broken;
use crate::dut::prompt::Prompt;
use crate::handling::output::{Commands, NestDone, PartEvents};
use crate::handling::trouble::Trouble;
use crate::rig::image::Image;
use units::{RigTime, Span};

/// Inputs of a turn besides the time.
#[derive(Debug)]
pub struct Inputs<'a> {
    /// Process image.
    pub image: &'a Image,
    /// Result of the requested job, in one turn only.
    pub job: Option<NestDone>,
    /// Ordinal of the last part whose rows are safely on the disk.
    pub recorded: u64,
    /// State of the history.
    pub history: HistoryState,
    /// Alarms of lines and modules, in one turn only.
    pub bus: Vec<Alarm>,
    /// Readings of the code reader since the last turn, in order; `None` is a reading without a code.
    pub readings: Vec<Option<String>>,
    /// Alarm about the code reader while its port is lost.
    pub reader: Option<Alarm>,
    /// Alarms about the databases of the fleet while they lack parts for too long.
    pub fleet: Vec<Alarm>,
    /// Lateness of this computer in the last seconds, if it is long enough to explain an input that was not read.
    pub host_late: Option<Span>,
    /// True when the operator ends the lot once the parts inside are finished (one Ctrl-C).
    pub stop: bool,
    /// True when the operator ends the lot at once (two Ctrl-C).
    pub abort: bool,
    /// Orders of screens in order of arrival; [`TurnOutput::answers`] has the answer to each.
    pub orders: Vec<Order>,
    /// True when every output has confirmed its command.
    pub settled: bool,
    /// True in the one turn after a verification that [`Commands::verify`] requested has succeeded; one that failed
    /// gives an alarm instead.
    pub verified: bool,
}

/// State of the history, which keeps the rows of the station.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub enum HistoryState {
    /// Rows are written.
    #[default]
    Written,
    /// Rows wait in an unattended run, where no operator can clear an alarm: meanwhile no part leaves the nest and no
    /// timeout applies.
    Waiting,
    /// Rows cannot be written at present.
    Lost(Alarm),
    /// Rows could not be written for too long: the run ends.
    GivenUp(Alarm),
}

impl HistoryState {
    /// Returns the alarm while it is active.
    pub const fn alarm(&self) -> Option<&Alarm> {
        match self {
            Self::Lost(alarm) | Self::GivenUp(alarm) => Some(alarm),
            Self::Written | Self::Waiting => None,
        }
    }

    const fn is_given_up(&self) -> bool {
        matches!(self, Self::GivenUp(_))
    }
}

/// Result of a reference check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Checked {
    /// Serial number of the part, or the disagreement.
    pub text: String,
    /// Alarm of the disagreement; `None` when the part agrees with its certificate.
    pub failure: Option<Alarm>,
}

impl Inputs<'_> {
    /// Returns true when the run ends once the parts inside are finished.
    pub(super) const fn stops(&self) -> bool {
        self.stop || self.history.is_given_up()
    }
}

named! {
    /// How a run ends; the summary of the run uses these names.
    Ending {
        /// Every part was judged and binned.
        Complete = "complete",
        /// The operator stopped the run, which ended once the parts inside were finished.
        Stopped = "stopped",
        /// An alarm stopped the run.
        Alarm = "alarm",
    }
}

/// Events of a turn, for the history.
#[derive(Debug, Default)]
pub struct Record {
    /// Events of parts.
    pub parts: PartEvents,
    /// New alarms of this turn.
    pub alarms: Vec<Alarm>,
    /// True when the list of alarms has changed.
    pub alarms_changed: bool,
    /// Calibration that was completed in this turn.
    pub calibrated: Option<Calibration>,
    /// Promises of rig and recipe found broken in this turn.
    pub broken: Vec<Broken>,
    /// Result of the reference check that ended in this turn.
    pub checked: Option<Checked>,
    /// Prompt that has opened in this turn.
    pub prompted: Option<Prompt>,
    /// True when the lot itself begins, after calibration and reference parts.
    pub lot_began: bool,
    /// How the run ended, if it ended in this turn.
    pub ending: Option<Ending>,
}

/// Trouble noted within a turn; empty at the end of the turn.
#[derive(Debug, Default)]
pub(super) struct Notes {
    /// Alarms of this turn, not yet in the list.
    pub trouble: Vec<Alarm>,
    /// Trouble of the feeder, not yet an alarm.
    pub feeder: Vec<Trouble>,
}

impl Notes {
    fn is_done(&self) -> bool {
        self.trouble.is_empty() && self.feeder.is_empty()
    }

    /// Turns trouble of the feeder into alarms, which follow those noted before.
    pub fn take_over(&mut self) {
        self.trouble.extend(self.feeder.drain(..).map(Alarm::from));
    }
}

/// Outputs of a turn.
#[derive(Debug, Default)]
pub struct TurnOutput {
    /// Commands to the rig.
    pub rig: Commands,
    /// Events for the record.
    pub record: Record,
    /// Answers to the orders of this turn, one each.
    pub answers: Vec<Result<(), Refused>>,
    /// Orders of the buttons at the machine, each with its answer.
    pub pressed: Vec<(Command, Result<(), Refused>)>,
    pub(super) notes: Notes,
}

impl TurnOutput {
    /// Panics when an invariant of the outputs is broken; `orders` is the number of orders in the turn.
    pub(super) fn check(&self, now: RigTime, orders: usize) {
        let rig = &self.rig;
        assert_eq!(self.answers.len(), orders, "orders without their answers");
        assert!(
            rig.wake_at.is_none_or(|at| at >= now),
            "a deadline in the past"
        );
        if rig.safe {
            assert!(
                rig.motions.is_empty(),
                "outputs go safe and {:?}",
                rig.motions
            );
            assert!(rig.job.is_none(), "outputs go safe and a job begins");
            assert!(rig.jog.is_none(), "outputs go safe and a person moves one");
        }
        if let Some(jog) = rig.jog {
            assert!(jog.answer < self.answers.len(), "a jog without its order");
        }
        let ends = self.record.ending.is_some();
        assert!(!ends || rig.safe, "a run ends and outputs are on");
        for judged in &self.record.parts.judged {
            let ordinal = judged.part.ordinal;
            assert!(judged.part.bin.is_some(), "part {ordinal} has no bin");
        }
        assert!(self.notes.is_done(), "trouble without an alarm");
    }
}
