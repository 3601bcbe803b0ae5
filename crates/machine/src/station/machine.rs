//! The outer machine as it stands: state, mode, and what a person or the program has asked of it.

use super::packml::{self, Mode, On, State};
use units::RigTime;

/// State and mode of the outer machine.
#[derive(Debug)]
pub(super) struct Machine {
    pub state: State,
    /// When the station had its last turn.
    turned_at: RigTime,
    /// When the state was entered; zero before the first turn.
    pub entered: RigTime,
    pub mode: Mode,
    /// The first turn, or the first since the modules were verified.
    pub began: Option<RigTime>,
    /// Nobody has started anything yet: the first start is the program's own.
    pub fresh: bool,
    /// The run is to end after the parts inside.
    pub stopping: bool,
    /// The run is over.
    pub ended: bool,
    /// A person asked for the suspension; it does not end by itself.
    pub suspended_by_order: bool,
    /// The modules are being verified, of this clearing.
    pub asked_verify: bool,
    /// When the modules were found as they should be, of this clearing.
    pub verified: Option<RigTime>,
}

impl Machine {
    /// Nothing has been asked yet.
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
            asked_verify: false,
            verified: None,
        }
    }

    /// Takes note of a turn.
    pub fn turn(&mut self, now: RigTime) {
        assert!(!self.ended, "a turn after the end");
        assert!(now >= self.turned_at, "the clock of the rig went back");
        self.turned_at = now;
    }

    /// Goes where the cause leads to; `None` when the state does not know it.
    pub fn follow(&mut self, on: On, now: RigTime) -> Option<State> {
        let to = packml::next(self.state, on)?;
        assert_ne!(to, self.state, "{on:?} leads nowhere");
        assert!(now.0 + 1 >= self.entered.0, "{to:?} entered in the past");
        self.state = to;
        self.entered = RigTime(now.0.max(1));
        Some(to)
    }

    /// Parts are on their way to where they may wait: nothing new begins.
    pub fn is_coming_to_rest(&self) -> bool {
        matches!(self.state, State::Holding | State::Suspending)
    }
}
