//! The three push buttons at the machine. The station may refuse their orders like any other; the audit trail lists
//! them with the origin `panel`.
//!
//! | button | order |
//! |---|---|
//! | start | `unhold` in Held, `unsuspend` in Suspended, else `start` |
//! | stop | `stop`; an unattended run ends once the parts inside are finished |
//! | reset | `clear` after an abort, else `reset` |
//!
//! A button gives its order when it has been down for [`SETTLED`] after being up for as long: a bounce or a held button
//! never orders twice, and a button that is down at the start orders only after its release. If several buttons are
//! pressed, stop wins, then reset. A button down for [`HELD`] counts as stuck (`button_stuck`), which stops nothing. An
//! input without a sample is ignored.
//!
//! The debounce uses the times of the samples, so that one sample, however old it grows, never counts as settled.

use super::packml::{Command, State};
use super::trouble::Alarm;
use crate::handling::mechanism::SENSOR_AGE;
use crate::rig::image::Image;
use crate::rig::point::DigitalIn;
use units::{RigTime, Span};

/// Debounce time: contacts bounce for some 10 ms, a finger stays down for 100 ms.
const SETTLED: Span = Span::ms(30);
/// Time for which a button must be down to count as stuck.
const HELD: Span = Span::ms(5_000);

/// State of the three buttons.
#[derive(Debug)]
pub(super) struct Panel([Button; 3]);

#[derive(Debug)]
struct Button {
    point: DigitalIn,
    /// Last sampled state, and the time of the sample that first showed it.
    seen: Option<(bool, RigTime)>,
    /// True when the button has been released since its last order, or since the start.
    armed: bool,
}

impl Default for Panel {
    fn default() -> Self {
        let button = |point| Button {
            point,
            seen: None,
            armed: false,
        };
        let points = [
            DigitalIn::ButtonStop,
            DigitalIn::ButtonReset,
            DigitalIn::ButtonStart,
        ];
        Self(points.map(button))
    }
}

impl Panel {
    /// Returns the orders of the pressed buttons, for a machine in `state`, and the stuck buttons.
    pub(super) fn look(
        &mut self,
        now: RigTime,
        image: &Image,
        state: State,
    ) -> (Vec<Command>, Vec<Alarm>) {
        let (mut pressed, mut stuck) = (Vec::new(), Vec::new());
        for button in &mut self.0 {
            if button.orders(now, image) {
                pressed.push(command(button.point, state));
            }
            if button.is_stuck(now) {
                stuck.push(Alarm::button_stuck(button.point));
            }
        }
        // The buttons are in order of precedence; only the first order counts.
        pressed.truncate(1);
        (pressed, stuck)
    }
}

impl Button {
    /// Returns true when the button gives its order: once per press.
    fn orders(&mut self, now: RigTime, image: &Image) -> bool {
        let sample = image.input(self.point, now, SENSOR_AGE);
        let (Some(down), Some(at)) = (sample, image.input_at(self.point)) else {
            return false;
        };
        let since = match self.seen {
            Some((seen, since)) if seen == down => since,
            Some(_) | None => at,
        };
        assert!(since <= at, "a button changed after it was sampled");
        self.seen = Some((down, since));
        if at.since(since) < SETTLED {
            return false;
        }
        let orders = down && self.armed;
        self.armed = !down;
        orders
    }

    fn is_stuck(&self, now: RigTime) -> bool {
        self.seen
            .is_some_and(|(down, since)| down && now.since(since) >= HELD)
    }
}

fn command(button: DigitalIn, state: State) -> Command {
    match (button, state) {
        (DigitalIn::ButtonStop, _) => Command::Stop,
        (DigitalIn::ButtonReset, State::Aborted) => Command::Clear,
        (DigitalIn::ButtonReset, _) => Command::Reset,
        (_, State::Held) => Command::Unhold,
        (_, State::Suspended) => Command::Unsuspend,
        (_, _) => Command::Start,
    }
}
