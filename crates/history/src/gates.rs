//! State of a lot, reference checks, retests, and suspect parts.
//!
//! | state | may a run begin? | what leads to this state |
//! |---|---|---|
//! | open | yes, with its recipe | a run that was stopped, cut off or ended by an alarm; a release |
//! | running | yes: the previous run was cut off | the start of a run; the next program on the rig makes the lot open |
//! | held | no | a failed reference check, the reject-rate limit, a person |
//! | complete | a retest only, with the same recipe | the count was reached, or a person closed the lot |
//!
//! A run is *cut off* when the program ends without closing it, for example at a power failure.
//!
//! A lot keeps its recipe for life. A complete lot stays complete, even after a retest or a hold, until a person
//! reopens it ([`ReopeningRecord`](super::ReopeningRecord)).
//!
//! A part is *suspect* when it was judged before a failed reference check and after the check before that one. Its row
//! stays unchanged; [`Filter::suspect`](super::Filter) selects it. On a real rig the checks of all runs count; on the
//! simulated rig only those of the same run.

use super::error::{Doing, Result};
use super::source::{Read, Row};
use super::store::{RowIds, source};
use super::{Archive, Filter, Moment, Store, alarms, scans};
use machine::station::trouble::Alarm;
use rusqlite::types::Value;
use rusqlite::{Connection, Transaction, params};
use serde::{Deserialize, Serialize};
use texts::Lang;
use utoipa::ToSchema;

/// State of a lot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum LotState {
    /// A run of the lot may begin.
    Open,
    /// A run is under way, or was cut off and no program has opened the rig since.
    Running,
    /// No run of the lot may begin until the lot is released.
    Held,
    /// All parts of the lot are tested, or a person closed the lot.
    Complete,
}

impl LotState {
    /// All states.
    pub const ALL: [Self; 4] = [Self::Open, Self::Running, Self::Held, Self::Complete];

    /// Returns the name of the state in rows and JSON.
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

/// Reason of a hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum HoldReason {
    /// An alarm holds the lot.
    Alarm(Alarm),
    /// A person holds the lot, with these words.
    Person(String),
}

impl HoldReason {
    /// Returns the English text.
    fn text(&self) -> String {
        match self {
            Self::Alarm(alarm) => alarm.text(Lang::En),
            Self::Person(words) => words.clone(),
        }
    }

    const fn alarm(&self) -> Option<&Alarm> {
        match self {
            Self::Alarm(alarm) => Some(alarm),
            Self::Person(_) => None,
        }
    }
}

/// A new state of a lot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LotStateRecord {
    /// Name of the lot.
    pub lot: String,
    /// The new state.
    pub state: LotState,
    /// Reason of the hold; `None` in every other state.
    pub why: Option<HoldReason>,
    /// Time of the change, microseconds since 1970 UTC.
    pub at_us: i64,
}

/// Result of a reference check: reference parts, measured and compared with their certificates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReferenceCheckRecord {
    /// Name of the lot whose run was open at that time.
    pub lot: String,
    /// Time of the result, microseconds since 1970 UTC.
    pub at_us: i64,
    /// Result in words: serial numbers of the reference parts, or the deviation found.
    pub text: String,
    /// Alarm of a failed check; `None` when the readings agree with the certificates.
    pub failure: Option<Alarm>,
}

/// State of a lot, with its recipe.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct LotStatus {
    /// State of the lot.
    pub state: LotState,
    /// Reason of the hold; `None` in every other state.
    pub why: Option<String>,
    /// Reason in Chinese when an alarm holds the lot; `None` for a reason that a person wrote, and in rows older than
    /// schema 13.
    pub why_zh: Option<String>,
    /// Time of the last change of state.
    pub since: Moment,
    /// Name of the recipe of the last run of the lot, imports aside.
    pub recipe: String,
    /// Hash of the recipe of the last run of the lot, imports aside.
    pub recipe_hash: String,
}

/// Yield of a lot over all its runs, as list of lots, report and command line show it. A part whose values were
/// confirmed by repeated measurements counts as tested once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, ToSchema)]
pub struct LotYield {
    /// Parts judged in first tests, that is, not in a retest.
    pub parts: u64,
    /// Parts that passed their first test.
    pub first_pass: u64,
    /// Parts that passed in a retest.
    pub retest_pass: u64,
    /// Suspect parts: judged before a failed reference check and after the check before it.
    pub suspect: u64,
}

