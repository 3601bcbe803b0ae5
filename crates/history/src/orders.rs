//! The audit of orders: who wanted what, from where, and whether it was taken. Written once, never changed.

use super::error::{Doing, Result};
use super::store::Known;
use super::{Archive, Filter, Moment};
use rusqlite::{Transaction, params, params_from_iter};
use serde::Serialize;

/// One order and its answer.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct OrderRecord {
    /// The open lot it came in, if any.
    pub lot: Option<String>,
    /// When it was answered.
    pub at_us: i64,
    /// Who ordered it; empty for a stranger.
    pub who: String,
    /// As which role; empty for a stranger.
    pub role: String,
    /// Address of the screen, or `command line`.
    pub origin: String,
    /// The order with its members, JSON.
    pub what: String,
    /// Why it was refused; none when it was taken.
    pub refused: Option<String>,
}

/// One order, as it leaves the history.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Ordered {
    /// When it was answered.
    pub at: Moment,
    /// Name of the lot under way; none outside a run.
    pub lot: Option<String>,
    /// Number of the run within its lot.
    pub run: Option<u32>,
    /// Who ordered it; empty for a stranger.
    pub who: String,
    /// As which role.
    pub role: String,
    /// From where.
    pub origin: String,
    /// The order with its members.
    pub what: serde_json::Value,
    /// Why it was refused; none when it was taken.
    pub refused: Option<String>,
}

pub(super) fn insert(tx: &Transaction<'_>, known: &Known, it: &OrderRecord) -> Result<()> {
    let run = it.lot.as_deref().map(|lot| known.run(lot)).transpose()?;
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
    /// Orders of the runs that the filter leaves (lot, run, recipe), answered in its span, by `who` if asked for,
    /// in order of time.
    pub fn orders(&self, filter: &Filter, who: Option<&str>) -> Result<Vec<Ordered>> {
        let select = filter.orders(who);
        self.connection
            .prepare(&select.sql)
            .and_then(|mut it| {
                it.query_map(params_from_iter(&select.values), |row| {
                    Ok(Ordered {
                        at: Moment(row.get(0)?),
                        lot: row.get(1)?,
                        run: row.get(2)?,
                        who: row.get(3)?,
                        role: row.get(4)?,
                        origin: row.get(5)?,
                        what: row.get(6)?,
                        refused: row.get(7)?,
                    })
                })?
                .collect()
            })
            .doing("reading orders")
    }
}
