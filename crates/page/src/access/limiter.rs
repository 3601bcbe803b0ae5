//! Limits how often a wrong password may be tried.
//!
//! A name may fail five times within five minutes, all names together thirty times. Then the next try must wait until
//! the oldest of these failures is five minutes old. A right password clears the failures of its name. At most thirty
//! failures are kept.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Time for which a failure counts.
const WINDOW: Duration = Duration::from_secs(300);
/// Largest number of failures of one name within [`WINDOW`].
const PER_NAME: usize = 5;
/// Largest number of failures of all names within [`WINDOW`]: above the typing errors of a shift, far below what
/// guessing needs.
const IN_ALL: usize = 30;

/// Limits tries by the failures that still count, oldest first.
#[derive(Debug, Default)]
pub(crate) struct Limiter {
    failures: VecDeque<(Instant, String)>,
}

impl Limiter {
    /// Returns the time until the next try of `name`; `None` when it may try now.
    pub fn wait(&mut self, name: &str, now: Instant) -> Option<Duration> {
        self.forget(now);
        let mut own = self.failures.iter().rev().filter(|(_, it)| it == name);
        let binding = own.nth(PER_NAME - 1);
        let full = self.failures.len() >= IN_ALL;
        let oldest = binding.or_else(|| self.failures.front().filter(|_| full))?;
        Some(WINDOW.saturating_sub(now.duration_since(oldest.0)))
    }

    /// Counts a wrong password of `name`.
    pub fn failed(&mut self, name: &str, now: Instant) {
        self.forget(now);
        self.failures.push_back((now, name.to_owned()));
    }

    /// Forgets the failures of `name` after a right password.
    pub fn succeeded(&mut self, name: &str) {
        self.failures.retain(|(_, it)| it != name);
    }

    fn forget(&mut self, now: Instant) {
        let counts = |at: Instant| now.duration_since(at) < WINDOW;
        while self.failures.front().is_some_and(|it| !counts(it.0)) {
            self.failures.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn the_sixth_try_waits_five_minutes_from_the_first() {
        let start = Instant::now();
        let mut limiter = Limiter::default();
        for number in 0..5 {
            assert_eq!(limiter.wait("li", start + number * SECOND), None);
            limiter.failed("li", start + number * SECOND);
        }
        let later = start + 10 * SECOND;
        assert_eq!(limiter.wait("li", later), Some(290 * SECOND));
        assert_eq!(limiter.wait("wang", later), None);
        assert_eq!(limiter.wait("li", start + WINDOW), None);
    }

    #[test]
    fn thirty_failures_of_different_names_block_all_names() {
        let start = Instant::now();
        let mut limiter = Limiter::default();
        for number in 0..30 {
            limiter.failed(&number.to_string(), start);
        }
        assert_eq!(limiter.wait("li", start), Some(WINDOW));
        assert_eq!(limiter.wait("li", start + WINDOW), None);
    }

    #[test]
    fn a_right_password_clears_its_own_name_only() {
        let start = Instant::now();
        let mut limiter = Limiter::default();
        for name in ["li", "wang"] {
            (0..5).for_each(|_| limiter.failed(name, start));
        }
        limiter.succeeded("li");
        assert_eq!(limiter.wait("li", start), None);
        assert!(limiter.wait("wang", start).is_some());
    }
}