impl LotYield {
    /// Returns the number of parts that passed, in their first test or in a retest.
    pub const fn finally(&self) -> u64 {
        self.first_pass + self.retest_pass
    }
}

/// A reference check, as the history shows it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct ReferenceCheck {
    /// Number of the run within its lot.
    pub run: u32,
    /// Time of the result.
    pub at: Moment,
    /// True when the readings agree with the certificates.
    pub passed: bool,
    /// Result in words: serial numbers of the reference parts, or the deviation found.
    pub text: String,
    /// Deviation in Chinese; `None` for a passed check, and in rows older than schema 13.
    pub text_zh: Option<String>,
    /// Time from which parts are suspect after a failed check; `None` for a passed one.
    pub suspect_since: Option<Moment>,
}

/// SQL condition on `part` that is true for a suspect part: a check after the part failed, and no check in between
/// passed.
///
/// Times order checks and parts within a run; row numbers order runs, because the clock may be set back between runs.
/// On a server the bits of a row number from bit 40 up name the history, so parts of other rigs are never suspect.
pub(super) const SUSPECT: &str = " AND EXISTS (SELECT 1 FROM golden_check AS failed \
    JOIN run AS checked ON checked.id = failed.run_id JOIN run AS own ON own.id = part.run_id \
    WHERE NOT failed.passed AND (part.run_id, part.judged_at_us) <= (failed.run_id, failed.at_us) \
    AND (own.id = checked.id OR (own.source = 'rig' AND checked.source = 'rig')) AND own.id >> 40 = checked.id >> 40 \
    AND NOT EXISTS (SELECT 1 FROM golden_check AS good JOIN run ON run.id = good.run_id \
      WHERE good.passed AND good.id < failed.id AND good.id >> 40 = failed.id >> 40 \
      AND (run.id = checked.id OR (run.source = 'rig' AND checked.source = 'rig')) \
      AND (part.run_id, part.judged_at_us) <= (good.run_id, good.at_us)))";

/// Stores the state of a lot; stores `complete` instead of `open` for a lot that was complete before. Does nothing for
/// a lot without runs. Returns the number of changed rows.
pub(super) fn state(connection: &Connection, record: &LotStateRecord) -> rusqlite::Result<usize> {
    let is_held = record.state == LotState::Held;
    assert!(record.why.is_none() || is_held, "only a hold has a reason");
    let why = record.why.as_ref();
    let alarm = why.and_then(HoldReason::alarm).map(alarms::stored);
    connection.execute(
        "INSERT INTO lot_state (lot_id, state, why, alarm, since_us, completed)
         SELECT id, ?2, ?3, ?4, ?5, ?2 = 'complete' FROM lot WHERE name = ?1
         ON CONFLICT (lot_id) DO UPDATE SET why = excluded.why, alarm = excluded.alarm,
           since_us = excluded.since_us,
           state = iif(excluded.state = 'open' AND completed, 'complete', excluded.state),
           completed = completed OR excluded.completed",
        params![
            record.lot,
            record.state.name(),
            why.map(HoldReason::text),
            alarm,
            record.at_us
        ],
    )
}

/// Inserts a reference check; does nothing when the history already has it.
pub(super) fn reference_check(
    tx: &Transaction<'_>,
    row_ids: &RowIds,
    it: &ReferenceCheckRecord,
) -> Result<()> {
    let run = row_ids.run(&it.lot)?;
    assert!(!it.text.is_empty(), "a check without its result");
    let alarm = it.failure.as_ref().map(alarms::stored);
    tx.execute(
        "INSERT INTO golden_check (run_id, at_us, passed, text, alarm, suspect_since_us)
         SELECT own.id, ?2, ?3, ?4, ?5, CASE WHEN ?3 THEN NULL ELSE ifnull(
           (SELECT good.at_us FROM golden_check AS good JOIN run ON run.id = good.run_id
            WHERE good.passed AND (run.id = own.id OR (run.source = 'rig' AND own.source = 'rig'))
            ORDER BY good.id DESC LIMIT 1),
           iif(own.source = 'rig', 0, own.opened_at_us)) END
         FROM run AS own WHERE own.id = ?1
           AND NOT EXISTS (SELECT 1 FROM golden_check WHERE run_id = ?1 AND at_us = ?2)",
        params![run, it.at_us, alarm.is_none(), it.text, alarm],
    )
    .doing("recording a reference check")?;
    Ok(())
}

