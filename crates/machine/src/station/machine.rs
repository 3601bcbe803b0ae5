//! State and mode of the rig's state machine ([`packml`]), with the pending requests of operator and program.

use super::packml::{self, Mode, On, State};
use units::RigTime;

/// State and mode of the rig's state machine ([`packml`]), with the pending requests.
#[derive(Debug)]
pub(super) struct Machine {
    pub state: State,
    /// Time of the last turn.
    turned_at: RigTime,
    /// Time at which the state was entered; zero before the first turn.
    pub entered: RigTime,
    pub mode: Mode,
    /// Time of the first turn since the start, or since the modules were verified last.
    pub began: Option<RigTime>,
    /// True until the first command, which the program itself gives.
    pub fresh: bool,
    /// True when the run ends once the parts inside are finished.
    pub stopping: bool,
    /// True once the run is over.
    pub ended: bool,
    /// True when an order caused the suspension, so that only an order ends it.
    pub suspended_by_order: bool,
    /// True once the present `Clearing` has requested the verification of the modules.
    pub verify_requested: bool,
    /// Time at which the modules were verified in the present `Clearing`.
    pub verified: Option<RigTime>,
}

impl Machine {
    /// Returns the machine before any request.
    pub fn new(state: State) -> Self {
        Self {
            state,
            turned_at: RigTime(0),
            entered: RigTime(0),
            mode: Mode::Production,
            began: None,
            fresh: true,
            stopping: false,
            ended: false,
            suspended_by_order: false,
            verify_requested: false,
            verified: None,
        }
    }

    /// Records the time of a turn.
    pub fn turn(&mut self, now: RigTime) {
        assert!(!self.ended, "a turn after the end");
        assert!(now >= self.turned_at, "the clock of the rig went back");
        self.turned_at = now;
    }

    /// Enters the state that follows on the cause; returns `None` when the state has no such transition.
    pub fn follow(&mut self, on: On, now: RigTime) -> Option<State> {
        let to = packml::next(self.state, on)?;
        assert_ne!(to, self.state, "{on:?} leads nowhere");
        assert!(now.0 + 1 >= self.entered.0, "{to:?} entered in the past");
        self.state = to;
        self.entered = RigTime(now.0.max(1));
        Some(to)
    }

    /// Returns true while parts go to their waiting positions and no new one begins.
    pub fn is_coming_to_rest(&self) -> bool {
        matches!(self.state, State::Holding | State::Suspending)
    }
}
