//! The judge: compares the truth of the simulated rig with the history, and never reads the state of the controller.
//!
//! | file | rules |
//! |---|---|
//! | `bodies` | every body lies in the bin that its row names, or an alarm declares it lost; every row has a body, no body two rows |
//! | `values` | every value belongs to the body of its row; no defect in the pass bin, no good part in the bin of a defect |
//! | `motion` | no driven motion begins after a stop, while a safety input is open, or without a controller |
//! | `contactors` | no contactor stays closed after a kill, after the end of a life, or while a safety input is open |
//! | `endings` | every life ends, an alarm names every trouble, and production resumes after the faults |
//!
//! Touching bodies and overdriven coils need no rule here: the rig itself lists them.

mod bodies;
mod contactors;
mod endings;
mod motion;
#[cfg(test)]
mod tests;
mod values;

use super::life::{EPOCH_US, EndedLife};
use crate::lot::Admitted;
use history::{Alarm, Moment, Part};
use rigsim::truth::{BodyTruth, ContactMove, Overdrive};
use units::Span;

/// A case to judge: everything that the rules need. All times are microseconds of rig time, which runs on over all
/// lives.
#[derive(Debug, Clone)]
pub struct Case {
    /// Lives of the controller, in order of time.
    pub lives: Vec<EndedLife>,
    /// Every body that has left the magazine.
    pub bodies: Vec<BodyTruth>,
    /// Driven motions: instant of the start, and name of the actuator.
    pub driven: Vec<(u64, &'static str)>,
    /// Bodies that touched although they must not, one description by the rig each.
    pub touched: Vec<String>,
    /// Coils driven in a supply range above the commanded one.
    pub overdrives: Vec<Overdrive>,
    /// Moves of the main contacts of contactors.
    pub contact_moves: Vec<ContactMove>,
    /// Duration of the faults that begin at an instant, microseconds.
    pub hold_us: u64,
    /// Instants from which a contactor stayed closed once it was closed.
    pub welded_us: Vec<u64>,
    /// Time within which the host watchdog switches the outputs off.
    pub watchdog: Span,
    /// Rows of parts in order of judgement, reference parts included.
    pub rows: Vec<Part>,
    /// Alarms in order of time.
    pub alarms: Vec<Alarm>,
    /// Faults of the rig, in the form of `--fault`.
    pub faults: Vec<String>,
    /// Instants from which a safety input was open.
    pub disturbed_us: Vec<u64>,
    /// Range of each parameter within the limits of the recipe.
    pub limits: Admitted,
    /// Longest reaction to a safety input that the configuration promises.
    pub reaction: Span,
    /// Longest reaction while lines or modules have faults: outputs then stay on until the host watchdogs switch them
    /// off.
    pub reaction_in_trouble: Span,
    /// Whether lines or modules had faults.
    pub lines_disturbed: bool,
}

impl Case {
    /// Describes every broken rule.
    pub fn violations(&self) -> Vec<String> {
        let touched = self
            .touched
            .iter()
            .map(|it| format!("bodies touched: {it}"));
        let overdriven = self.overdrives.iter();
        let overdriven = overdriven.map(|it| format!("coil overdriven: {it}"));
        let mut violations: Vec<String> = touched.chain(overdriven).collect();
        violations.extend(bodies::violations(self));
        violations.extend(values::violations(self));
        violations.extend(motion::violations(self));
        violations.extend(contactors::violations(self));
        violations.extend(endings::violations(self));
        violations
    }

    /// Returns the life that contains an instant.
    fn life_at(&self, t_us: u64) -> Option<&EndedLife> {
        let mut lives = self.lives.iter();
        lives.find(|life| (life.began_us..=life.ended_us).contains(&t_us))
    }

    /// Returns the alarms of a life with their instants, microseconds of rig time.
    fn alarms_of<'a>(&'a self, life: &'a EndedLife) -> impl Iterator<Item = (u64, &'a Alarm)> {
        let own = |alarm: &&Alarm| alarm.lot.as_deref() == Some(life.lot.as_str());
        let timed = |alarm: &'a Alarm| (rig_us(alarm.raised), alarm);
        self.alarms.iter().filter(own).map(timed)
    }
}

/// Converts an instant of the history to rig time, microseconds.
pub fn rig_us(moment: Moment) -> u64 {
    u64::try_from(moment.0 - EPOCH_US).unwrap_or(0)
}

/// Formats rig time in seconds, for messages.
pub fn seconds(t_us: u64) -> String {
    format!("{:.3} s", t_us as f64 * 1e-6)
}
