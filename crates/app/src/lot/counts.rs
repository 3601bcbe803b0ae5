//! Counts the parts and alarms of a lot.

use std::collections::BTreeMap;

/// Parts of the lot by verdict and bin, and alarms of the run.
#[derive(Debug, Default)]
pub struct Counts {
    /// Judged parts of the lot by verdict.
    pub verdicts: BTreeMap<&'static str, u64>,
    /// Parts of the lot that the beam of a bin has seen, by bin.
    pub bins: BTreeMap<String, u64>,
    /// Alarms of the run.
    pub alarms: u64,
}

impl Counts {
    /// Counts one more judged part with this verdict.
    pub(super) fn add(&mut self, verdict: &'static str) {
        *self.verdicts.entry(verdict).or_insert(0) += 1;
    }

    /// Counts one part less with this verdict, because the verdict became invalid.
    pub(super) fn remove(&mut self, verdict: &str) {
        if let Some(count) = self.verdicts.get_mut(verdict) {
            *count -= 1;
        }
    }

    /// Returns the number of judged parts with this verdict.
    pub fn of(&self, verdict: &str) -> u64 {
        self.verdicts.get(verdict).copied().unwrap_or(0)
    }

    /// Returns the number of judged parts.
    pub fn parts(&self) -> u64 {
        self.verdicts.values().sum()
    }

    /// Returns judged parts per hour of rig time; `None` unless `elapsed_s` is above 0.
    pub fn per_hour(&self, elapsed_s: f64) -> Option<f64> {
        (elapsed_s > 0.0).then(|| self.parts() as f64 / elapsed_s * 3600.0)
    }

    /// Formats pace and yield as one line of text.
    pub fn pace_and_yield(&self, per_hour: Option<f64>) -> String {
        let good = 100.0 * self.of("pass") as f64 / self.parts().max(1) as f64;
        format!("{:.0} parts/h, yield {good:.1} %", per_hour.unwrap_or(0.0))
    }
}