impl Store {
    /// Sets every lot whose run was cut off to open, or to complete if the lot was complete before, and drops the
    /// serial numbers that were scanned for parts that never arrived. The caller has just taken control of the real or
    /// the simulated rig, so no run is under way on that rig.
    pub fn cut_off(&mut self, simulated: bool, at_us: i64) -> Result<()> {
        const DOING: &str = "looking for lots that were cut off";
        let transaction = self.transaction(DOING)?;
        transaction
            .execute(
                "UPDATE lot_state SET state = iif(completed, 'complete', 'open'), since_us = ?2
                 WHERE state = 'running'
                   AND ?1 = (SELECT source FROM run WHERE run.lot_id = lot_state.lot_id
                             ORDER BY number DESC LIMIT 1)",
                params![source(simulated), at_us],
            )
            .doing(DOING)?;
        scans::drop_cut_off(&transaction, source(simulated), at_us)?;
        transaction.commit().doing(DOING)
    }
}

impl Archive {
    /// Returns the state of a lot; `None` for a lot without runs.
    pub fn standing(&self, lot: &str) -> Result<Option<LotStatus>> {
        self.source
            .first(
                "SELECT coalesce(lot_state.state, 'open'), lot_state.why, lot_state.alarm,
                   coalesce(lot_state.since_us, lot.first_opened_us), recipe.name, recipe.hash
                 FROM lot JOIN run ON run.lot_id = lot.id JOIN recipe ON recipe.id = run.recipe_id
                   LEFT JOIN lot_state ON lot_state.lot_id = lot.id
                 WHERE lot.name = ? ORDER BY run.source = 'import', run.number DESC LIMIT 1",
                &[Value::Text(lot.to_owned())],
                |row| {
                    Ok(LotStatus {
                        state: LotState::named(&row.get::<String>(0)?),
                        why: row.get(1)?,
                        why_zh: alarms::chinese(row.get(2)?),
                        since: Moment(row.get(3)?),
                        recipe: row.get(4)?,
                        recipe_hash: row.get(5)?,
                    })
                },
            )
            .doing("reading the state of a lot")
    }

    /// Counts the selected parts: judged in a first test, passed in a first test, passed in a retest, suspect.
    pub fn lot_yield(&self, filter: &Filter) -> Result<LotYield> {
        let suspect = self.count_parts(&Filter {
            suspect: true,
            ..filter.clone()
        })?;
        let counted = filter.lot_yield().first(&self.source, |row| {
            let count = |at: usize| row.get::<i64>(at).map(i64::unsigned_abs);
            Ok(LotYield {
                parts: count(0)?,
                first_pass: count(1)?,
                retest_pass: count(2)?,
                suspect,
            })
        });
        let counted = counted.doing("counting a lot over its runs")?;
        Ok(counted.unwrap_or_default())
    }

    /// Returns the reference checks of the selected runs, the oldest first.
    pub fn reference_checks(&self, filter: &Filter) -> Result<Vec<ReferenceCheck>> {
        let mut select = filter.runs();
        select.sql = format!(
            "SELECT run.number, golden_check.at_us, passed, text, alarm, suspect_since_us
             FROM golden_check JOIN run ON run.id = golden_check.run_id
             WHERE run.id IN ({}) ORDER BY golden_check.id",
            select.sql
        );
        select
            .rows(&self.source, reference_check_of)
            .doing("reading reference checks")
    }

    /// Returns the latest reference check of the real or the simulated rig; `None` before the first.
    pub fn last_reference_check(&self, simulated: bool) -> Result<Option<ReferenceCheck>> {
        self.source
            .first(
                "SELECT run.number, golden_check.at_us, passed, text, alarm, suspect_since_us
                 FROM golden_check JOIN run ON run.id = golden_check.run_id
                 WHERE run.source = ? ORDER BY golden_check.id DESC LIMIT 1",
                &[Value::Text(source(simulated).to_owned())],
                reference_check_of,
            )
            .doing("reading the last reference check")
    }
}

fn reference_check_of(row: &Row<'_>) -> Read<ReferenceCheck> {
    Ok(ReferenceCheck {
        run: row.get(0)?,
        at: Moment(row.get(1)?),
        passed: row.get(2)?,
        text: row.get(3)?,
        text_zh: alarms::chinese(row.get(4)?),
        suspect_since: row.get::<Option<i64>>(5)?.map(Moment),
    })
}
