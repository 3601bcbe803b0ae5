//! Stack light and buzzer.
//!
//! | light | when |
//! |---|---|
//! | green | the line homes, calibrates, feeds or finishes parts |
//! | yellow | the line waits or comes to rest: idle, held, suspended, complete |
//! | red | aborted, or an unacknowledged alarm with a reaction |
//! | buzzer | for [`CALL`] after the red light has come on |

use super::annunciator::{Condition, ListedAlarm};
use super::catalogue::Reaction;
use super::packml::{self, State};
use crate::rig::point::DigitalOut;
use units::{RigTime, Span};

/// Duration of the buzzer.
const CALL: Span = Span::ms(2000);
/// Duration of a lamp test.
const TEST: Span = Span::ms(3000);

const POINTS: [DigitalOut; 4] = [
    DigitalOut::LampGreen,
    DigitalOut::LampYellow,
    DigitalOut::LampRed,
    DigitalOut::Buzzer,
];

/// State of the lamps.
#[derive(Debug, Default)]
pub struct Lamps {
    lit: [bool; 4],
    red_since: Option<RigTime>,
    test_until: Option<RigTime>,
}

impl Lamps {
    /// Begins a lamp test.
    pub fn test(&mut self, now: RigTime) {
        self.test_until = Some(now + TEST);
    }

    /// Returns the outputs that change. `safe`: the rig has just switched every output off.
    pub fn show(
        &mut self,
        now: RigTime,
        state: State,
        listed: &[ListedAlarm],
        safe: bool,
    ) -> Vec<(DigitalOut, bool)> {
        if safe {
            self.lit = [false; 4];
        }
        let stops = |one: &ListedAlarm| one.alarm.code.entry().reaction != Reaction::Nothing;
        let unseen = listed
            .iter()
            .any(|one| one.condition == Condition::Unacknowledged && stops(one));
        let red = packml::is_aborted(state) || unseen;
        self.red_since = match (red, self.red_since) {
            (true, None) => Some(now),
            (true, since) => since,
            (false, _) => None,
        };
        let since = self.red_since.unwrap_or(now);
        assert!(since <= now, "red since the future");
        let call = self.red_since.is_some_and(|since| now.since(since) < CALL);
        let testing = self.test_until.is_some_and(|until| now < until);
        let green = makes_parts(state);
        let wanted = if testing {
            [true; 4]
        } else {
            [green, waits(state), red, call]
        };
        let changed = (0..4).filter(|i| wanted[*i] != self.lit[*i]);
        let changes = changed.map(|i| (POINTS[i], wanted[i])).collect();
        self.lit = wanted;
        changes
    }
}

fn makes_parts(state: State) -> bool {
    matches!(
        state,
        State::Resetting | State::Starting | State::Execute | State::Completing | State::Stopping
    )
}

fn waits(state: State) -> bool {
    matches!(
        state,
        State::Idle
            | State::Complete
            | State::Holding
            | State::Held
            | State::Unholding
            | State::Suspending
            | State::Suspended
            | State::Unsuspending
    )
}
