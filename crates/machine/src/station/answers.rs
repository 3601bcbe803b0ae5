//! Answers to orders: the station performs an order, or refuses it with the reason.

use super::Station;
use super::annunciator::ListedAlarm;
use super::catalogue::{AlarmCode, Reaction};
use super::orders::{Order, Refused, shelf_minutes};
use super::packml::{self, Command, Mode, On, State};
use super::trouble::Alarm;
use super::turn::{Ending, TurnOutput};
use crate::handling::mechanism::HandEnd;
use crate::handling::output::Jog;
use crate::handling::{Move, Place};
use crate::rig::image::Image;
use units::{RigTime, Span};

impl Station {
    /// Performs an order, or returns the reason of its refusal.
    pub(super) fn order(
        &mut self,
        order: Order,
        now: RigTime,
        output: &mut TurnOutput,
    ) -> Result<(), Refused> {
        if self.machine.ended {
            return Err(Refused::RunEnded);
        }
        match order {
            Order::Command(command) => {
                self.may(command)?;
                self.command(command, now, output);
            }
            Order::Mode(mode) => {
                self.may_change_mode()?;
                self.machine.mode = mode;
            }
            Order::Jog(movement) => {
                self.may_jog()?;
                if output.rig.jog.is_some() {
                    return Err(Refused::StillMoving);
                }
                let answer = output.answers.len();
                output.rig.jog = Some(Jog { movement, answer });
            }
            Order::Step => {
                self.may_step()?;
                let own = self.line.feeder_mut();
                let next = own.and_then(|own| own.stepwise.pop_front());
                output.rig.motions.extend(next);
            }
            Order::LampTest => self.alarms.lamps.test(now),
            Order::Leave => {
                self.may_leave()?;
                self.leave(Ending::Stopped, now, output);
            }
            Order::Close => {
                self.may_close()?;
                if self.may(Command::Complete).is_ok() {
                    self.command(Command::Complete, now, output);
                } else {
                    self.leave(Ending::Complete, now, output);
                }
            }
            Order::Acknowledge(code) => {
                if !self.alarms.annunciator.acknowledge(code.as_deref()) && code.is_some() {
                    return Err(Refused::NoSuchAlarm);
                }
            }
            Order::Shelve(code, minutes) => {
                let minutes = shelf_minutes(Some(minutes));
                let until = now + Span::ms(u64::from(minutes) * 60_000);
                assert!(until > now, "shelved for no time");
                if !self.alarms.annunciator.shelve(&code, until) {
                    return Err(Refused::NoSuchAlarm);
                }
            }
            Order::Scan(serial) => {
                self.may_scan()?;
                let scanned = self.line.serials.scan(&serial, &self.line.ledger);
                scanned.map_err(Refused::Scan)?;
            }
            Order::Answer(prompt, choice) => {
                let batch = self.line.batch_mut();
                let answered = batch.is_some_and(|it| it.answer(&prompt, &choice));
                if !answered && self.prompts.answer(&prompt, &choice)? {
                    self.leave(Ending::Stopped, now, output);
                }
            }
            Order::Unscan => self.line.serials.unscan().map_err(Refused::Scan)?,
        }
        Ok(())
    }

    /// Answers the orders of the push buttons; returns the alarms of stuck buttons.
    pub(super) fn pressed(
        &mut self,
        now: RigTime,
        image: &Image,
        output: &mut TurnOutput,
    ) -> Vec<Alarm> {
        let (commands, stuck) = self.alarms.panel.look(now, image, self.machine.state);
        for command in commands {
            let answer = self.order(Order::Command(command), now, output);
            // A stop ends an unattended run, because no person is there to restart the machine.
            self.machine.stopping |= command == Command::Stop && !self.plan.attended;
            output.pressed.push((command, answer));
        }
        stuck
    }

    /// Checks that the state allows a command now; a screen shows the reason next to the button.
    ///
    /// # Errors
    /// Fails with the reason when the state does not allow the command.
    pub fn may(&self, command: Command) -> Result<(), Refused> {
        if packml::next(self.machine.state, On::Command(command)).is_none() {
            return Err(Refused::WrongState(command, self.machine.state));
        }
        match command {
            Command::Reset
            | Command::Start
            | Command::Unhold
            | Command::Unsuspend
            | Command::Complete
                if self.prompts.open().is_some() =>
            {
                Err(Refused::PromptOpen)
            }
            Command::Reset | Command::Clear => gone(self.alarms.annunciator.still_sensed()),
            Command::Start => self.may_start(),
            Command::Unsuspend => gone(self.alarms.annunciator.stopping(Reaction::Suspend)),
            Command::Stop
            | Command::Hold
            | Command::Unhold
            | Command::Suspend
            | Command::Abort
            | Command::Complete => Ok(()),
        }
    }

    fn may_start(&self) -> Result<(), Refused> {
        if self.machine.mode == Mode::Manual {
            return Err(self.wrong_mode("start", Mode::Production));
        }
        if !self.line.homed {
            return Err(Refused::MovedByHand);
        }
        if self.is_between_lots() {
            return Err(Refused::NoLot);
        }
        Ok(())
    }

