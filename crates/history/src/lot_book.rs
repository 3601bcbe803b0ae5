//! The book of lots: each lot that was run, over all its runs, the one that was run last first.

use super::error::{Doing, Result};
use super::{Archive, LotStanding, LotYield, Moment};
use serde::Serialize;

/// A lot in the book.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LotLine {
    /// Its name.
    pub lot: String,
    /// How often it was run.
    pub runs: u32,
    /// Begin of its last run.
    pub opened: Moment,
    /// Code of the trouble that ended its last run; none of one that ended well, or was cut off.
    pub cause: Option<String>,
    /// What happened, English.
    pub cause_text: Option<String>,
    /// Where it stands.
    #[serde(flatten)]
    pub standing: LotStanding,
    /// What it has come to.
    #[serde(flatten)]
    pub counts: LotYield,
}

/// Lots with their runs, and the end of the run that was opened last; what was imported was not run here.
const BOOK: &str = "SELECT lot.name, count(*), max(run.opened_at_us), run_end.cause, run_end.cause_text
    FROM run JOIN lot ON lot.id = run.lot_id LEFT JOIN run_end ON run_end.run_id = run.id WHERE run.source <> 'import'
    GROUP BY lot.id ORDER BY 3 DESC, lot.id DESC LIMIT ?1 OFFSET ?2";

impl Archive {
    /// `limit` lots, the last `offset` of them left out.
    pub fn lot_book(&self, limit: u32, offset: u32) -> Result<Vec<LotLine>> {
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
            book.push(LotLine {
                counts: self.lot_yield(&lot)?,
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
