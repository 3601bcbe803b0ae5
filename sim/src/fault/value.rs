//! Syntax of a fault's value, and the time window in which the fault strikes.
//!
//! | form | example | means |
//! |---|---|---|
//! | probability | `drop=0.01` | strikes each request or reply independently |
//! | probability/ms | `late=0.01/200` | the same, with a duration |
//! | ms | `delay=20` | duration, milliseconds |
//! | MODULE or LINE | `reset=board_do@5` | key of a table in `rig.toml`; on a bench `module[N]` from 0, or `bench` |
//!
//! After `@` stands the second of rig time at which the fault begins, after `..` the second at which it ends:
//! `drop=0.5@10..12`. Without them the fault lasts from the start to the end of the run.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::error::SimError;

/// Time window of a fault, microseconds of rig time; the end is excluded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Window {
    pub(super) from_us: u64,
    /// End of the window; `None` for an open end.
    pub(super) until_us: Option<u64>,
}

impl Window {
    pub(super) fn holds(self, now_us: u64) -> bool {
        self.from_us <= now_us && self.until_us.is_none_or(|until| now_us < until)
    }
}

/// One fault as the command line requests it.
#[derive(Debug, Clone, Copy)]
pub(super) struct FaultRequest<'a> {
    pub(super) name: &'a str,
    /// Text before `@`.
    pub(super) value: &'a str,
    pub(super) window: Window,
}

/// Trigger of a fault: a probability, or the name of a module or line.
pub(super) enum Trigger<'a> {
    /// Probability, and the text after `/` if there is one.
    Chance(f64, Option<&'a str>),
    Target(String),
}

impl<'a> FaultRequest<'a> {
    /// Parses `VALUE[@FROM[..UNTIL]]`.
    pub(super) fn read(name: &'a str, text: &'a str) -> Result<Self, SimError> {
        let (value, times) = match text.split_once('@') {
            Some((value, times)) => (value, times),
            None => (text, "0"),
        };
        let instant = |seconds: &str| match seconds.parse::<f64>() {
            Ok(s) if (0.0..1e9).contains(&s) => Ok((s * 1e6).round() as u64),
            _ => Err(wrong(name, seconds, "seconds from 0 after `@`")),
        };
        let window = match times.split_once("..") {
            None => Window {
                from_us: instant(times)?,
                until_us: None,
            },
            Some((from, until)) => Window {
                from_us: instant(from)?,
                until_us: Some(instant(until)?),
            },
        };
        Ok(Self {
            name,
            value,
            window,
        })
    }

    /// Shifts the window so that its times count from `now_us`.
    pub(super) fn from(mut self, now_us: u64) -> Self {
        self.window.from_us += now_us;
        self.window.until_us = self.window.until_us.map(|until_us| until_us + now_us);
        self
    }

    pub(super) fn probability(&self) -> Result<f64, SimError> {
        self.probability_in(self.value)
    }

    pub(super) fn probability_in(&self, text: &str) -> Result<f64, SimError> {
        match text.parse::<f64>() {
            Ok(probability) if (0.0..=1.0).contains(&probability) => Ok(probability),
            _ => Err(wrong(self.name, text, "a probability from 0 to 1")),
        }
    }

    /// Parses milliseconds; returns microseconds.
    pub(super) fn ms(&self, text: &str) -> Result<u64, SimError> {
        match text.parse::<f64>() {
            Ok(ms) if (0.0..1e9).contains(&ms) => Ok((ms * 1e3).round() as u64),
            _ => Err(wrong(self.name, text, "milliseconds from 0")),
        }
    }

    /// Parses the trigger: a number is a probability, any other text the name of a module or line.
    pub(super) fn trigger(&self) -> Result<Trigger<'a>, SimError> {
        let (number, rest) = match self.value.split_once('/') {
            Some((number, rest)) => (number, Some(rest)),
            None => (self.value, None),
        };
        if number.parse::<f64>().is_ok() {
            Ok(Trigger::Chance(self.probability_in(number)?, rest))
        } else {
            Ok(Trigger::Target(self.value.to_owned()))
        }
    }
}

/// Probabilities, each with its time window.
#[derive(Debug, Clone, Default)]
pub(super) struct Chances(Vec<(f64, Window)>);

impl Chances {
    pub(super) fn one(probability: f64, window: Window) -> Self {
        Self(vec![(probability, window)])
    }

    pub(super) fn add(&mut self, probability: f64, window: Window) {
        self.0.push((probability, window));
    }

    /// Draws whether any of these faults strikes; draws nothing while no window is open.
    pub(super) fn occurs(&self, rng: &mut ChaCha8Rng, now_us: u64) -> bool {
        self.0.iter().any(|(probability, window)| {
            window.holds(now_us) && *probability > 0.0 && rng.random::<f64>() < *probability
        })
    }
}

/// Names of modules or lines, each with its time window.
#[derive(Debug, Clone, Default)]
pub(super) struct Targets(Vec<(String, Window)>);

impl Targets {
    pub(super) fn add(&mut self, name: String, window: Window) {
        self.0.push((name, window));
    }

    pub(super) fn hold(&self, name: &str, now_us: u64) -> bool {
        self.windows(name).any(|window| window.holds(now_us))
    }

    /// Returns all windows of a name.
    pub(super) fn windows(&self, name: &str) -> impl Iterator<Item = Window> {
        let mine = self.0.iter().filter(move |(known, _)| known == name);
        mine.map(|(_, window)| *window)
    }

    /// Removes windows that ended before `now_us`.
    pub(super) fn forget_before(&mut self, now_us: u64) {
        self.0
            .retain(|(_, window)| window.until_us.is_none_or(|until| now_us < until));
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|(name, _)| name.as_str())
    }
}

/// Builds the error for a value of the wrong form or range.
pub(super) fn wrong(name: &str, found: &str, expected: &str) -> SimError {
    SimError::FaultValue {
        name: name.into(),
        found: found.into(),
        expected: expected.into(),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_value_may_carry_a_time_window() {
        let request = FaultRequest::read("drop", "0.5@10..12.5").unwrap();
        assert_eq!(request.probability().unwrap(), 0.5);
        assert!(!request.window.holds(9_999_999));
        assert!(request.window.holds(10_000_000));
        assert!(!request.window.holds(12_500_000));
        assert!(FaultRequest::read("drop", "0.5").unwrap().window.holds(0));
    }

    #[test]
    fn the_error_names_the_fault_and_its_value() {
        for text in ["much", "-0.1", "1.5", "NaN"] {
            let request = FaultRequest::read("drop", text).unwrap();
            let error = request.probability().unwrap_err().to_string();
            assert!(error.contains("drop") && error.contains(text), "{error}");
        }
        for times in ["soon", "-1", "1..", "..", "inf"] {
            let text = format!("timer@{times}");
            assert!(FaultRequest::read("silence", &text).is_err(), "{text}");
        }
        assert!(FaultRequest::read("delay", "x").unwrap().ms("x").is_err());
    }
}
