//! Occurrences of alarms, as they leave the history.

use super::error::{Doing, Result};
use super::{Archive, Filter, Moment};
use rusqlite::params_from_iter;
use serde::Serialize;

/// One occurrence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Alarm {
    /// Name of the lot; none outside a run.
    pub lot: Option<String>,
    /// Number of the run within its lot.
    pub run: Option<u32>,
    /// What kind of trouble.
    pub code: String,
    /// Serial line, when it concerns one.
    pub line: Option<String>,
    /// The message as shown.
    pub text: String,
    /// When it came.
    pub raised: Moment,
    /// When it went; none while it stands, and for one that ended its run.
    pub cleared: Option<Moment>,
}

impl Archive {
    /// Alarms of the runs that the filter leaves (lot, run, recipe), raised in its span, in order of time;
    /// the filter's page of them.
    pub fn alarms(&self, filter: &Filter) -> Result<Vec<Alarm>> {
        const DOING: &str = "reading alarms";
        let select = filter.alarms();
        let mut statement = self.connection.prepare(&select.sql).doing(DOING)?;
        let rows = statement.query_map(params_from_iter(&select.values), |row| {
            Ok(Alarm {
                lot: row.get(0)?,
                run: row.get(1)?,
                code: row.get(2)?,
                line: row.get(3)?,
                text: row.get(4)?,
                raised: Moment(row.get(5)?),
                cleared: row.get::<_, Option<i64>>(6)?.map(Moment),
            })
        });
        rows.and_then(Iterator::collect).doing(DOING)
    }
}
