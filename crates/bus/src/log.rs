//! Records of a line or link: one task writes them, others read them.
//!
//! The writing task never waits for a reader: a reader that holds the lock may have lost the processor for many
//! milliseconds, and the replies of the modules do not wait.

use super::{Health, Trace};
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

/// A shared handle: all clones refer to the same records. Only one task writes.
#[derive(Clone, Default)]
pub struct Log<R> {
    records: Arc<Mutex<R>>,
    /// Changes made while a reader held the records locked, oldest first; only the writing task locks this list.
    deferred: Arc<Mutex<Vec<Change<R>>>>,
}

type Change<R> = Box<dyn FnOnce(&mut R) + Send>;

/// A shared handle to trace and health of a line.
pub type LineLog = Log<Records>;

/// Trace and health of a line.
#[derive(Debug, Clone, Default)]
pub struct Records {
    pub(super) trace: Trace,
    pub(super) health: Health,
}

impl LineLog {
    /// Creates a log whose trace keeps the last `entries` pieces of traffic.
    pub fn with_trace(entries: usize) -> Self {
        let records = Records {
            trace: Trace::with_capacity(entries),
            health: Health::default(),
        };
        Self {
            records: Arc::new(Mutex::new(records)),
            deferred: Arc::default(),
        }
    }

    /// Returns a copy of the trace: the last traffic.
    pub fn trace(&self) -> Trace {
        self.records().trace.clone()
    }

    /// Returns the fingerprint of all bytes so far; see [`Trace::fingerprint`].
    pub fn fingerprint(&self) -> u64 {
        self.records().trace.fingerprint()
    }

    /// Returns a copy of the health of the modules: their counts and latencies.
    pub fn health(&self) -> Health {
        self.records().health.clone()
    }
}

impl<R> Log<R> {
    /// Changes the records; while a reader holds them, defers the change to the next call.
    pub(super) fn write(&self, change: impl FnOnce(&mut R) + Send + 'static) {
        let mut deferred = self.deferred.lock().unwrap_or_else(PoisonError::into_inner);
        let mut records = match self.records.try_lock() {
            Ok(records) => records,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return deferred.push(Box::new(change)),
        };
        deferred.drain(..).for_each(|it| it(&mut records));
        change(&mut records);
    }

    pub(super) fn records(&self) -> MutexGuard<'_, R> {
        // The records are plain counts, which stay valid even if the holder of the lock panicked.
        self.records.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<R: fmt::Debug> fmt::Debug for Log<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let records = &self.records;
        f.debug_struct("Log").field("records", records).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Direction, Entry};
    use units::RigTime;

    #[test]
    fn a_reader_delays_no_entry_and_loses_none() {
        let log = LineLog::with_trace(8);
        let add = |at| {
            let entry = Entry::new(RigTime(at), Direction::Sent, b"$01M\r");
            log.write(move |it| it.trace.extend(entry));
        };
        let reader = log.records();
        add(1);
        add(2);
        drop(reader);
        assert_eq!(log.trace().entries().count(), 0, "deferred");
        add(3);
        let times: Vec<u64> = log.trace().entries().map(|it| it.at.0).collect();
        assert_eq!(times, [1, 2, 3]);
    }
}
