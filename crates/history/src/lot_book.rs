//! The list of all lots that were run, the latest first; an entry covers all runs of its lot.

use super::error::{Doing, Result};
use super::{Archive, Filter, alarms};
use super::{ExternalStanding, LotStatus, LotYield, Moment, Reopening};
use serde::Serialize;
use texts::{Args, Lang, Message};
use utoipa::ToSchema;

/// A lot with the sums over all its runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
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
    /// Text of the cause, Chinese; `None` when the program has no text for this code.
    pub cause_text_zh: Option<String>,
    /// Decisions to open the complete lot again.
    pub reopenings: Vec<Reopening>,
    /// Whether the lot is acceptable by its results from outside of the rig; null for a lot that has and needs none.
    pub external: Option<ExternalStanding>,
    /// State and recipe.
    #[serde(flatten)]
    pub standing: LotStatus,
    /// Counts of tested, passed and suspect parts.
    #[serde(flatten)]
    pub counts: LotYield,
}

/// Selects the lots, without imports, with the number of their runs and the cause that ended the last run; if the cause
/// is an alarm, with the arguments of its text.
const BOOK: &str = "SELECT lot.name, count(*), run.opened_at_us, max(run.id), run_end.cause, run_end.cause_text,
    (SELECT args FROM alarm WHERE alarm.run_id = run.id AND alarm.code = run_end.cause ORDER BY alarm.id DESC LIMIT 1)
    FROM run JOIN lot ON lot.id = run.lot_id LEFT JOIN run_end ON run_end.run_id = run.id WHERE run.source <> 'import'
    GROUP BY lot.id ORDER BY 4 DESC LIMIT ?1 OFFSET ?2";

/// Returns the Chinese text of a cause: of an alarm with these arguments, or of the end of a run.
fn chinese(cause: &str, args: Args) -> Option<String> {
    let end = || Message::new("cause", cause.to_owned()).try_say(Lang::Zh);
    alarms::said(cause, args).or_else(end)
}

impl Archive {
    /// Returns at most `limit` lots, the latest first; skips the first `offset` ones.
    pub fn lot_book(&self, limit: u32, offset: u32) -> Result<Vec<LotEntry>> {
        let names: Vec<(String, u32, i64, [Option<String>; 3])> = self
            .source
            .file()?
            .prepare(BOOK)
            .and_then(|mut it| {
                let read = |row: &rusqlite::Row<'_>| {
                    let cause: Option<String> = row.get(4)?;
                    let args = alarms::args(row.get(6)?);
                    let zh = cause.as_deref().and_then(|it| chinese(it, args));
                    let causes = [cause, row.get(5)?, zh];
                    Ok((row.get(0)?, row.get(1)?, row.get(2)?, causes))
                };
                it.query_map([limit, offset], read)?.collect()
            })
            .doing("reading the book of lots")?;
        let mut book = Vec::new();
        for (lot, runs, opened_us, [cause, cause_text, cause_text_zh]) in names {
            let Some(standing) = self.standing(&lot)? else {
                continue;
            };
            let of_lot = Filter {
                lot: Some(lot.clone()),
                ..Filter::default()
            };
            book.push(LotEntry {
                counts: self.lot_yield(&of_lot)?,
                reopenings: self.reopenings(&lot)?,
                external: self.external_standing(&lot)?,
                opened: Moment(opened_us),
                lot,
                runs,
                cause,
                cause_text,
                cause_text_zh,
                standing,
            });
        }
        Ok(book)
    }
}
