//! What one turn of the station asks for, by receiver, and what it is told.

use super::orders::{Order, Refused};
use super::packml::Command;
use super::trouble::Alarm;
use crate::dut::Calibration;
use crate::handling::trouble::Trouble;
use crate::handling::wants::{Commands, NestDone, PartEvents};
use crate::rig::image::Image;
use crate::units::RigTime;

/// What the station is told in a turn beside the time.
#[derive(Debug)]
pub struct Inputs<'a> {
    /// Process image.
    pub image: &'a Image,
    /// Answer to the job asked for, once.
    pub job: Option<NestDone>,
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
    /// The modules were verified after [`Commands::verify`].
    pub verified: bool,
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

impl Ending {
    /// The name in files and answers.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Stopped => "stopped",
            Self::Alarm => "alarm",
        }
    }
}

/// Events for the record.
#[derive(Debug, Default)]
pub struct Record {
    /// What has happened to parts.
    pub parts: PartEvents,
    /// Alarms that came anew in this turn.
    pub alarms: Vec<Alarm>,
    /// Alarms that stand have changed.
    pub alarms_changed: bool,
    /// A calibration that is complete.
    pub calibrated: Option<Calibration>,
    /// A golden check has come out.
    pub checked: Option<Checked>,
    /// The lot itself has begun (after calibration and golden parts).
    pub lot_began: bool,
    /// The run is over.
    pub ending: Option<Ending>,
}

/// Notes between the parts of the station; nothing is left of them when a turn is over.
#[derive(Debug, Default)]
pub(super) struct Notes {
    /// Trouble seen in this turn, before it was compared with what stands.
    pub trouble: Vec<Alarm>,
    /// Trouble of the feeder that has not become an alarm yet.
    pub feeder: Vec<Trouble>,
}

impl Notes {
    /// Nothing is left to become an alarm.
    fn is_done(&self) -> bool {
        self.trouble.is_empty() && self.feeder.is_empty()
    }

    /// Trouble of the feeder takes its place behind what was noted before.
    pub fn take_over(&mut self) {
        self.trouble.extend(self.feeder.drain(..).map(Alarm::from));
    }
}

/// What one turn asks for.
#[derive(Debug, Default)]
pub struct Wants {
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

impl Wants {
    /// Checks what the receivers of a turn rely on; it had so many orders.
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
        assert!(self.notes.is_done(), "trouble that became no alarm");
    }
}
