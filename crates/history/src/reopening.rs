//! Complete lots that a person opened again, with the reason.

use super::error::{Doing, Result};
use super::{Archive, Moment};
use rusqlite::types::Value;
use rusqlite::{Transaction, params};
use serde::Serialize;
use utoipa::ToSchema;

/// A complete lot is opened again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReopeningRecord {
    /// Name of the lot.
    pub lot: String,
    /// Time of the decision.
    pub at_us: i64,
    /// Person who decides.
    pub who: String,
    /// Reason, not empty.
    pub why: String,
}

/// A decision to open a complete lot again.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct Reopening {
    /// Time of the decision.
    pub at: Moment,
    /// Person who decided.
    pub who: String,
    /// Reason.
    pub why: String,
}

/// Inserts the decision, and opens the lot again.
pub(super) fn insert(tx: &Transaction<'_>, it: &ReopeningRecord) -> Result<()> {
    const DOING: &str = "reopening a lot";
    let state = "UPDATE lot_state SET state = 'open', completed = 0, why = NULL, alarm = NULL, since_us = ?2
        WHERE lot_id = (SELECT id FROM lot WHERE name = ?1)";
    tx.execute(state, params![it.lot, it.at_us]).doing(DOING)?;
    let decision = "INSERT INTO reopening (lot_id, at_us, who, why)
        SELECT id, ?2, ?3, ?4 FROM lot WHERE name = ?1";
    tx.execute(decision, params![it.lot, it.at_us, it.who, it.why])
        .doing(DOING)?;
    Ok(())
}

impl Archive {
    /// Returns the reopenings of a lot in order of time.
    pub fn reopenings(&self, lot: &str) -> Result<Vec<Reopening>> {
        self.source
            .rows(
                "SELECT at_us, who, why FROM reopening
                 WHERE lot_id = (SELECT id FROM lot WHERE name = ?) ORDER BY id",
                &[Value::Text(lot.to_owned())],
                |row| {
                    Ok(Reopening {
                        at: Moment(row.get(0)?),
                        who: row.get(1)?,
                        why: row.get(2)?,
                    })
                },
            )
            .doing("reading the reopenings of a lot")
    }
}
