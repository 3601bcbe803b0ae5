//! Tracks the transactions of a measuring job, and the lost writes that it waits for.

use machine::instrument::act::JobDone;
use machine::rig::wiring::ModuleId;
use units::RigTime;

/// An open measuring job; it ends with its last transaction.
#[derive(Debug, Default)]
pub(super) struct OpenJob {
    parts: usize,
    last: RigTime,
    trouble: Option<String>,
    rewrites: Vec<ModuleId>,
}

impl OpenJob {
    pub(super) fn part_begun(&mut self) {
        self.parts += 1;
    }

    /// Replaces the transaction of a lost write by its repetition, which begins later.
    pub(super) fn rewrites(&mut self, module: ModuleId) {
        self.parts = self.parts.saturating_sub(1);
        self.rewrites.push(module);
    }

    /// Returns true once for a module whose write was lost.
    pub(super) fn waits_for(&mut self, module: ModuleId) -> bool {
        let before = self.rewrites.len();
        self.rewrites.retain(|known| *known != module);
        before != self.rewrites.len()
    }

    /// Closes one transaction and keeps the first trouble; returns the job's result after the last one.
    pub(super) fn part_done(&mut self, at: RigTime, trouble: Option<String>) -> Option<JobDone> {
        self.parts = self.parts.saturating_sub(1);
        self.last = at;
        if self.trouble.is_none() {
            self.trouble = trouble;
        }
        self.if_empty(self.last)
    }

    /// Returns the result of a job without open transactions.
    pub(super) fn if_empty(&self, at: RigTime) -> Option<JobDone> {
        (self.parts == 0).then(|| JobDone {
            at,
            trouble: self.trouble.clone(),
        })
    }
}
