//! Trace and health of a line, shared between the task that fills them and whoever shows them.

use super::{Health, Trace};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A handle; clones show the same records. Locked for the time of one entry, never across a wait.
#[derive(Debug, Clone, Default)]
pub struct LineLog(Arc<Mutex<Records>>);

#[derive(Debug, Default)]
pub(super) struct Records {
    pub(super) trace: Trace,
    pub(super) health: Health,
}

impl LineLog {
    /// Keeps the last `entries` pieces of traffic.
    pub fn with_trace(entries: usize) -> Self {
        Self(Arc::new(Mutex::new(Records {
            trace: Trace::with_capacity(entries),
            health: Health::default(),
        })))
    }

    /// A copy of the last traffic.
    pub fn trace(&self) -> Trace {
        self.records().trace.clone()
    }

    /// Of all bytes so far; see [`Trace::fingerprint`].
    pub fn fingerprint(&self) -> u64 {
        self.records().trace.fingerprint()
    }

    /// A copy of the counts.
    pub fn health(&self) -> Health {
        self.records().health.clone()
    }

    pub(super) fn records(&self) -> MutexGuard<'_, Records> {
        // Records are plain counts: what a panicking holder left is still good.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
