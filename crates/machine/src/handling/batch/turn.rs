//! What a batch sees and changes in one turn.

use crate::dut::Device;
use crate::dut::experiment::Experiment;
use crate::handling::ledger::Ledger;
use crate::handling::mechanism::SENSOR_AGE;
use crate::handling::output::{Commands, NestJob, PartEvents};
use crate::handling::place::NestId;
use crate::handling::serial::Serials;
use crate::handling::trouble::Trouble;
use crate::instrument::act::RunnerState;
use crate::rig::image::Image;
use crate::rig::point::DigitalIn;
use crate::rig::rack::Socket;
use units::{RigTime, Span};

/// Everything that the batch sees and changes in one turn.
pub struct BatchTurn<'a> {
    /// Time of this turn.
    pub now: RigTime,
    /// Process image.
    pub image: &'a Image,
    /// Places of the parts.
    pub ledger: &'a mut Ledger,
    /// Commands of this turn to the rig.
    pub rig: &'a mut Commands,
    /// Events of parts in this turn.
    pub parts: &'a mut PartEvents,
    /// Troubles of this turn.
    pub trouble: &'a mut Vec<Trouble>,
    /// Serial numbers of the parts of the lot.
    pub serials: &'a mut Serials,
    /// Device under test.
    pub device: &'a Device,
    /// Ordinal of the last part whose rows are safely on the disk.
    pub recorded: u64,
    /// Number of parts that the lot still lacks; `None` for an endless lot.
    pub lacking: Option<u64>,
    /// True when a person uses a screen.
    pub attended: bool,
    /// True when another batch may begin.
    pub begins: bool,
    /// Experiment without parts that is due; `None` in a lot.
    pub experiment: Option<Experiment>,
}

impl BatchTurn<'_> {
    /// Returns the state of a sensor; `None` unless its value is valid.
    pub(super) fn input(&self, point: DigitalIn) -> Option<bool> {
        self.image.input(point, self.now, SENSOR_AGE)
    }

    pub(super) fn wake_within(&mut self, span: Span) {
        let at = self.now + span;
        let wake_at = &mut self.rig.wake_at;
        *wake_at = Some(wake_at.map_or(at, |known| known.min(at)));
    }

    /// Returns those of these sockets whose contact is closed; `None` while a contact is unread.
    pub(super) fn closed<'s>(
        &self,
        sockets: impl IntoIterator<Item = &'s Socket>,
    ) -> Option<Vec<u16>> {
        let mut closed = Vec::new();
        for Socket {
            number, contact, ..
        } in sockets
        {
            if self.image.input(*contact, self.now, SENSOR_AGE)? {
                closed.push(*number);
            }
        }
        Some(closed)
    }

    /// Passes the job of a runner, or the time at which it wakes, to the rig.
    pub(super) fn run(&mut self, state: &RunnerState) {
        match state {
            RunnerState::Job(job) => {
                assert!(self.rig.job.is_none(), "two jobs in one turn");
                let (nest, job) = (NestId::FIRST, job.clone());
                self.rig.job = Some(NestJob { nest, job });
            }
            RunnerState::Wait(until) => self.wake_within(until.since(self.now)),
            RunnerState::Busy | RunnerState::Done | RunnerState::Trouble(_) => {}
        }
    }
}
