//! What the station does in each PackML state during a turn, and when it leaves the state.

use super::Station;
use super::catalogue::{AlarmCode, Reaction};
use super::line::Handling;
use super::packml::{self, Command, On, State};
use super::safety::FIRST_SCAN;
use super::starting::Start;
use super::trouble::Alarm;
use super::turn::{Ending, Inputs, TurnOutput};
use crate::dut::prompt::PromptMoment;
use crate::handling::Place;
use crate::handling::feeder::Permits;
use crate::handling::recovery::Recovery;
use units::{RigTime, Span};

/// Time within which outputs must confirm their safe values; after it the abort raises an alarm and continues.
const SAFE_WITHIN: Span = Span::ms(2000);
/// Time after which a suspension ends an unattended run.
const ALONE: Span = Span::ms(60_000);

impl Station {
    /// Gives the commands of the program itself (stop, first reset and start), and ends the run.
    pub(super) fn own_commands(&mut self, now: RigTime, inputs: &Inputs, output: &mut TurnOutput) {
        if self.machine.ended {
            return;
        }
        if inputs.stops() && !self.machine.stopping {
            self.machine.stopping = true;
            if packml::next(self.machine.state, On::Command(Command::Stop)).is_some() {
                self.enter(Command::Stop, now, output);
            }
        }
        if inputs.abort && !packml::is_aborted(self.machine.state) {
            self.make_safe("stopped_by_operator", now, output);
            self.end(Ending::Stopped, now, output);
        }
        let rests = matches!(
            self.machine.state,
            State::Stopped | State::Complete | State::Aborted
        );
        let begins = self.machine.state == State::Stopped && self.machine.entered == RigTime(0);
        let may_ask = self.machine.state == State::Stopped && !self.is_between_lots();
        let asked = may_ask && self.prompts.asks(PromptMoment::LotStart);
        match (
            self.machine.stopping,
            self.plan.attended,
            self.machine.state,
        ) {
            (true, ..) if rests => {
                self.make_safe("stopped", now, output);
                let aborted = packml::is_aborted(self.machine.state);
                let in_trouble = aborted && !self.alarms.annunciator.listed().is_empty();
                self.end(
                    if in_trouble {
                        Ending::Alarm
                    } else {
                        Ending::Stopped
                    },
                    now,
                    output,
                );
            }
            (false, ..) if self.is_between_lots() => {}
            (false, _, State::Stopped) if begins && !asked => {
                self.enter(Command::Reset, now, output)
            }
            (false, _, State::Idle) if self.machine.fresh => {
                self.enter(Command::Start, now, output)
            }
            (false, false, State::Suspended) if now.since(self.machine.entered) > ALONE => {
                self.make_safe("suspended_too_long", now, output);
                self.end(Ending::Alarm, now, output);
            }
            (..) => {}
        }
    }

    /// Ends the run; raises an alarm for a part that still falls into its bin.
    pub(super) fn end(&mut self, ending: Ending, now: RigTime, output: &mut TurnOutput) {
        let over = self.line.ledger.fall().map(|fall| fall.bin);
        if let Some(bin) = over {
            self.line.ledger.lose(Place::Falling);
            let alarm = Alarm::beam_unread(bin);
            self.raise(alarm, now, output);
            output.record.alarms_changed |= self.alarms.annunciator.take_changed();
        }
        assert!(
            self.line.ledger.fall().is_none(),
            "a part falls on after the end"
        );
        output.rig.safe = true;
        output.record.ending = Some(ending);
        self.machine.ended = true;
    }

    /// Enters the state that follows on a command, which the caller has checked.
    pub(super) fn enter(&mut self, command: Command, now: RigTime, output: &mut TurnOutput) {
        if let Some(to) = self.machine.follow(On::Command(command), now) {
            self.entered(to, now, output);
        }
    }

    /// Leaves a state that is complete.
    pub(super) fn done(&mut self, now: RigTime, output: &mut TurnOutput) {
        if let Some(to) = self.machine.follow(On::Done, now) {
            self.entered(to, now, output);
        }
    }

