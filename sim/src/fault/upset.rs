//! Modules that restart, trip, or are replaced by another product.
//!
//! A fault with the name of a module strikes that module once, at its instant; a fault with a probability strikes just
//! before a request.

use rand_chacha::ChaCha8Rng;

use super::value::{Chances, FaultRequest, Trigger};
use super::{Family, FaultEntry};
use crate::error::SimError;

const LIST: [FaultEntry; 3] = [
    FaultEntry {
        name: "reset",
        unit: "MODULE[@s] or probability",
        default: "board_do@5",
        what: "a module restarts",
    },
    FaultEntry {
        name: "watchdog_trip",
        unit: "MODULE[@s] or probability",
        default: "board_do@5",
        what: "a host watchdog expires early",
    },
    FaultEntry {
        name: "wrong_type",
        unit: "MODULE",
        default: "board_di",
        what: "another product sits at the address",
    },
];

/// Event that a fault causes in a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// The module restarts.
    Reset,
    /// The host watchdog of the module expires.
    Trip,
}

/// Event of one module at one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedEvent {
    /// Rig time, microseconds.
    pub at_us: u64,
    /// Identifier of the module.
    pub target: String,
    /// Event that occurs.
    pub event: Event,
}

#[derive(Default)]
pub(super) struct Upset {
    reset: Chances,
    trip: Chances,
    /// Events that have not struck yet, in order of time.
    timed: Vec<TimedEvent>,
    wrong_type: Vec<String>,
}

impl Family for Upset {
    fn list(&self) -> &'static [FaultEntry] {
        &LIST
    }

    fn add(&mut self, request: &FaultRequest<'_>) -> Result<(), SimError> {
        let (event, chances) = match request.name {
            "reset" => (Event::Reset, &mut self.reset),
            "watchdog_trip" => (Event::Trip, &mut self.trip),
            "wrong_type" => {
                self.wrong_type.push(request.value.to_owned());
                return Ok(());
            }
            name => unreachable!("fault `{name}` is listed without a branch here"),
        };
        match request.trigger()? {
            Trigger::Chance(..) => chances.add(request.probability()?, request.window),
            Trigger::Target(target) => self.timed.push(TimedEvent {
                at_us: request.window.from_us,
                target,
                event,
            }),
        }
        self.timed.sort_by_key(|timed| timed.at_us);
        Ok(())
    }

    fn targets(&self) -> Vec<&str> {
        let timed = self.timed.iter().map(|timed| timed.target.as_str());
        timed
            .chain(self.wrong_type.iter().map(String::as_str))
            .collect()
    }
}

impl Upset {
    /// Draws an event that strikes a module just before it receives this request.
    pub(super) fn before_a_request(&self, rng: &mut ChaCha8Rng, now_us: u64) -> Option<Event> {
        if self.reset.occurs(rng, now_us) {
            return Some(Event::Reset);
        }
        self.trip.occurs(rng, now_us).then_some(Event::Trip)
    }

    /// Removes and returns the next event that is due.
    pub(super) fn due(&mut self, now_us: u64) -> Option<TimedEvent> {
        let is_due = self.timed.first().is_some_and(|next| next.at_us <= now_us);
        is_due.then(|| self.timed.remove(0))
    }

    pub(super) fn is_wrong_type(&self, module: &str) -> bool {
        self.wrong_type.iter().any(|wrong| wrong == module)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::LineFaults;
    use super::Event;

    #[test]
    fn named_events_strike_once_in_order_of_time() {
        let mut faults = LineFaults::none(1);
        faults.add("reset", Some("timer@3")).unwrap();
        faults.add("watchdog_trip", Some("board_do@2")).unwrap();
        assert_eq!(faults.due(1_999_999), None);
        assert_eq!(faults.due(5_000_000).unwrap().event, Event::Trip);
        assert_eq!(faults.due(5_000_000).unwrap().target, "timer");
        assert_eq!(faults.due(5_000_000), None);
    }

    #[test]
    fn random_events_strike_before_a_request() {
        let mut faults = LineFaults::none(1);
        assert_eq!(faults.before_a_request(0), None);
        faults.add("watchdog_trip", Some("1@1")).unwrap();
        assert_eq!(faults.before_a_request(0), None);
        assert_eq!(faults.before_a_request(1_000_000), Some(Event::Trip));
    }
}
