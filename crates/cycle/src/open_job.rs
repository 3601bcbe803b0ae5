//! Tracks the transactions and queries of a measuring job, and the lost writes that it waits for.

use machine::instrument::act::JobDone;
use machine::instrument::conversion::Converted;
use machine::instrument::query::Delivered;
use machine::rig::wiring::ModuleId;
use texts::Message;
use units::RigTime;

/// A measuring job under way; it ends when its last transaction or query ends.
#[derive(Debug, Default)]
pub(super) struct OpenJob {
    parts: usize,
    last: RigTime,
    trouble: Option<Message>,
    rewrites: Vec<ModuleId>,
    /// What each query has delivered so far, by its position in the job.
    delivered: Vec<Delivered>,
    converted: Option<Converted>,
}

impl OpenJob {
    pub(super) fn part_begun(&mut self) {
        self.parts += 1;
    }

    pub(super) fn query_begun(&mut self) {
        self.parts += 1;
        self.delivered.push(Delivered::default());
    }

    /// Closes the transaction of a lost write; the job stays open until the cycle has repeated this write.
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

    /// Keeps this trouble unless there is an earlier one.
    pub(super) fn fail(&mut self, trouble: Message) {
        self.trouble.get_or_insert(trouble);
    }

    /// Closes one transaction and keeps the first trouble; after the last one, returns the result of the job.
    pub(super) fn part_done(&mut self, at: RigTime, trouble: Option<Message>) -> Option<JobDone> {
        self.parts = self.parts.saturating_sub(1);
        self.last = at;
        trouble.into_iter().for_each(|it| self.fail(it));
        self.if_empty(self.last)
    }

    /// Closes the query at a position; after the last part of the job, returns the result of the job.
    pub(super) fn query_done(
        &mut self,
        position: usize,
        at: RigTime,
        result: Result<Delivered, Message>,
    ) -> Option<JobDone> {
        assert!(position < self.delivered.len(), "a query of another job");
        let at = self.last.max(at);
        match result {
            Ok(delivered) => {
                self.delivered[position] = delivered;
                self.part_done(at, None)
            }
            Err(trouble) => self.part_done(at, Some(trouble)),
        }
    }

    /// Closes the conversion; returns the result of the job.
    pub(super) fn conversion_done(&mut self, at: RigTime, converted: Converted) -> Option<JobDone> {
        self.converted = Some(converted);
        self.part_done(at, None)
    }

    /// Returns the result of the job; `None` while a transaction is open or a lost write waits for its repetition.
    pub(super) fn if_empty(&mut self, at: RigTime) -> Option<JobDone> {
        let is_done = self.parts == 0 && self.rewrites.is_empty();
        is_done.then(|| JobDone {
            at,
            trouble: self.trouble.clone(),
            delivered: match self.trouble {
                Some(_) => Vec::new(),
                None => std::mem::take(&mut self.delivered),
            },
            converted: self.converted.take(),
        })
    }
}
