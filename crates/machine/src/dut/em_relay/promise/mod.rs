//! Promises that this kind observes: residuals of its measurements against `[accuracy]` of the rig.
//!
//! | promise | residuals |
//! |---|---|
//! | noise of the analog inputs | repeated conversions of constant references during the calibration ([`noise`]) |
//! | scatter of operations | repeated fine ramps of one part, and the rest of the overshoot model ([`operation`]) |
//!
//! From the alarm on, budgets use the larger value; parts judged before keep theirs.

pub mod noise;
pub mod operation;

use crate::dut::accuracy::AccuracySettings;
use crate::dut::promise::{Broken, Promise};
use crate::gauge::Evidence;
use crate::gauge::evidence::Residuals;

/// Share of the lots in which a promise that holds raises its alarm, at most.
const FALSE_ALARMS: f64 = 1e-5;

/// Promised accuracies, and the evidence against them.
#[derive(Debug, Clone)]
pub struct Promises {
    promised: AccuracySettings,
    evidence: [Evidence; Promise::ALL.len()],
    broken: Vec<Broken>,
    /// Number of `broken` that the station has announced.
    announced: usize,
}

impl Promises {
    /// Starts from the accuracies of the file, and what a stored calibration has disproved of them.
    pub fn new(promised: AccuracySettings, broken: Vec<Broken>) -> Self {
        Self {
            promised,
            evidence: Default::default(),
            broken,
            announced: 0,
        }
    }

    /// Returns the accuracies of the file.
    pub fn promised(&self) -> &AccuracySettings {
        &self.promised
    }

    /// Returns the promises that do not hold.
    pub fn broken(&self) -> &[Broken] {
        &self.broken
    }

    /// Returns the promises that do not hold and are not announced yet.
    pub fn announce(&mut self) -> Vec<Broken> {
        let new = self.broken[self.announced..].to_vec();
        self.announced = self.broken.len();
        new
    }

    /// Returns the accuracies for budgets: of each the larger of the promised and the observed one.
    pub fn accuracy(&self) -> AccuracySettings {
        let mut accuracy = self.promised;
        for it in &self.broken {
            let value = value(&mut accuracy, it.promise);
            *value = value.max(it.used);
        }
        accuracy
    }

    /// Adds residuals; a promise that they disprove counts as broken from now on, with the newest figures.
    pub fn observe(&mut self, promise: Promise, residuals: impl IntoIterator<Item = Residuals>) {
        let place = Promise::ALL.iter().position(|it| *it == promise);
        let Some(evidence) = place.map(|at| &mut self.evidence[at]) else {
            return;
        };
        residuals.into_iter().for_each(|it| evidence.add(it));
        let known = self.broken.iter().position(|it| it.promise == promise);
        let Some(seen) = evidence.seen().filter(|_| evidence.disproves(FALSE_ALARMS)) else {
            return;
        };
        let promised = *value(&mut self.promised, promise);
        let now = Broken {
            promise,
            promised,
            seen: promised * seen.value,
            interval: (promised * seen.interval.0, promised * seen.interval.1),
            freedom: seen.freedom,
            used: promised * evidence.covering(),
        };
        match known {
            Some(at) => self.broken[at] = now,
            None => self.broken.push(now),
        }
    }
}

fn value(accuracy: &mut AccuracySettings, promise: Promise) -> &mut f64 {
    match promise {
        Promise::AiNoise => &mut accuracy.ai_noise_lsb,
        Promise::OperationScatter => &mut accuracy.operation_scatter_mv,
    }
}

#[cfg(test)]
mod tests;
