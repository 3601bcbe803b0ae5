//! What stands between a lot and its end: its state, golden checks, retests, and which parts are suspect.
//!
//! | state | a run may begin | set by |
//! |---|---|---|
//! | open | yes, with the recipe of the run before | a run that was stopped, cut off or ended by an alarm; a release |
//! | running | yes: the run before was cut off | the begin of a run; the next program on the rig makes it open |
//! | held | no | a failed golden check, the discard limit, a person |
//! | complete | yes, as a new beginning | the count was reached, or a person closed it |
//!
//! Parts judged after the last good check and before a failed one are *suspect*: nothing is written to their rows,
//! [`Filter::suspect`](super::Filter) finds them. On a rig checks of every run count; a simulated rig is another one
//! in every run.

use super::error::{Doing, Result};
use super::store::{RowIds, source};
use super::{Archive, Filter, Moment, Store};
use rusqlite::{Connection, OptionalExtension, Transaction, params, params_from_iter};
use serde::{Deserialize, Serialize};

/// State of a lot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LotState {
    /// May be run.
    Open,
    /// A run is under way, or was cut off and no program has been on the rig since.
    Running,
    /// May not be run before somebody releases it.
    Held,
    /// Done.
    Complete,
}

impl LotState {
    /// Every one.
    pub const ALL: [Self; 4] = [Self::Open, Self::Running, Self::Held, Self::Complete];

    /// The name in the file.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Running => "running",
            Self::Held => "held",
            Self::Complete => "complete",
        }
    }

    fn named(name: &str) -> Self {
        let mut all = Self::ALL.into_iter();
        all.find(|it| it.name() == name).unwrap_or(Self::Open)
    }
}

/// A lot changes its state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LotStateRecord {
    /// The lot.
    pub lot: String,
    /// Its state from now on.
    pub state: LotState,
    /// Why it is held.
    pub why: Option<String>,
    /// Since when.
    pub at_us: i64,
}

/// Golden parts were measured and compared with their certificates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReferenceCheckRecord {
    /// The open lot it was made in.
    pub lot: String,
    /// When it was decided.
    pub at_us: i64,
    /// They read as certified.
    pub passed: bool,
    /// Which parts, or what was found instead.
    pub text: String,
}

/// Where a lot stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LotStatus {
    /// Its state.
    pub state: LotState,
    /// Why it is held.
    pub why: Option<String>,
    /// Since when.
    pub since: Moment,
    /// Name of the recipe of its last run.
    pub recipe: String,
    /// Hash of that recipe.
    pub recipe_hash: String,
}

/// Yield of a lot over its runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct LotYield {
    /// Parts judged in runs that were no retest.
    pub parts: u64,
    /// Those of them that passed: the first result, whatever a retest says later.
    pub first_pass: u64,
    /// Parts that passed in a retest.
    pub retest_pass: u64,
    /// Parts between a good and a failed golden check.
    pub suspect: u64,
}

/// One golden check, as it leaves the history.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ReferenceCheck {
    /// Number of the run within its lot.
    pub run: u32,
    /// When it was decided.
    pub at: Moment,
    /// The golden parts read as certified.
    pub passed: bool,
    /// Which parts, or what was found instead.
    pub text: String,
    /// Of one that failed: parts judged since this instant are suspect.
    pub suspect_since: Option<Moment>,
}

/// Condition of SQL on `part` that leaves the suspect ones.
pub(super) const SUSPECT: &str = " AND EXISTS (SELECT 1 FROM golden_check AS failed \
    JOIN run AS checked ON checked.id = failed.run_id JOIN run AS own ON own.id = part.run_id \
    WHERE NOT failed.passed AND part.judged_at_us > failed.suspect_since_us \
    AND part.judged_at_us <= failed.at_us \
    AND (own.id = checked.id OR (own.source = 'rig' AND checked.source = 'rig')))";

/// The lot is in `record.state` from now on; of a lot that nobody has run there is nothing to write.
pub(super) fn state(connection: &Connection, record: &LotStateRecord) -> rusqlite::Result<usize> {
    connection.execute(
        "INSERT INTO lot_state (lot_id, state, why, since_us)
         SELECT id, ?2, ?3, ?4 FROM lot WHERE name = ?1
         ON CONFLICT (lot_id) DO UPDATE SET state = excluded.state, why = excluded.why,
           since_us = excluded.since_us",
        params![record.lot, record.state.name(), record.why, record.at_us],
    )
}

/// A check; the same one again changes nothing.
pub(super) fn reference_check(
    tx: &Transaction<'_>,
    known: &RowIds,
    it: &ReferenceCheckRecord,
) -> Result<()> {
    let run = known.run(&it.lot)?;
    tx.execute(
        "INSERT INTO golden_check (run_id, at_us, passed, text, suspect_since_us)
         SELECT own.id, ?2, ?3, ?4, CASE WHEN ?3 THEN NULL ELSE ifnull(
           (SELECT max(good.at_us) FROM golden_check AS good JOIN run ON run.id = good.run_id
            WHERE good.passed AND good.at_us < ?2
              AND (run.id = own.id OR (run.source = 'rig' AND own.source = 'rig'))),
           iif(own.source = 'rig', 0, own.opened_at_us)) END
         FROM run AS own WHERE own.id = ?1
           AND NOT EXISTS (SELECT 1 FROM golden_check WHERE run_id = ?1 AND at_us = ?2)",
        params![run, it.at_us, it.passed, it.text],
    )
    .doing("recording a golden check")?;
    Ok(())
}

