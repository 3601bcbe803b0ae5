//! The contact of a part over time: the microseconds at which it closes and opens.

use std::collections::VecDeque;

/// State of the contact, with the changes that are known to come soon.
#[derive(Debug, Clone, Default)]
pub struct Contact {
    closed: bool,
    /// Changes in order of time: instant in microseconds, and whether the contact is closed from then on.
    ahead: VecDeque<(u64, bool)>,
}

impl Contact {
    /// Creates a contact at rest.
    pub fn new(closed: bool) -> Self {
        Self {
            closed,
            ahead: VecDeque::new(),
        }
    }

    /// Returns the state after all known changes.
    pub fn last(&self) -> bool {
        self.ahead.back().map_or(self.closed, |(_, closed)| *closed)
    }

    /// Adds a change; one before the last known change counts as simultaneous with it.
    pub fn change(&mut self, t_us: u64, closed: bool) {
        if closed != self.last() {
            let t_us = self.ahead.back().map_or(t_us, |(last, _)| t_us.max(*last));
            self.ahead.push_back((t_us, closed));
        }
    }

    /// Removes and returns the next change up to `t_us`.
    pub fn next(&mut self, t_us: u64) -> Option<(u64, bool)> {
        let due = self.ahead.front().is_some_and(|(at, _)| *at <= t_us);
        let change = due.then(|| self.ahead.pop_front()).flatten()?;
        self.closed = change.1;
        Some(change)
    }

    /// Checks whether the contact is closed after the changes that [`Self::next`] has returned.
    pub fn is_closed(&self) -> bool {
        self.closed
    }
}
