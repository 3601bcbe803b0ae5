//! A measuring job under way: its transactions, and the lost writes that it waits for.

use machine::instrument::act::JobDone;
use machine::rig::wiring::ModuleId;
use units::RigTime;

/// Done when its last transaction is.
#[derive(Debug, Default)]
pub(super) struct JobUnderway {
    parts: usize,
    last: RigTime,
    trouble: Option<String>,
    rewrites: Vec<ModuleId>,
}

impl JobUnderway {
    /// One more transaction.
    pub(super) fn part_begun(&mut self) {
        self.parts += 1;
    }

    /// A write was lost and comes again, as another transaction.
    pub(super) fn rewrites(&mut self, module: ModuleId) {
        self.parts = self.parts.saturating_sub(1);
        self.rewrites.push(module);
    }

    /// True once for a module whose write was lost.
    pub(super) fn waits_for(&mut self, module: ModuleId) -> bool {
        let before = self.rewrites.len();
        self.rewrites.retain(|known| *known != module);
        before != self.rewrites.len()
    }

    /// One transaction is over; the answer of the job when it was the last. The first trouble is told.
    pub(super) fn part_done(&mut self, at: RigTime, trouble: Option<String>) -> Option<JobDone> {
        self.parts = self.parts.saturating_sub(1);
        self.last = at;
        if self.trouble.is_none() {
            self.trouble = trouble;
        }
        self.if_empty(self.last)
    }

    /// The answer of a job without open transactions.
    pub(super) fn if_empty(&self, at: RigTime) -> Option<JobDone> {
        (self.parts == 0).then(|| JobDone {
            at,
            trouble: self.trouble.clone(),
        })
    }
}
