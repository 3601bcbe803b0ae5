//! Orders answered: what may be done now, and why not.

use super::Station;
use super::annunciator::Standing;
use super::orders::{Order, Refused, shelf_minutes};
use super::packml::{self, Command, Mode, On, State};
use super::trouble::Alarm;
use super::wants::{Ending, Wants};
use crate::handling::Place;
use crate::handling::wants::Jog;
use crate::rig::image::Image;
use crate::units::{RigTime, Span};

impl Station {
    /// Takes an order or says why not.
    pub(super) fn order(
        &mut self,
        order: Order,
        now: RigTime,
        wants: &mut Wants,
    ) -> Result<(), Refused> {
        if self.machine.ended {
            return Err(Refused::new("the run has ended", "本次运行已结束"));
        }
        match order {
            Order::Command(command) => {
                self.may(command)?;
                self.command(command, now, wants);
            }
            Order::Mode(mode) => {
                self.may_change_mode()?;
                self.machine.mode = mode;
            }
            Order::Jog(movement) => {
                self.may_jog()?;
                let answer = wants.answers.len();
                wants.rig.jog = Some(Jog { movement, answer });
            }
            Order::Step => {
                self.may_step()?;
                wants.rig.motions.extend(self.line.stepwise.pop_front());
            }
            Order::LampTest => self.alarms.lamps.test(now),
            Order::Leave => {
                self.may_leave()?;
                self.leave(Ending::Stopped, now, wants);
            }
            Order::Close => {
                self.may_close()?;
                if self.may(Command::Complete).is_ok() {
                    self.command(Command::Complete, now, wants);
                } else {
                    self.leave(Ending::Complete, now, wants);
                }
            }
            Order::Acknowledge(code) => {
                if !self.alarms.annunciator.acknowledge(code.as_deref()) && code.is_some() {
                    return Err(no_alarm());
                }
            }
            Order::Shelve(code, minutes) => {
                let minutes = shelf_minutes(Some(minutes));
                let until = now + Span::ms(u64::from(minutes) * 60_000);
                assert!(until > now, "shelved for no time");
                if !self.alarms.annunciator.shelve(&code, until) {
                    return Err(no_alarm());
                }
            }
        }
        Ok(())
    }

    /// Buttons at the machine: their orders are answered here; what is stuck is given back.
    pub(super) fn pressed(&mut self, now: RigTime, image: &Image, wants: &mut Wants) -> Vec<Alarm> {
        let (commands, stuck) = self.alarms.panel.look(now, image, self.machine.state);
        for command in commands {
            let answer = self.order(Order::Command(command), now, wants);
            // Nobody is there to start again.
            self.machine.stopping |= command == Command::Stop && !self.plan.stays;
            wants.pressed.push((command, answer));
        }
        stuck
    }

    /// Whether a command would be taken now; the reason stands beside its button.
    ///
    /// # Errors
    /// The reason why not.
    pub fn may(&self, command: Command) -> Result<(), Refused> {
        if packml::next(self.machine.state, On::Command(command)).is_none() {
            return Err(Refused::wrong_state(command, self.machine.state));
        }
        match command {
            Command::Reset | Command::Clear => match self.cause() {
                Some(cause) => Err(still_there(cause)),
                None => Ok(()),
            },
            Command::Start => self.may_start(),
            Command::Unsuspend => match self
                .alarms
                .annunciator
                .stopping(super::catalogue::Stops::Suspend)
            {
                Some(cause) => Err(still_there(cause)),
                None => Ok(()),
            },
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
            return Err(Refused::wrong_mode(
                "start",
                self.machine.mode,
                Mode::Production,
            ));
        }
        if !self.line.homed {
            return Err(Refused::new(
                "actuators were moved by hand since the reset; stop and reset first",
                "复位后执行机构被手动移动过；请先停止并复位",
            ));
        }
        if self.is_between_lots() {
            return Err(Refused::new(
                "no lot is under way; choose one on the page of lots",
                "当前没有批次；请在“批次”页选择",
            ));
        }
        Ok(())
    }

    /// Whether the lot may be left where it is, so that another one can begin.
    ///
    /// # Errors
    /// The reason why not.
    pub fn may_leave(&self) -> Result<(), Refused> {
        if self.machine.mode != Mode::Production {
            return Err(Refused::wrong_mode(
                "start",
                self.machine.mode,
                Mode::Production,
            ));
        }
        if !matches!(
            self.machine.state,
            State::Stopped | State::Idle | State::Complete
        ) {
            return Err(self.not_at_rest());
        }
        if self.line.ledger.holds(Place::NEST) || self.line.ledger.holds(Place::Gripper) {
            return Err(Refused::new(
                "a part of this lot is inside; reset first, so that it gets into its bin",
                "机内还有本批次的零件；请先复位，使其进入料仓",
            ));
        }
        Ok(())
    }

