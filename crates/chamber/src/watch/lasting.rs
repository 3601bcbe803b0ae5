//! Conditions that last, and the range of recent readings.

use crate::statistics::{mean, slope};
use std::collections::VecDeque;

/// A condition that counts once it has lasted for some seconds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lasting {
    needed_s: u32,
    for_s: u32,
}

impl Lasting {
    /// Makes a condition that must last for `needed_s` seconds.
    pub const fn of(needed_s: u32) -> Self {
        Self { needed_s, for_s: 0 }
    }

    /// Takes the condition of this second and returns true when it has lasted.
    pub fn step(&mut self, holds: bool) -> bool {
        self.for_s = if holds {
            self.for_s.saturating_add(1)
        } else {
            0
        };
        self.for_s >= self.needed_s
    }
}

/// Recent values, one a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Recent {
    seconds: usize,
    values: VecDeque<f64>,
}

impl Recent {
    /// Makes a window over `seconds`, which holds one value more than that.
    pub const fn of(seconds: usize) -> Self {
        Self {
            seconds,
            values: VecDeque::new(),
        }
    }

    /// Forgets all values.
    pub fn clear(&mut self) {
        self.values.clear();
    }

    /// Adds the value of this second.
    pub fn push(&mut self, value: f64) {
        self.values.push_back(value);
        if self.values.len() > self.seconds + 1 {
            self.values.pop_front();
        }
    }

    /// Returns highest less lowest value; `None` before the window is full.
    pub fn range(&self) -> Option<f64> {
        let all = self.values.iter().copied();
        let high = all.clone().fold(f64::NEG_INFINITY, f64::max);
        let low = all.fold(f64::INFINITY, f64::min);
        self.is_full().then_some(high - low)
    }

    /// Returns the least-squares slope per second; `None` before the window is full.
    pub fn slope(&self) -> Option<f64> {
        self.is_full().then(|| slope(&self.values))
    }

    /// Returns the mean; `None` before the window is full.
    pub fn mean(&self) -> Option<f64> {
        self.is_full().then(|| mean(&self.values))
    }

    fn is_full(&self) -> bool {
        self.values.len() == self.seconds + 1
    }
}
