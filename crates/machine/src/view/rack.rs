//! The rack as pages show it: the plan of its sockets, the phase of the batch, the test under way.

use crate::dut::batch_shown::BatchShown;
use crate::handling::Batch;
use serde::Serialize;
use utoipa::ToSchema;

/// The rack of a rig that tests batches.
#[derive(Debug, Clone, Default, PartialEq, Serialize, ToSchema)]
pub struct RackView {
    /// `loading`, `locking`, `testing`, `cooling`, `unloading`.
    pub phase: &'static str,
    /// Number of the batch in its run, from 1; 0 before the first one.
    pub batch: u64,
    /// Sockets by number.
    pub sockets: Vec<SocketView>,
    /// The test under way, else the last one; null before the first one.
    pub test: Option<BatchShown>,
}

/// A socket on the plan of the rack.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, ToSchema)]
pub struct SocketView {
    /// Number on the rack.
    pub number: u16,
    /// Row on the plan, from 1.
    pub row: u8,
    /// Column on the plan, from 1.
    pub column: u8,
    /// True while its contact is closed; null when unread or stale.
    pub closed: Option<bool>,
}

impl RackView {
    /// Makes the view; `closed` returns whether the contact of the socket with this number is closed.
    pub fn new(batch: &Batch, closed: impl Fn(u16) -> Option<bool>) -> Self {
        let sockets = batch.rack().sockets().iter().map(|it| SocketView {
            number: it.number,
            row: it.row,
            column: it.column,
            closed: closed(it.number),
        });
        Self {
            phase: batch.phase().name(),
            batch: batch.number(),
            sockets: sockets.collect(),
            test: batch.shown(),
        }
    }
}
