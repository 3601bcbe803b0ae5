//! Stack light and buzzer: one look tells whether the line makes parts, waits, or needs somebody.
//!
//! | light | when |
//! |---|---|
//! | green | parts are made or finished |
//! | yellow | waits: idle, held, suspended, complete, or on its way there |
//! | red | aborted, or an alarm that nobody has acknowledged stops something |
//! | buzzer | the first [`CALL`] of a red light |

use super::annunciator::{Condition, Standing};
use super::catalogue::Reaction;
use super::packml::{self, State};
use crate::rig::point::DigitalOut;
use units::{RigTime, Span};

/// How long the buzzer calls.
const CALL: Span = Span::ms(2000);
/// How long a lamp test lasts.
const TEST: Span = Span::ms(3000);

const POINTS: [DigitalOut; 4] = [
    DigitalOut::LampGreen,
    DigitalOut::LampYellow,
    DigitalOut::LampRed,
    DigitalOut::Buzzer,
];

/// What is lit.
#[derive(Debug, Default)]
pub struct Lamps {
    lit: [bool; 4],
    red_since: Option<RigTime>,
    test_until: Option<RigTime>,
}

impl Lamps {
    /// Everything lights for a moment.
    pub fn test(&mut self, now: RigTime) {
        self.test_until = Some(now + TEST);
    }

    /// Outputs that change. `safe`: everything has just been switched off.
    pub fn show(
        &mut self,
        now: RigTime,
        state: State,
        standing: &[Standing],
        safe: bool,
    ) -> Vec<(DigitalOut, bool)> {
        if safe {
            self.lit = [false; 4];
        }
        let stops = |one: &Standing| one.alarm.code.entry().reaction != Reaction::Nothing;
        let unseen = standing
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
