//! The outer machine: states, commands and modes with the names of ISA-TR88.00.02 (PackML).
//!
//! [`TRANSITIONS`] is the only source of the order of states: station, screen buttons and `golden/packml.dot`
//! follow from it. Feed, clamp, measure and sort run inside `Execute`
//! (and are finished inside `Completing`, `Stopping` and `Holding`).
//!
//! - *Held*: the cause is inside the machine, a person ends it. *Suspended*: the cause is outside (no
//!   parts, a bin is full), and the machine goes on by itself.
//! - A reset never starts anything; an acknowledgement never resets, a reset never acknowledges.
//! - Names are stored, never numbers.

/// Declares an enum with the names that screens, orders and files use.
macro_rules! names {
    ($(#[$doc:meta])* $kind:ident { $($(#[$line:meta])* $variant:ident = $name:literal,)+ }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum $kind { $($(#[$line])* $variant,)+ }

        impl $kind {
            /// Every one, in the order of declaration.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The name outside of the program.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }

            /// The one of this name.
            pub fn from_name(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|one| one.name() == name)
            }
        }
    };
}

names! {
    /// State of the outer machine.
    State {
        /// Powered, outputs safe, nothing assumed of any position.
        Stopped = "Stopped",
        /// Sensors are read, actuators brought home, parts found inside are discharged.
        Resetting = "Resetting",
        /// Home and empty, waits for a start.
        Idle = "Idle",
        /// References are measured in the empty nest when there is no calibration.
        Starting = "Starting",
        /// Parts are fed, tested and sorted.
        Execute = "Execute",
        /// The count is reached, the parts inside are finished.
        Completing = "Completing",
        /// The lot is done, outputs are safe.
        Complete = "Complete",
        /// On its way to a point where the sequence can rest.
        Holding = "Holding",
        /// At rest, cause inside the machine.
        Held = "Held",
        /// Looks whether everything still stands where it stood.
        Unholding = "Unholding",
        /// On its way to rest, cause outside the machine.
        Suspending = "Suspending",
        /// At rest, cause outside the machine.
        Suspended = "Suspended",
        /// The cause outside has gone.
        Unsuspending = "Unsuspending",
        /// The parts inside are finished, then outputs go safe.
        Stopping = "Stopping",
        /// Outputs are being made safe.
        Aborting = "Aborting",
        /// Outputs are safe, an alarm stands or stood.
        Aborted = "Aborted",
        /// Modules are verified again.
        Clearing = "Clearing",
    }
}

names! {
    /// What a person or another machine may ask of the outer machine.
    Command {
        /// Home and empty the machine.
        Reset = "reset",
        /// Begin the lot.
        Start = "start",
        /// End after the parts inside.
        Stop = "stop",
        /// Rest at the next possible point.
        Hold = "hold",
        /// Go on after a hold.
        Unhold = "unhold",
        /// Rest for a cause outside.
        Suspend = "suspend",
        /// The cause outside has gone.
        Unsuspend = "unsuspend",
        /// Outputs safe at once.
        Abort = "abort",
        /// The cause of an abort is gone.
        Clear = "clear",
        /// End the lot after the parts inside, although its count is not reached.
        Complete = "complete",
    }
}

names! {
    /// What the machine is used for.
    Mode {
        /// Lots.
        Production = "production",
        /// Lots motion by motion, and jogging.
        Maintenance = "maintenance",
        /// Jogging only.
        Manual = "manual",
    }
}

/// What makes a transition happen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum On {
    /// A command.
    Command(Command),
    /// The state has done what it is for.
    Done,
}

/// One row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// State left.
    pub from: State,
    /// Why.
    pub on: On,
    /// State entered.
    pub to: State,
}

const fn order(from: State, command: Command, to: State) -> Transition {
    Transition {
        from,
        on: On::Command(command),
        to,
    }
}

const fn done(from: State, to: State) -> Transition {
    Transition {
        from,
        on: On::Done,
        to,
    }
}

/// Every transition but `stop` and `abort`, which [`next`] adds for all states that know them.
pub const TRANSITIONS: &[Transition] = &[
    order(State::Stopped, Command::Reset, State::Resetting),
    done(State::Resetting, State::Idle),
    order(State::Idle, Command::Start, State::Starting),
    done(State::Starting, State::Execute),
    done(State::Execute, State::Completing),
    order(State::Execute, Command::Complete, State::Completing),
    done(State::Completing, State::Complete),
    order(State::Completing, Command::Hold, State::Holding),
    order(State::Complete, Command::Reset, State::Resetting),
    order(State::Execute, Command::Hold, State::Holding),
    done(State::Holding, State::Held),
    order(State::Held, Command::Unhold, State::Unholding),
    order(State::Held, Command::Complete, State::Completing),
    done(State::Unholding, State::Execute),
    order(State::Execute, Command::Suspend, State::Suspending),
    done(State::Suspending, State::Suspended),
    order(State::Suspended, Command::Unsuspend, State::Unsuspending),
    order(State::Suspended, Command::Hold, State::Holding),
    order(State::Suspended, Command::Complete, State::Completing),
    done(State::Unsuspending, State::Execute),
    done(State::Stopping, State::Stopped),
    done(State::Aborting, State::Aborted),
    order(State::Aborted, Command::Clear, State::Clearing),
    done(State::Clearing, State::Stopped),
];

/// The state that follows, or none when the state does not know the cause.
pub fn next(from: State, on: On) -> Option<State> {
    let row = TRANSITIONS
        .iter()
        .find(|row| row.from == from && row.on == on);
    match on {
        On::Command(Command::Abort) if !is_aborted(from) => Some(State::Aborting),
        On::Command(Command::Stop) if may_stop(from) => Some(State::Stopping),
        On::Command(_) | On::Done => row.map(|row| row.to),
    }
}

/// An abort is under way or done.
pub fn is_aborted(state: State) -> bool {
    matches!(state, State::Aborting | State::Aborted)
}

/// There is something that a stop would end.
fn may_stop(state: State) -> bool {
    !is_aborted(state) && !matches!(state, State::Clearing | State::Stopping | State::Stopped)
}

/// States that know a command, in the order of declaration.
pub fn states_for(command: Command) -> impl Iterator<Item = State> {
    State::ALL
        .iter()
        .copied()
        .filter(move |state| next(*state, On::Command(command)).is_some())
}

/// A mode may be chosen here.
pub fn may_change_mode(state: State) -> bool {
    matches!(
        state,
        State::Stopped | State::Idle | State::Complete | State::Aborted
    )
}

/// The whole machine as a Graphviz drawing.
pub fn dot() -> String {
    let mut text = String::from("digraph packml {\n  rankdir=LR;\n");
    for from in State::ALL {
        let commands = Command::ALL.iter().map(|command| On::Command(*command));
        for on in commands.chain([On::Done]) {
            if let Some(to) = next(*from, on) {
                let label = match on {
                    On::Command(command) => command.name(),
                    On::Done => "done",
                };
                text += &format!("  {} -> {} [label=\"{label}\"];\n", from.name(), to.name());
            }
        }
    }
    text + "}\n"
}
