//! Orders of operators and programs to the station, and the reasons of refusals.
//!
//! The station answers every order in its turn: it performs the order or refuses it with a code and arguments, which a
//! screen shows next to a disabled button.

use super::packml::{self, Command, Mode, State};
use super::trouble::Alarm;
use crate::handling::Move;
use texts::Message;

/// One order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Order {
    /// A command to the rig's state machine.
    Command(Command),
    /// Changes the mode.
    Mode(Mode),
    /// One motion by hand, through the same guard as every other.
    Jog(Move),
    /// Drives the next motion of the sequence, in maintenance.
    Step,
    /// Lights all lamps and sounds the buzzer briefly.
    LampTest,
    /// Ends the run and leaves the lot as it is, so that another one can begin.
    Leave,
    /// Ends the lot once the parts inside are finished, whatever its count.
    Close,
    /// Acknowledges the alarm with this code; `None`: every alarm.
    Acknowledge(Option<String>),
    /// Hides the alarm with this code for a number of minutes, see [`shelf_minutes`].
    Shelve(String, u32),
}

/// Returns the shelving time in minutes: 1 to 480, 30 when the order names none.
pub fn shelf_minutes(requested: Option<u32>) -> u32 {
    requested.unwrap_or(30).clamp(1, 480)
}

/// Reason why an order is refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refused {
    /// The run is over.
    RunEnded,
    /// The state does not allow the command.
    WrongState(Command, State),
    /// The mode does not allow the order.
    WrongMode {
        /// Name of the order.
        order: &'static str,
        /// The mode.
        found: Mode,
        /// The mode that allows the order.
        needed: Mode,
    },
    /// Actuators have been jogged since the reset.
    MovedByHand,
    /// There is no lot to continue.
    NoLot,
    /// A part of the lot is still in nest or gripper.
    PartInside,
    /// Another lot needs a machine at rest; holds the state, and the command that leads to rest, if there is one.
    NotAtRest(State, Option<Command>),
    /// The mode can change only at rest.
    ModeLocked(State),
    /// A jog needs known positions.
    Unhomed(State),
    /// The previous motion has not arrived.
    StillMoving,
    /// No motion waits for a step.
    NoMotionWaits,
    /// The cause of this alarm remains.
    CauseRemains(Box<Alarm>),
    /// The list has no alarm with this code.
    NoSuchAlarm,
    /// The guard refuses the motion, for this reason.
    Collision(String),
    /// The program has refused the order before it reached the station, for this reason.
    Denied(String),
    /// A member of the order has an unknown word.
    UnknownWord {
        /// Name of the member.
        member: &'static str,
        /// The unknown word; empty when the member is missing.
        found: String,
        /// Every allowed word.
        known: Vec<&'static str>,
    },
    /// A shelving order needs a reason.
    ShelveWithoutReason,
}

impl Refused {
    /// Returns the text of the refusal, with its arguments.
    pub fn message(&self) -> Message {
        let of = |code| Message::new("refusal", code);
        let in_state = |code, state: &State| of(code).with("state", state.name());
        match self {
            Self::RunEnded => of("run_ended"),
            Self::WrongState(command, state) => {
                let states: Vec<&str> = packml::states_for(*command).map(State::name).collect();
                in_state("wrong_state", state)
                    .with("command", command.name())
                    .with("states", states.join(", "))
            }
            Self::WrongMode {
                order,
                found,
                needed,
            } => of("wrong_mode")
                .with("command", order)
                .with("found", found.name())
                .with("needed", needed.name()),
            Self::MovedByHand => of("moved_by_hand"),
            Self::NoLot => of("no_lot"),
            Self::PartInside => of("part_inside"),
            Self::NotAtRest(state, None) => in_state("not_at_rest", state),
            Self::NotAtRest(state, Some(first)) => {
                in_state("not_at_rest", state).case(first.name())
            }
            Self::ModeLocked(state) => in_state("mode_locked", state),
            Self::Unhomed(state) => in_state("unhomed", state),
            Self::StillMoving => of("still_moving"),
            Self::NoMotionWaits => of("no_motion_waits"),
            Self::CauseRemains(alarm) => alarm.inside("cause_remains"),
            Self::NoSuchAlarm => of("no_such_alarm"),
            Self::Collision(why) => of("collision").with("detail", why),
            Self::Denied(why) => of("denied").with("detail", why),
            Self::UnknownWord {
                member,
                found,
                known,
            } => of("unknown_word")
                .with("member", member)
                .with("found", if found.is_empty() { "nothing" } else { found })
                .with("known", known.join(", ")),
            Self::ShelveWithoutReason => of("shelve_without_reason"),
        }
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

/// Returns the motion of this name.
pub fn jog(name: &str) -> Option<Move> {
    JOGS.iter()
        .find(|(known, _)| *known == name)
        .map(|(_, movement)| *movement)
}
