//! Orders: what a person at a screen or another program may ask of the station, and why not.
//!
//! Every order is answered in the turn in which it comes: taken, or refused with the reason in English
//! and Chinese. The same reasons stand beside the disabled buttons of a screen.

use super::packml::{self, Command, Mode, State};
use crate::handling::Move;

/// One order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Order {
    /// A command of the outer machine.
    Command(Command),
    /// Another mode.
    Mode(Mode),
    /// One motion by hand, through the same guard as every other.
    Jog(Move),
    /// In maintenance: the next motion of the sequence.
    Step,
    /// All lamps and the buzzer for a moment.
    LampTest,
    /// The lot is left as it is, so that another one can begin: the run ends.
    Leave,
    /// The lot ends after the parts inside, whatever its count.
    Close,
    /// A person has seen the alarm of this code; `None`: every alarm.
    Acknowledge(Option<String>),
    /// The alarm of this code is not to be shown for so many minutes, see [`shelf_minutes`].
    Shelve(String, u32),
}

/// Minutes on the shelf of an order that names so many: at least one, at most a shift; half an hour when it names none.
pub fn shelf_minutes(asked: Option<u32>) -> u32 {
    asked.unwrap_or(30).clamp(1, 480)
}

/// Why an order was not taken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refused {
    /// English.
    pub en: String,
    /// Chinese.
    pub zh: String,
}

impl Refused {
    /// A reason in both languages.
    pub fn new(en: impl Into<String>, zh: impl Into<String>) -> Self {
        Self {
            en: en.into(),
            zh: zh.into(),
        }
    }

    /// The command belongs to other states.
    pub fn wrong_state(command: Command, state: State) -> Self {
        let states: Vec<&str> = packml::states_for(command).map(State::name).collect();
        let (command, now, where_) = (command.name(), state.name(), states.join(", "));
        Self::new(
            format!("{command} is possible in {where_}; the machine is in {now}"),
            format!("“{command}”只能在以下状态执行：{where_}；当前状态为 {now}"),
        )
    }

    /// Only other modes know this.
    pub fn wrong_mode(what: &str, mode: Mode, needs: Mode) -> Self {
        let (found, needed) = (mode.name(), needs.name());
        Self::new(
            format!("{what} needs the mode {needed}; the mode is {found}"),
            format!("“{what}”需要 {needed} 模式；当前模式为 {found}"),
        )
    }
}

/// Motions that may be jogged, with their names in orders.
pub const JOGS: [(&str, Move); 15] = {
    use crate::rig::axis::AxisStation;
    use crate::rig::bin::Bin;
    [
        ("escapement_release", Move::EscapementRelease),
        ("escapement_hold", Move::EscapementHold),
        ("pusher_extend", Move::PusherExtend),
        ("pusher_retract", Move::PusherRetract),
        ("clamp_close", Move::ClampClose),
        ("clamp_open", Move::ClampOpen),
        ("probes_up", Move::ProbesUp),
        ("probes_down", Move::ProbesDown),
        ("sort_down", Move::SortDown),
        ("sort_up", Move::SortUp),
        ("gripper_close", Move::GripperClose),
        ("gripper_open", Move::GripperOpen),
        ("axis_nest", Move::AxisTo(AxisStation::Nest)),
        ("axis_park", Move::AxisTo(AxisStation::Park)),
        ("axis_retest", Move::AxisTo(AxisStation::Bin(Bin::RETEST))),
    ]
};

/// The motion of this name.
pub fn jog(name: &str) -> Option<Move> {
    JOGS.iter()
        .find(|(known, _)| *known == name)
        .map(|(_, movement)| *movement)
}