impl Store {
    /// Whoever has the rig now knows that no run of before is under way: lots whose run was cut off are open. The
    /// simulated rig and the rig are two.
    pub fn cut_off(&mut self, simulated: bool, at_us: i64) -> Result<()> {
        self.connection()
            .execute(
                "UPDATE lot_state SET state = 'open', since_us = ?2 WHERE state = 'running'
                   AND ?1 = (SELECT source FROM run WHERE run.lot_id = lot_state.lot_id
                             ORDER BY number DESC LIMIT 1)",
                params![source(simulated), at_us],
            )
            .doing("looking for lots that were cut off")?;
        Ok(())
    }
}

impl Archive {
    /// Where a lot stands; none when nobody has run it.
    pub fn standing(&self, lot: &str) -> Result<Option<LotStatus>> {
        self.connection
            .query_row(
                "SELECT ifnull(lot_state.state, 'open'), lot_state.why,
                   ifnull(lot_state.since_us, lot.first_opened_us), recipe.name, recipe.hash
                 FROM lot JOIN run ON run.lot_id = lot.id JOIN recipe ON recipe.id = run.recipe_id
                   LEFT JOIN lot_state ON lot_state.lot_id = lot.id
                 WHERE lot.name = ?1 ORDER BY run.number DESC LIMIT 1",
                [lot],
                |row| {
                    Ok(LotStatus {
                        state: LotState::named(&row.get::<_, String>(0)?),
                        why: row.get(1)?,
                        since: Moment(row.get(2)?),
                        recipe: row.get(3)?,
                        recipe_hash: row.get(4)?,
                    })
                },
            )
            .optional()
            .doing("reading the state of a lot")
    }

    /// First and final results of a lot, and how many of its parts are suspect.
    pub fn lot_yield(&self, lot: &str) -> Result<LotYield> {
        const DOING: &str = "counting a lot over its runs";
        let count = |sql: &str| {
            let found = self
                .connection
                .query_row(sql, [lot], |row| row.get::<_, i64>(0));
            found.map(i64::unsigned_abs).doing(DOING)
        };
        let parts = "SELECT count(*) FROM part JOIN run ON run.id = part.run_id
            JOIN lot ON lot.id = run.lot_id WHERE lot.name = ?1 AND part.kind = 'lot'";
        let again = "AND run.id IN (SELECT run_id FROM retest)";
        let first = "AND run.id NOT IN (SELECT run_id FROM retest)";
        Ok(LotYield {
            parts: count(&format!("{parts} {first}"))?,
            first_pass: count(&format!("{parts} {first} AND part.verdict = 'pass'"))?,
            retest_pass: count(&format!("{parts} {again} AND part.verdict = 'pass'"))?,
            suspect: self.how_many(&Filter {
                lot: Some(lot.to_owned()),
                suspect: true,
                ..Filter::default()
            })?,
        })
    }

    /// Golden checks of the runs that the filter leaves, in order of time.
    pub fn reference_checks(&self, filter: &Filter) -> Result<Vec<ReferenceCheck>> {
        let runs = filter.runs();
        let sql = format!(
            "SELECT run.number, golden_check.at_us, passed, text, suspect_since_us
             FROM golden_check JOIN run ON run.id = golden_check.run_id
             WHERE run.id IN ({}) ORDER BY golden_check.at_us, golden_check.id",
            runs.sql
        );
        self.connection
            .prepare(&sql)
            .and_then(|mut it| {
                it.query_map(params_from_iter(&runs.values), reference_check_of)?
                    .collect()
            })
            .doing("reading golden checks")
    }

    /// The golden check made last, on the simulated rig or on the rig.
    pub fn last_reference_check(&self, simulated: bool) -> Result<Option<ReferenceCheck>> {
        self.connection
            .query_row(
                "SELECT run.number, golden_check.at_us, passed, text, suspect_since_us
                 FROM golden_check JOIN run ON run.id = golden_check.run_id
                 WHERE run.source = ?1 ORDER BY golden_check.at_us DESC, golden_check.id DESC LIMIT 1",
                [source(simulated)],
                reference_check_of,
            )
            .optional()
            .doing("reading the last golden check")
    }
}

fn reference_check_of(row: &rusqlite::Row<'_>) -> rusqlite::Result<ReferenceCheck> {
    Ok(ReferenceCheck {
        run: row.get(0)?,
        at: Moment(row.get(1)?),
        passed: row.get(2)?,
        text: row.get(3)?,
        suspect_since: row.get::<_, Option<i64>>(4)?.map(Moment),
    })
}
