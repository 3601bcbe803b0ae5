//! Feedback and feed-forward of a chamber: from a set point and a reading to heater and vent, once a second.
//!
//! One signed power serves heater and vent: above zero it is the duty of the heater, below zero it opens the vent
//! ([`SplitRange`]). [`Law`] lists the laws of the feedback; all take the same feed-forward, which does most of the
//! work on a ramp.

pub mod feed_forward;
pub mod filter;
pub mod fuzzy;
pub mod increment;
pub mod pid;
pub mod scheduled;
pub mod split_range;

use crate::ramp::SetPoint;
use crate::tune::{Identified, Settings};
use feed_forward::FeedForward;
use filter::Delay;
use increment::Increment;
use pid::Pid;
use scheduled::FuzzyPid;
use split_range::{Command, SplitRange, VentLag};

/// Input of a feedback law in one second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Task {
    /// Set point minus measured temperature, K.
    pub error_k: f64,
    /// Input of the derivative, C: the measured temperature; with feed-forward, the measured temperature minus the set
    /// point.
    pub moving_c: f64,
    /// Power of the feed-forward, 1 = full heater.
    pub forward: f64,
    /// Lowest power: that of the fully open vent, at most 0.
    pub lowest: f64,
    /// Highest power.
    pub highest: f64,
}

/// A feedback law with its state.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// PID with back-calculation.
    Pid(Pid),
    /// Fuzzy table whose output changes the power.
    Fuzzy(Increment),
    /// PID whose gains a fuzzy table adjusts.
    FuzzyPid(FuzzyPid),
}

impl Law {
    fn step(&mut self, task: &Task) -> f64 {
        match self {
            Self::Pid(law) => law.step(task),
            Self::Fuzzy(law) => law.step(task),
            Self::FuzzyPid(law) => law.step(task),
        }
    }

    fn shift(&mut self, by: f64) {
        match self {
            Self::Pid(law) => law.shift(by),
            Self::Fuzzy(law) => law.shift(by),
            Self::FuzzyPid(law) => law.shift(by),
        }
    }
}

/// Readings of the chamber in one second, for the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observed {
    /// Control sensor, C; NaN without a reading.
    pub measured_c: f64,
    /// Temperature around the chamber, C.
    pub ambient_c: f64,
}

/// A controller: feed-forward, feedback law and split range.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    law: Law,
    forward: Option<FeedForward>,
    delay: Delay,
    split: SplitRange,
    vent: VentLag,
}

impl Controller {
    /// Makes a controller without feed-forward. The feedback compares the reading with the set point of the same
    /// second.
    pub fn new(law: Law, split: SplitRange) -> Self {
        Self {
            law,
            forward: None,
            delay: Delay::of(0.0),
            split,
            vent: VentLag::default(),
        }
    }

    /// Adds the feed-forward of an identified chamber. From then on the feedback compares the reading with the set
    /// point of one delay ago: the chamber cannot have followed a later one.
    #[must_use]
    pub fn with_feed_forward(self, chamber: &Identified) -> Self {
        Self {
            forward: Some(FeedForward::new(chamber)),
            delay: Delay::of(chamber.delay_s),
            ..self
        }
    }

    /// Returns the usual controller of an identified chamber: PID with feed-forward.
    pub fn usual(chamber: &Identified) -> Self {
        let law = Law::Pid(Pid::new(Settings::simc(&chamber.first_order, 1.0)));
        Self::new(law, SplitRange::of(chamber)).with_feed_forward(chamber)
    }

    /// Returns the learnt ratio of the power of the heater to the identified one; 1 without feed-forward.
    pub fn learnt_gain(&self) -> f64 {
        self.forward.as_ref().map_or(1.0, FeedForward::gain)
    }

    /// Returns the command of this second. While a reading is not finite, the command is off and the law keeps its
    /// state.
    pub fn step(&mut self, set: &SetPoint, seen: &Observed) -> Command {
        if !(seen.measured_c.is_finite() && seen.ambient_c.is_finite()) {
            return Command::OFF;
        }
        let reachable_c = self.delay.step(set.value_c);
        let forward = self.forward.as_mut().map(|it| it.step(set, seen.ambient_c));
        let task = Task {
            error_k: reachable_c - seen.measured_c,
            moving_c: seen.measured_c - forward.map_or(0.0, |_| reachable_c),
            forward: forward.unwrap_or(0.0),
            lowest: self.split.lowest(seen),
            highest: 1.0,
        };
        let power = self.law.step(&task);
        if let Some(forward) = self.forward.as_mut() {
            self.law.shift(forward.learn(set, power, &task));
        }
        self.vent.step(self.split, power, seen)
    }
}

#[cfg(test)]
mod tests;
