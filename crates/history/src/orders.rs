//! Audit of orders: who, from where, which order, which answer. Rows never change.

use super::error::{Doing, Result};
use super::store::RowIds;
use super::{Archive, Filter, Moment};
use rusqlite::{Transaction, params};
use serde::Serialize;

/// An order and its answer.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct OrderRecord {
    /// Name of the lot whose run was open at that time, if any.
    pub lot: Option<String>,
    /// Time of the answer, microseconds since 1970 UTC.
    pub at_us: i64,
    /// Name of the person; empty when not logged in.
    pub who: String,
    /// Role of the person; empty when not logged in.
    pub role: String,
    /// Address of the browser, or `command line`.
    pub origin: String,
    /// The order with its members, as JSON text.
    pub what: String,
    /// Reason of the refusal, English; `None` for an accepted order.
    pub refused: Option<String>,
}

/// An order as the audit shows it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct OrderEntry {
    /// Time of the answer.
    pub at: Moment,
    /// Name of the lot whose run was open at that time, if any.
    pub lot: Option<String>,
    /// Number of the run within `lot`.
    pub run: Option<u32>,
    /// Name of the person; empty when not logged in.
    pub who: String,
    /// Role of the person; empty when not logged in.
    pub role: String,
    /// Address of the browser, or `command line`.
    pub origin: String,
    /// The order with its members, as JSON.
    pub what: serde_json::Value,
    /// Reason of the refusal, English; `None` for an accepted order.
    pub refused: Option<String>,
}

pub(super) fn insert(tx: &Transaction<'_>, row_ids: &RowIds, it: &OrderRecord) -> Result<()> {
    let run = it.lot.as_deref().map(|lot| row_ids.run(lot)).transpose()?;
    tx.prepare_cached(
        "INSERT INTO ordered (at_us, run_id, who, role, origin, what, refused)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
    )
    .and_then(|mut statement| {
        statement.execute(params![
            it.at_us, run, it.who, it.role, it.origin, it.what, it.refused
        ])
    })
    .doing("recording an order")?;
    Ok(())
}

impl Archive {
    /// Returns orders in order of time, of one person or of all; lot, run, recipe and time span of the filter select
    /// them.
    pub fn orders(&self, filter: &Filter, who: Option<&str>) -> Result<Vec<OrderEntry>> {
        filter
            .orders(who)
            .rows(&self.connection, |row| {
                Ok(OrderEntry {
                    at: Moment(row.get(0)?),
                    lot: row.get(1)?,
                    run: row.get(2)?,
                    who: row.get(3)?,
                    role: row.get(4)?,
                    origin: row.get(5)?,
                    what: row.get(6)?,
                    refused: row.get(7)?,
                })
            })
            .doing("reading orders")
    }
}
