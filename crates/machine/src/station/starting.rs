//! The state `Starting`: without a calibration the probes rise in the empty nest and the rig measures its references.

use super::Station;
use super::line::FeederLine;
use super::trouble::Alarm;
use super::turn::{Inputs, TurnOutput};
use crate::dut::prompt::PromptMoment;
use crate::handling::output::NestJob;
use crate::handling::{Move, NestId};
use crate::instrument::act::{Runner, RunnerState};
use texts::Message;
use units::RigTime;

/// Step of `Starting`.
#[derive(Debug)]
pub(super) enum Start {
    /// Before the first motion.
    Begin,
    /// Probes rise in the empty nest.
    Up,
    References(Box<Runner>),
    /// Probes go down again.
    Down,
}

impl Station {
    /// Performs a turn of `Starting`.
    pub(super) fn begin(&mut self, now: RigTime, inputs: &Inputs, output: &mut TurnOutput) {
        let is_rack = self.line.batch().is_some();
        if self.plan.calibrated || self.referenced || is_rack {
            return self.done(now, output);
        }
        if matches!(self.start, Start::Begin) && self.prompts.asks(PromptMoment::BeforeCalibration)
        {
            return;
        }
        match std::mem::replace(&mut self.start, Start::Begin) {
            Start::Begin => {
                output.rig.motions.push(Move::ProbesUp);
                self.start = Start::Up;
            }
            Start::Up => {
                let up = self.has_arrived(Move::ProbesUp, now, inputs);
                self.start = if up {
                    let acts = self.device.reference_acts();
                    Start::References(Box::new(Runner::new(acts, now)))
                } else {
                    Start::Up
                };
                output.rig.wake_at = up.then_some(now);
            }
            Start::References(runner) => self.measure(now, inputs, runner, output),
            Start::Down if self.has_arrived(Move::ProbesDown, now, inputs) => {
                self.referenced = true;
                self.done(now, output);
            }
            Start::Down => self.start = Start::Down,
        }
    }

    fn has_arrived(&self, movement: Move, now: RigTime, inputs: &Inputs) -> bool {
        let arrived = |own: &FeederLine| own.mechanism.has_arrived(movement, now, inputs.image);
        self.line.feeder().is_some_and(arrived)
    }

    fn measure(
        &mut self,
        now: RigTime,
        inputs: &Inputs,
        mut runner: Box<Runner>,
        output: &mut TurnOutput,
    ) {
        let done = inputs.job.as_ref().map(|job| &job.done);
        match runner.step(now, done, inputs.image) {
            RunnerState::Job(job) => {
                let nest = NestId::FIRST;
                output.rig.job = Some(NestJob { nest, job });
            }
            RunnerState::Wait(until) => output.rig.wake_at = Some(until),
            RunnerState::Busy => {}
            RunnerState::Trouble(why) => {
                let fault = Message::new("fault", "line").with_inner("detail", &why);
                output.notes.trouble.push(Alarm::calibration(&fault));
            }
            RunnerState::Done => {
                if let Err(why) = self.conclude_references(now, &runner) {
                    let alarm = Alarm::calibration(&why.message());
                    output.notes.trouble.push(alarm);
                    return;
                }
                output.rig.motions.push(Move::ProbesDown);
                self.start = Start::Down;
                return;
            }
        }
        self.start = Start::References(runner);
    }
}
