//! What a lot has come to so far, in numbers.

use std::collections::BTreeMap;

/// Counts of the lot.
#[derive(Debug, Default)]
pub struct Counts {
    /// Judged parts of the lot by verdict.
    pub verdicts: BTreeMap<&'static str, u64>,
    /// Confirmed parts of the lot by bin.
    pub bins: BTreeMap<String, u64>,
    /// Alarms of the run.
    pub alarms: u64,
}

impl Counts {
    /// One more judged part with this verdict.
    pub(super) fn add(&mut self, verdict: &'static str) {
        *self.verdicts.entry(verdict).or_insert(0) += 1;
    }

    /// The verdict of a part does not hold any more.
    pub(super) fn remove(&mut self, verdict: &str) {
        if let Some(count) = self.verdicts.get_mut(verdict) {
            *count -= 1;
        }
    }

    /// Judged parts with this verdict.
    pub fn of(&self, verdict: &str) -> u64 {
        self.verdicts.get(verdict).copied().unwrap_or(0)
    }

    /// Judged parts.
    pub fn parts(&self) -> u64 {
        self.verdicts.values().sum()
    }

    /// Judged parts per hour of rig time; none before any has passed.
    pub fn per_hour(&self, elapsed_s: f64) -> Option<f64> {
        (elapsed_s > 0.0).then(|| self.parts() as f64 / elapsed_s * 3600.0)
    }

    /// Pace and yield in one line.
    pub fn in_short(&self, per_hour: Option<f64>) -> String {
        let good = 100.0 * self.of("pass") as f64 / self.parts().max(1) as f64;
        format!("{:.0} parts/h, yield {good:.1} %", per_hour.unwrap_or(0.0))
    }
}