    fn not_at_rest(&self) -> Refused {
        let state = self.machine.state.name();
        Refused::new(
            format!(
                "another lot can be begun in Stopped, Idle and Complete; the machine is in {state}{}",
                self.way_out().0
            ),
            format!(
                "只能在 Stopped、Idle、Complete 状态开始其他批次；当前状态为 {state}{}",
                self.way_out().1
            ),
        )
    }

    /// What a person does first, in both languages.
    fn way_out(&self) -> (&'static str, &'static str) {
        if packml::is_aborted(self.machine.state) {
            ("; clear it first", "；请先清除")
        } else if packml::next(self.machine.state, On::Command(Command::Stop)).is_some() {
            ("; stop it first", "；请先停止")
        } else {
            ("", "")
        }
    }

    /// Whether the lot may be ended although its count is not reached.
    ///
    /// # Errors
    /// The reason why not.
    pub fn may_close(&self) -> Result<(), Refused> {
        self.may(Command::Complete).or_else(|_| self.may_leave())
    }

    /// Whether the mode may be changed now.
    ///
    /// # Errors
    /// The reason why not.
    pub fn may_change_mode(&self) -> Result<(), Refused> {
        if packml::may_change_mode(self.machine.state) {
            return Ok(());
        }
        let state = self.machine.state.name();
        Err(Refused::new(
            format!(
                "the mode can be changed in Stopped, Idle, Complete and Aborted; the machine is in {state}"
            ),
            format!("只能在 Stopped、Idle、Complete、Aborted 状态切换模式；当前状态为 {state}"),
        ))
    }

    /// Whether an actuator may be moved by hand now; what it would touch is the guard's to say.
    ///
    /// # Errors
    /// The reason why not.
    pub fn may_jog(&self) -> Result<(), Refused> {
        if self.machine.mode == Mode::Production {
            return Err(Refused::wrong_mode("jog", self.machine.mode, Mode::Manual));
        }
        if self.machine.state != State::Idle {
            let state = self.machine.state.name();
            return Err(Refused::new(
                format!("unhomed: jogging needs Idle after a reset; the machine is in {state}"),
                format!("未回原点：点动需要复位后处于 Idle 状态；当前状态为 {state}"),
            ));
        }
        if self.line.mechanism.moving().next().is_some() {
            return Err(Refused::new(
                "the motion before has not arrived",
                "上一个动作尚未到位",
            ));
        }
        Ok(())
    }

    /// Whether there is a motion to be released by hand.
    ///
    /// # Errors
    /// The reason why not.
    pub fn may_step(&self) -> Result<(), Refused> {
        if self.machine.mode != Mode::Maintenance {
            return Err(Refused::wrong_mode(
                "step",
                self.machine.mode,
                Mode::Maintenance,
            ));
        }
        if self.line.stepwise.is_empty() {
            return Err(Refused::new(
                "no motion waits for a step",
                "没有等待单步的动作",
            ));
        }
        Ok(())
    }

    /// An actuator was moved by hand: home is not home any more.
    pub fn jogged(&mut self) {
        self.line.homed = false;
    }

    fn leave(&mut self, ending: Ending, now: RigTime, wants: &mut Wants) {
        self.make_safe("stopped", now, wants);
        self.end(ending, now, wants);
    }

    fn command(&mut self, command: Command, now: RigTime, wants: &mut Wants) {
        self.machine.fresh = false;
        match command {
            Command::Abort => return self.abort("abort ordered", now, wants),
            Command::Clear | Command::Unhold | Command::Reset => self.alarms.annunciator.cleared(),
            Command::Suspend => self.machine.suspended_by_order = true,
            Command::Start
            | Command::Stop
            | Command::Hold
            | Command::Unsuspend
            | Command::Complete => {}
        }
        self.enter(command, now, wants);
    }
}

fn still_there(cause: &Standing) -> Refused {
    let alarm = &cause.alarm;
    Refused::new(
        format!("the cause is still there: {}", alarm.text(texts::Lang::En)),
        format!("原因仍然存在：{}", alarm.text(texts::Lang::Zh)),
    )
}

fn no_alarm() -> Refused {
    Refused::new("no such alarm stands", "没有该报警")
}
