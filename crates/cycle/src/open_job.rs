//! Tracks the transactions of a measuring job, and the lost writes that it waits for.

use machine::instrument::act::JobDone;
use machine::rig::wiring::ModuleId;
use texts::Message;
use units::RigTime;

/// A measuring job under way; it ends when its last transaction ends.
#[derive(Debug, Default)]
pub(super) struct OpenJob {
    parts: usize,
    last: RigTime,
    trouble: Option<Message>,
    rewrites: Vec<ModuleId>,
}

impl OpenJob {
    pub(super) fn part_begun(&mut self) {
        self.parts += 1;
    }

    /// Closes the transaction of a lost write; the job then waits for the repetition of this write, which begins later.
    pub(super) fn rewrites(&mut self, module: ModuleId) {
        self.parts = self.parts.saturating_sub(1);
        self.rewrites.push(module);
    }

    /// Returns true if the job waits for this module's write to be repeated; the wait is over with this call.
    pub(super) fn waits_for(&mut self, module: ModuleId) -> bool {
        let before = self.rewrites.len();
        self.rewrites.retain(|known| *known != module);
        before != self.rewrites.len()
    }

    /// Closes one transaction and keeps the first trouble; after the last transaction, returns the result of the job.
    pub(super) fn part_done(&mut self, at: RigTime, trouble: Option<Message>) -> Option<JobDone> {
        self.parts = self.parts.saturating_sub(1);
        self.last = at;
        if self.trouble.is_none() {
            self.trouble = trouble;
        }
        self.if_empty(self.last)
    }

    /// Returns the result of a job without open transactions.
    pub(super) fn if_empty(&self, at: RigTime) -> Option<JobDone> {
        (self.parts == 0).then(|| JobDone::new(at, self.trouble.clone()))
    }
}
