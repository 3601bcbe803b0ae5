//! Orders of operators and programs to the station, and the reasons of refusals.
//!
//! The station answers every order in its turn: it performs the order or refuses it with a code and arguments, which a
//! screen shows next to a disabled button.

use super::packml::{self, Command, Mode, NextStep, State};
use super::trouble::Alarm;
use crate::handling::Move;
use crate::handling::serial::ScanRefused;
use texts::Message;

/// One order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Order {
    /// A command to the rig's state machine.
    Command(Command),
    /// Changes the mode.
    Mode(Mode),
    /// Drives one motion by hand; the guard judges it like any other.
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
    /// The code of the part that a person is about to load.
    Scan(String),
    /// Forgets the newest scan.
    Unscan,
    /// Answers the prompt of this name with this choice.
    Answer(String, String),
}

/// Returns the shelving time in minutes, limited to 1 to 480; 30 when the order names none.
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
    /// Another lot can begin only when the machine is at rest.
    NotAtRest(State),
    /// The mode can change only at rest.
    ModeLocked(State),
    /// A jog needs known positions.
    Unhomed(State),
    /// The previous motion has not arrived.
    StillMoving,
    /// A motion by hand ended before its sensors showed the end.
    NotArrived,
    /// No motion waits for a step.
    NoMotionWaits,
    /// The rig has a rack, and nothing on it moves.
    NothingMoves,
    /// The cause of this alarm remains.
    CauseRemains(Box<Alarm>),
    /// The list has no alarm with this code.
    NoSuchAlarm,
    /// The guard refuses the motion, for this reason.
    Collision(Box<Message>),
    /// The program refused the order, with this message, before the station received it.
    Denied(Box<Message>),
    /// The order `start` has a recipe, a count or a retest, but no lot.
    StartWithoutLot,
    /// The order changes rows of the history and does not concern the rig.
    NotOfTheRig,
    /// A shelving order needs a reason.
    ShelveWithoutReason,
    /// The scan cannot be the serial number of a further part.
    Scan(ScanRefused),
    /// An earlier run dropped scans whose parts may still lie in the magazine. Holds the alarm that names them: the rig
    /// takes no scan until a person acknowledges it.
    ScansDropped(Box<Alarm>),
    /// A prompt waits for its answer.
    PromptOpen,
    /// No prompt of this name waits.
    NoPrompt,
    /// The prompt has no such choice.
    NoSuchChoice,
}

impl Refused {
    /// Returns the message for the refusal; its text gives the reason or the next step.
    pub fn message(&self) -> Message {
        let of = |code| Message::new("refusal", code);
        let step = |code, state: &State, next: NextStep| {
            of(code).with("state", state.name()).with("next", next)
        };
        match self {
            Self::RunEnded => of("run_ended"),
            Self::WrongState(command, state) => {
                let states: Vec<&str> = packml::states_for(*command).map(State::name).collect();
                step("wrong_state", state, packml::next_step(*command, *state))
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
            Self::MovedByHand => of("moved_by_hand").with("next", NextStep::Stop),
            Self::NoLot => of("no_lot"),
            Self::PartInside => of("part_inside").with("next", NextStep::Reset),
            Self::NotAtRest(state) => step("not_at_rest", state, packml::to_rest(*state)),
            Self::ModeLocked(state) => step("mode_locked", state, packml::to_rest(*state)),
            Self::Unhomed(state) => step("unhomed", state, packml::to_idle(*state)),
            Self::StillMoving => of("still_moving"),
            Self::NotArrived => of("not_arrived"),
            Self::NoMotionWaits => of("no_motion_waits"),
            Self::NothingMoves => of("nothing_moves"),
            Self::CauseRemains(alarm) => alarm
                .inside("cause_remains")
                .with("next", alarm.code.text_id()),
            Self::NoSuchAlarm => of("no_such_alarm"),
            Self::Collision(why) => of("collision").with_inner("detail", why),
            Self::Denied(why) => (**why).clone(),
            Self::StartWithoutLot => of("start_without_lot"),
            Self::NotOfTheRig => of("not_of_the_rig"),
            Self::ShelveWithoutReason => of("shelve_without_reason"),
            Self::PromptOpen => of("prompt_open"),
            Self::NoPrompt => of("no_prompt"),
            Self::NoSuchChoice => of("no_such_choice"),
            Self::Scan(ScanRefused::NotScanned) => of("not_scanned"),
            Self::Scan(ScanRefused::Unreadable) => of("scan_unreadable"),
            Self::Scan(ScanRefused::Repeated) => of("scan_repeated"),
            Self::Scan(ScanRefused::TooMany) => of("scans_too_many"),
            Self::ScansDropped(alarm) => alarm.inside("scans_dropped"),
        }
    }
}

/// Motions that a person may jog; [`Move::code`] is their name in orders.
pub const JOGS: [Move; 15] = {
    use crate::rig::axis::AxisStation;
    use crate::rig::bin::Bin;
    [
        Move::EscapementRelease,
        Move::EscapementHold,
        Move::PusherExtend,
        Move::PusherRetract,
        Move::ClampClose,
        Move::ClampOpen,
        Move::ProbesUp,
        Move::ProbesDown,
        Move::SortDown,
        Move::SortUp,
        Move::GripperClose,
        Move::GripperOpen,
        Move::AxisTo(AxisStation::Nest),
        Move::AxisTo(AxisStation::Park),
        Move::AxisTo(AxisStation::Bin(Bin::RETEST)),
    ]
};

/// Names of the motions in [`JOGS`], in the same order.
pub const JOG_NAMES: [&str; JOGS.len()] = {
    let mut names = [""; JOGS.len()];
    let mut place = 0;
    while place < JOGS.len() {
        names[place] = JOGS[place].code();
        place += 1;
    }
    names
};

/// Returns the motion of this name.
pub fn jog(name: &str) -> Option<Move> {
    JOGS.into_iter().find(|it| it.code() == name)
}