    /// Checks that the operator may leave the lot unfinished, so that another lot can begin.
    ///
    /// # Errors
    /// Fails with the reason when the operator must not leave the lot.
    pub fn may_leave(&self) -> Result<(), Refused> {
        if self.machine.mode != Mode::Production {
            return Err(self.wrong_mode("start", Mode::Production));
        }
        if !matches!(
            self.machine.state,
            State::Stopped | State::Idle | State::Complete
        ) {
            return Err(Refused::NotAtRest(self.machine.state));
        }
        let held = |place: Place| match place {
            Place::Nest(_) | Place::Gripper | Place::Socket(_) => true,
            Place::Pocket | Place::Falling => false,
        };
        if self.line.ledger.each().any(|(place, _)| held(place)) {
            return Err(Refused::PartInside);
        }
        Ok(())
    }

    fn wrong_mode(&self, order: &'static str, needed: Mode) -> Refused {
        let found = self.machine.mode;
        Refused::WrongMode {
            order,
            found,
            needed,
        }
    }

    /// Checks that the lot may end before its count is reached.
    ///
    /// # Errors
    /// Fails with the reason when the lot must not end yet.
    pub fn may_close(&self) -> Result<(), Refused> {
        self.may(Command::Complete).or_else(|_| self.may_leave())
    }

    /// Checks that no part that was scanned in an earlier run may lie in the magazine, where it would get the next
    /// number.
    fn may_scan(&self) -> Result<(), Refused> {
        let mut listed = self.alarms.annunciator.listed().iter();
        match listed.find(|it| it.alarm.code == AlarmCode::ScansDropped) {
            Some(dropped) => Err(Refused::ScansDropped(Box::new(dropped.alarm.clone()))),
            None => Ok(()),
        }
    }

    /// Checks that the state allows a change of mode.
    ///
    /// # Errors
    /// Fails with the reason when the state does not allow the change.
    pub fn may_change_mode(&self) -> Result<(), Refused> {
        if packml::may_change_mode(self.machine.state) {
            return Ok(());
        }
        Err(Refused::ModeLocked(self.machine.state))
    }

    /// Checks that an actuator may be jogged now; the guard checks the motion itself.
    ///
    /// # Errors
    /// Fails with the reason when no actuator may be jogged.
    pub fn may_jog(&self) -> Result<(), Refused> {
        if self.line.feeder().is_none() {
            return Err(Refused::NothingMoves);
        }
        if self.prompt().is_some() {
            return Err(Refused::PromptOpen);
        }
        if self.machine.mode == Mode::Production {
            return Err(self.wrong_mode("jog", Mode::Manual));
        }
        if self.machine.state != State::Idle {
            return Err(Refused::Unhomed(self.machine.state));
        }
        if self.line.is_moving() {
            return Err(Refused::StillMoving);
        }
        Ok(())
    }

    /// Checks that a motion of the sequence is waiting for a step.
    ///
    /// # Errors
    /// Fails with the reason when no motion waits.
    pub fn may_step(&self) -> Result<(), Refused> {
        if self.machine.mode != Mode::Maintenance {
            return Err(self.wrong_mode("step", Mode::Maintenance));
        }
        let own = self.line.feeder();
        if own.is_none_or(|own| own.stepwise.is_empty()) {
            return Err(Refused::NoMotionWaits);
        }
        Ok(())
    }

    /// Records that the motion that has just begun is a jog, after which the machine is no longer homed.
    pub fn jogged(&mut self, movement: Move) {
        self.line.homed = false;
        if let Some(own) = self.line.feeder_mut() {
            own.mechanism.driven_by_hand(movement);
        }
    }

    /// Returns how the last jog ended, once; `None` while it moves, or without a jog.
    pub fn take_jog_end(&mut self, now: RigTime, image: &Image) -> Option<HandEnd> {
        let own = self.line.feeder_mut()?;
        own.mechanism.take_hand_end(now, image)
    }

    fn leave(&mut self, ending: Ending, now: RigTime, output: &mut TurnOutput) {
        self.make_safe("stopped", now, output);
        self.end(ending, now, output);
    }

    fn command(&mut self, command: Command, now: RigTime, output: &mut TurnOutput) {
        self.machine.fresh = false;
        match command {
            Command::Abort => return self.abort("abort_ordered", now, output),
            Command::Clear | Command::Unhold | Command::Reset => self.alarms.annunciator.cleared(),
            Command::Suspend => self.machine.suspended_by_order = true,
            Command::Start
            | Command::Stop
            | Command::Hold
            | Command::Unsuspend
            | Command::Complete => {}
        }
        self.enter(command, now, output);
    }
}

/// Fails with the alarm whose cause remains, if there is one.
fn gone(cause: Option<&ListedAlarm>) -> Result<(), Refused> {
    match cause {
        Some(cause) => Err(Refused::CauseRemains(Box::new(cause.alarm.clone()))),
        None => Ok(()),
    }
}
