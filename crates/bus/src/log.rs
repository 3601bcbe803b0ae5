//! Trace and health of a line; the task of the line writes them and others read them.

use super::{Health, Trace};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A shared handle: all clones refer to the same records. The lock is held for one entry, never across an await.
#[derive(Debug, Clone, Default)]
pub struct LineLog(Arc<Mutex<Records>>);

#[derive(Debug, Default)]
pub(super) struct Records {
    pub(super) trace: Trace,
    pub(super) health: Health,
}

impl LineLog {
    /// Creates a log whose trace keeps the last `entries` pieces of traffic.
    pub fn with_trace(entries: usize) -> Self {
        Self(Arc::new(Mutex::new(Records {
            trace: Trace::with_capacity(entries),
            health: Health::default(),
        })))
    }

    /// Returns a copy of the trace: the last traffic.
    pub fn trace(&self) -> Trace {
        self.records().trace.clone()
    }

    /// Returns the fingerprint of all bytes so far; see [`Trace::fingerprint`].
    pub fn fingerprint(&self) -> u64 {
        self.records().trace.fingerprint()
    }

    /// Returns a copy of the counts of each module.
    pub fn health(&self) -> Health {
        self.records().health.clone()
    }

    pub(super) fn records(&self) -> MutexGuard<'_, Records> {
        // The records are plain counts, which stay valid even if the holder of the lock panicked.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
