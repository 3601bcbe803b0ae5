//! The list of all lots that were run, the latest first; an entry covers all runs of its lot.

use super::error::{Doing, Result};
use super::{Archive, LotStatus, LotYield, Moment, Reopening};
use serde::Serialize;

/// A lot with the sums over all its runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LotEntry {
    /// Name of the lot.
    pub lot: String,
    /// Number of runs.
    pub runs: u32,
    /// Start of the last run.
    pub opened: Moment,
    /// Code of the trouble that ended the last run; `None` when it ended normally or was cut off.
    pub cause: Option<String>,
    /// Text of the cause, English.
    pub cause_text: Option<String>,
    /// Decisions to open the complete lot again.
    pub reopenings: Vec<Reopening>,
    /// State and recipe.
    #[serde(flatten)]
    pub standing: LotStatus,
    /// Counts of tested, passed and suspect parts.
    #[serde(flatten)]
    pub counts: LotYield,
}

/// Selects the lots, without imports, with the number of their runs and the cause that ended the last run.
const BOOK: &str = "SELECT lot.name, count(*), max(run.opened_at_us), run_end.cause, run_end.cause_text
    FROM run JOIN lot ON lot.id = run.lot_id LEFT JOIN run_end ON run_end.run_id = run.id WHERE run.source <> 'import'
    GROUP BY lot.id ORDER BY 3 DESC, lot.id DESC LIMIT ?1 OFFSET ?2";

impl Archive {
    /// Returns at most `limit` lots, the latest first; skips the first `offset` ones.
    pub fn lot_book(&self, limit: u32, offset: u32) -> Result<Vec<LotEntry>> {
        let names: Vec<(String, u32, i64, [Option<String>; 2])> = self
            .connection
            .prepare(BOOK)
            .and_then(|mut it| {
                let read = |row: &rusqlite::Row<'_>| {
                    let cause = [row.get(3)?, row.get(4)?];
                    Ok((row.get(0)?, row.get(1)?, row.get(2)?, cause))
                };
                it.query_map([limit, offset], read)?.collect()
            })
            .doing("reading the book of lots")?;
        let mut book = Vec::new();
        for (lot, runs, opened_us, [cause, cause_text]) in names {
            let Some(standing) = self.standing(&lot)? else {
                continue;
            };
            book.push(LotEntry {
                counts: self.lot_yield(&lot)?,
                reopenings: self.reopenings(&lot)?,
                opened: Moment(opened_us),
                lot,
                runs,
                cause,
                cause_text,
                standing,
            });
        }
        Ok(book)
    }
}