    /// Performs the entry actions of a state.
    fn entered(&mut self, to: State, now: RigTime, output: &mut TurnOutput) {
        self.alarms.timeouts.forget();
        output.rig.wake_at = Some(now);
        match to {
            State::Resetting => {
                match &mut self.line.handling {
                    Handling::Feeder(own) => own.recovery = Recovery::default(),
                    Handling::Batch(batch) => batch.begin_home(now, &self.device),
                }
                self.line.homed = false;
            }
            State::Starting => {
                self.machine.fresh = false;
                self.start = Start::Begin;
            }
            State::Clearing => {
                (self.machine.verify_requested, self.machine.verified) = (false, None)
            }
            State::Stopped | State::Complete => self.make_safe("stopped", now, output),
            State::Held | State::Suspended => {
                if let Handling::Batch(batch) = &mut self.line.handling {
                    batch.rest();
                }
            }
            State::Idle
            | State::Execute
            | State::Completing
            | State::Holding
            | State::Unholding
            | State::Suspending
            | State::Unsuspending
            | State::Stopping
            | State::Aborting
            | State::Aborted => {}
        }
        if to == State::Complete {
            let ending = if self.machine.stopping {
                Ending::Stopped
            } else {
                Ending::Complete
            };
            self.end(ending, now, output);
        }
    }

    /// Performs a turn of the present state.
    pub(super) fn act(&mut self, now: RigTime, inputs: Inputs, output: &mut TurnOutput) {
        match self.machine.state {
            State::Resetting => self.reset(now, inputs, output),
            State::Starting => self.begin(now, &inputs, output),
            State::Execute => {
                if self.asks_before_the_first_part(&inputs, output) {
                    return;
                }
                self.begin_due_check(now, output);
                let goes_on = !self.is_prompt_due();
                let permits = Permits {
                    release: goes_on && self.expects_more(),
                    push: goes_on,
                };
                self.produce(now, inputs, output, permits);
                let done = !self.expects_more() && !self.lot.gates.is_checking();
                if self.machine.state == State::Execute && done {
                    self.done(now, output);
                }
            }
            State::Completing => self.finish(now, inputs, output, true),
            State::Stopping if self.line.homed => self.finish(now, inputs, output, false),
            State::Holding | State::Suspending => {
                let permits = Permits {
                    release: false,
                    push: false,
                };
                self.produce(now, inputs, output, permits);
                if self.machine.is_coming_to_rest() && self.line.is_at_rest() {
                    self.done(now, output);
                }
            }
            State::Aborting => self.wait_for_safe(now, &inputs, output),
            State::Clearing => self.clear(now, &inputs, output),
            State::Suspended => {
                let cause = self
                    .alarms
                    .annunciator
                    .stopping(Reaction::Suspend)
                    .is_some();
                if !cause && !self.machine.suspended_by_order {
                    self.enter(Command::Unsuspend, now, output);
                }
            }
            State::Stopping | State::Unholding | State::Unsuspending => self.done(now, output),
            State::Stopped | State::Idle | State::Complete | State::Held | State::Aborted => {}
        }
    }

    /// Finishes the parts inside; with `push`, also the part in the pocket.
    pub(super) fn finish(
        &mut self,
        now: RigTime,
        inputs: Inputs,
        output: &mut TurnOutput,
        push: bool,
    ) {
        let (state, recorded) = (self.machine.state, inputs.recorded);
        let permits = Permits {
            release: false,
            push,
        };
        self.produce(now, inputs, output, permits);
        if self.machine.state != state || !self.line.is_finished(push, recorded, output) {
            return;
        }
        if state == State::Completing && self.prompts.is_due(PromptMoment::LotEnd) {
            if self.rests_empty(recorded, output) {
                self.prompts.asks(PromptMoment::LotEnd);
            }
            return;
        }
        self.done(now, output);
    }

    fn wait_for_safe(&mut self, now: RigTime, inputs: &Inputs, output: &mut TurnOutput) {
        if inputs.settled {
            self.done(now, output);
        } else if now.since(self.machine.entered) > SAFE_WITHIN {
            output
                .notes
                .trouble
                .push(AlarmCode::OutputsNotConfirmed.into());
            self.done(now, output);
        }
    }

    /// Verifies the modules, then waits for a fresh sample of every safety input, which a reset requires, but no longer
    /// than [`FIRST_SCAN`].
    fn clear(&mut self, now: RigTime, inputs: &Inputs, output: &mut TurnOutput) {
        if inputs.verified {
            self.machine.verified = Some(now);
        }
        if let Some(at) = self.machine.verified {
            assert!(at <= now, "verified in the future");
            if self.safety_was_read(inputs.image, at) || now.since(at) > FIRST_SCAN {
                self.done(now, output);
            }
        } else if !self.machine.verify_requested {
            self.machine.verify_requested = true;
            output.rig.verify = true;
        }
    }
}
