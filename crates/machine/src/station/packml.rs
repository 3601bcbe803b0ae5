//! State machine of the whole rig, around those of feed, nest and sorter, with names of ISA-TR88.00.02 (PackML).
//!
//! [`TRANSITIONS`] alone defines the order of states: station, screen buttons and `golden/packml.dot` derive from it.
//! `Execute` feeds, clamps, measures and sorts parts; `Completing` and `Stopping` finish those inside, `Holding` brings
//! them to rest.
//!
//! - *Held*: the cause is inside the machine, and a person ends it. *Suspended*: the cause is outside (no parts, a
//!   full bin), and the machine resumes by itself.
//! - A reset starts and acknowledges nothing; an acknowledgement resets nothing.
//! - Files hold the names of states, never numbers.

named! {
    /// State of the rig; each variant says what the rig does, or in which condition it is.
    State {
        /// Powered, outputs safe, every position unknown.
        Stopped = "Stopped",
        /// Reads sensors, homes actuators, discharges parts found inside.
        Resetting = "Resetting",
        /// Homed and empty; waits for a start.
        Idle = "Idle",
        /// Measures the references in the empty nest if there is no calibration.
        Starting = "Starting",
        /// Feeds, tests and sorts parts.
        Execute = "Execute",
        /// Finishes the parts inside at the end of the lot.
        Completing = "Completing",
        /// The lot is done, outputs are safe.
        Complete = "Complete",
        /// Moves to a point at which the sequence can rest; the cause is inside the machine.
        Holding = "Holding",
        /// At rest; the cause is inside the machine.
        Held = "Held",
        /// Checks that parts and actuators are where they were.
        Unholding = "Unholding",
        /// Moves to a point at which the sequence can rest; the cause is outside the machine.
        Suspending = "Suspending",
        /// At rest; the cause is outside the machine.
        Suspended = "Suspended",
        /// Resumes after the cause outside the machine has gone.
        Unsuspending = "Unsuspending",
        /// Finishes the parts inside, then makes the outputs safe.
        Stopping = "Stopping",
        /// Makes the outputs safe.
        Aborting = "Aborting",
        /// Outputs are safe after an abort.
        Aborted = "Aborted",
        /// Verifies the modules again.
        Clearing = "Clearing",
    }
}

named! {
    /// Commands that a person or another machine may give; each variant says what the rig then does.
    Command {
        /// Homes and empties the machine.
        Reset = "reset",
        /// Begins the lot.
        Start = "start",
        /// Ends the run once the parts inside are finished.
        Stop = "stop",
        /// Brings the line to rest at the next possible point.
        Hold = "hold",
        /// Resumes after a hold.
        Unhold = "unhold",
        /// Brings the line to rest for a cause outside the machine.
        Suspend = "suspend",
        /// Resumes after the cause outside the machine has gone.
        Unsuspend = "unsuspend",
        /// Makes the outputs safe at once.
        Abort = "abort",
        /// Leaves `Aborted` after the cause has gone.
        Clear = "clear",
        /// Ends the lot once the parts inside are finished, before its count is reached.
        Complete = "complete",
    }
}

named! {
    /// Mode of the rig; each variant says what an operator may have it do.
    Mode {
        /// Runs lots.
        Production = "production",
        /// Runs lots motion by motion, and jogs.
        Maintenance = "maintenance",
        /// Jogs only.
        Manual = "manual",
    }
}

named! {
    /// Next step towards a command that the state does not allow, or the reason why there is no such step. The names
    /// are codes of the text family `next`.
    NextStep {
        /// Wait until the machine rests.
        Wait = "wait",
        /// Clear the alarm.
        Clear = "clear",
        /// Reset the machine.
        Reset = "reset",
        /// Start the lot.
        Start = "start",
        /// Stop the machine.
        Stop = "stop",
        /// Go on after the hold.
        Unhold = "unhold",
        /// None: the machine is already where the command leads.
        Already = "already",
        /// None: the machine resumes by itself.
        Resumes = "resumes",
        /// None: no alarm has stopped the machine.
        NothingToClear = "nothing_to_clear",
    }
}

/// Returns what a person does next towards `command`, which the machine refuses in `state`.
pub fn next_step(command: Command, state: State) -> NextStep {
    match (state, command) {
        (
            State::Resetting
            | State::Starting
            | State::Completing
            | State::Holding
            | State::Unholding
            | State::Suspending
            | State::Unsuspending
            | State::Stopping
            | State::Aborting
            | State::Clearing,
            _,
        ) => NextStep::Wait,
        (State::Aborted | State::Stopped, Command::Stop)
        | (State::Aborted, Command::Abort)
        | (State::Idle, Command::Reset)
        | (State::Complete, Command::Complete)
        | (State::Held, Command::Hold)
        | (State::Suspended, Command::Suspend)
        | (State::Execute, Command::Start | Command::Unhold | Command::Unsuspend) => {
            NextStep::Already
        }
        (State::Aborted, _) => NextStep::Clear,
        (_, Command::Clear) => NextStep::NothingToClear,
        (State::Stopped | State::Complete, _) => NextStep::Reset,
        (State::Idle, _) => NextStep::Start,
        (State::Held | State::Suspended | State::Execute, Command::Reset) => NextStep::Stop,
        (State::Held, _) => NextStep::Unhold,
        (State::Suspended | State::Execute, _) => NextStep::Resumes,
    }
}

/// Returns the next step that brings the machine to rest, where mode and lot may change.
pub fn to_rest(state: State) -> NextStep {
    if state == State::Aborted {
        NextStep::Clear
    } else if may_stop(state) {
        NextStep::Stop
    } else {
        NextStep::Wait
    }
}

/// Returns the next step towards state `Idle`, in which a person may jog actuators.
pub fn to_idle(state: State) -> NextStep {
    match next(state, On::Command(Command::Reset)) {
        Some(_) => NextStep::Reset,
        None => next_step(Command::Reset, state),
    }
}

/// Cause of a transition.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum On {
    /// A command.
    Command(Command),
    /// The state has completed its action.
    Done,
}

/// One row of [`TRANSITIONS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// State that the machine leaves.
    pub from: State,
    /// Cause of the transition.
    pub on: On,
    /// State that the machine enters.
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

/// Every transition except those of `stop` and `abort`, which [`next`] adds for all states that allow them.
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

/// Returns the state that follows; `None` when the state has no such transition.
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

/// Returns true while an abort is under way or done.
pub fn is_aborted(state: State) -> bool {
    matches!(state, State::Aborting | State::Aborted)
}

/// Returns true when the state allows a stop.
fn may_stop(state: State) -> bool {
    !is_aborted(state) && !matches!(state, State::Clearing | State::Stopping | State::Stopped)
}

/// Returns the states that allow a command, in the order of declaration.
pub fn states_for(command: Command) -> impl Iterator<Item = State> {
    State::ALL
        .iter()
        .copied()
        .filter(move |state| next(*state, On::Command(command)).is_some())
}

/// Returns true when the state allows a change of mode.
pub fn may_change_mode(state: State) -> bool {
    matches!(
        state,
        State::Stopped | State::Idle | State::Complete | State::Aborted
    )
}

/// Returns the whole machine as a Graphviz drawing.
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
