//! Plans as the history keeps them: started, ticked off step by step, done or abandoned.

use super::ToolingPlan;
use crate::error::{Doing, Result};
use crate::{Archive, Moment, Store};
use rusqlite::types::FromSqlError;
use rusqlite::{Connection, OptionalExtension, Row, Transaction, params};
use serde::Serialize;
use texts::Message;
use utoipa::ToSchema;

/// Person who changes a plan, and when.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Actor {
    /// Name of the person.
    pub who: String,
    /// Role of the person.
    pub role: String,
    /// Time, microseconds since 1970 UTC.
    pub at_us: i64,
}

/// Why a change of a plan is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanRefusal {
    /// Another plan is under way.
    UnderWay {
        /// Number of the plan under way.
        plan: i64,
    },
    /// No plan has this number.
    Unknown {
        /// Number in the request.
        plan: i64,
    },
    /// The plan is done or abandoned.
    Ended {
        /// Number of the plan.
        plan: i64,
    },
    /// The requested step is not the next one.
    NotNext {
        /// Number of the requested step.
        step: usize,
        /// Number of the step that comes next.
        next: usize,
    },
    /// The requested step is not the last one done.
    NotLast {
        /// Number of the requested step.
        step: usize,
        /// Number of the last step that is done; 0 when none is.
        last: usize,
    },
    /// A plan was to be abandoned without a reason.
    NoReason,
}

impl PlanRefusal {
    /// Returns the refusal in both languages.
    pub fn message(self) -> Message {
        let refusal = |code| Message::new("refusal", code);
        match self {
            Self::UnderWay { plan } => refusal("plan_under_way").with("plan", plan),
            Self::Unknown { plan } => refusal("no_such_plan").with("plan", plan),
            Self::Ended { plan } => refusal("plan_ended").with("plan", plan),
            Self::NotNext { step, next } => refusal("plan_not_next")
                .with("step", step)
                .with("next", next),
            Self::NotLast { last: 0, .. } => refusal("plan_none_done"),
            Self::NotLast { step, last } => refusal("plan_not_last")
                .with("step", step)
                .with("last", last),
            Self::NoReason => refusal("plan_without_reason"),
        }
    }
}

/// How a plan ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct PlanEnd {
    /// `done` or `abandoned`.
    pub how: String,
    /// Time of the end.
    pub at: Moment,
    /// Person who did the last step, or who abandoned the plan.
    pub who: String,
    /// Reason why a person abandoned the plan.
    pub why: Option<String>,
}

/// A plan in a list.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct PlanEntry {
    /// Number of the plan.
    #[schema(example = 1)]
    pub plan: i64,
    /// Time at which a person started the plan.
    pub started: Moment,
    /// Name of the person.
    pub who: String,
    /// Role of the person.
    pub role: String,
    /// Kind of the plan: `changeover`, `disassembly` or `assembly`.
    pub kind: String,
    /// Scene that the plan begins with.
    pub scene: String,
    /// Scene to which a changeover leads.
    pub to: Option<String>,
    /// Number of steps.
    pub steps: usize,
    /// Number of steps that are done.
    pub done: usize,
    /// End of the plan; null while the plan is under way.
    pub end: Option<PlanEnd>,
}

/// A step that is done.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct StepDone {
    /// Number of the step, from 1.
    pub step: usize,
    /// Time at which a person ticked the step off.
    pub at: Moment,
    /// Name of the person.
    pub who: String,
    /// Role of the person.
    pub role: String,
}

/// A plan that was started, with the steps that are done.
#[derive(Debug, Clone, PartialEq)]
pub struct StartedPlan {
    /// The entry of the plan in the list.
    pub entry: PlanEntry,
    /// The plan as it was when it was started.
    pub plan: ToolingPlan,
    /// Steps that are done, in their order.
    pub ticks: Vec<StepDone>,
}

/// Result of a change: made, or refused with a reason. The outer error is one of the history.
type Changed<T> = Result<std::result::Result<T, PlanRefusal>>;

impl Store {
    /// Stores a plan as under way and returns its number.
    ///
    /// # Errors
    /// Fails when the history cannot be written; the inner result refuses while another plan is under way.
    pub fn start_plan(&mut self, plan: &ToolingPlan, by: &Actor) -> Changed<i64> {
        const DOING: &str = "starting a plan";
        assert!(!plan.steps.is_empty(), "a plan without steps");
        let body = serde_json::to_value(plan)
            .map_err(|error| rusqlite::Error::ToSqlConversionFailure(error.into()))
            .doing(DOING)?;
        let transaction = self.transaction(DOING)?;
        if let Some(plan) = under_way(&transaction).doing(DOING)? {
            return Ok(Err(PlanRefusal::UnderWay { plan }));
        }
        let number = transaction
            .query_row(
                "INSERT INTO tooling_plan (started_us, who, role, kind, steps, body, under_way)
                 VALUES (?1, ?2, ?3, ?4, ?5, ?6, 1) RETURNING id",
                params![
                    by.at_us,
                    by.who,
                    by.role,
                    plan.kind.word(),
                    plan.steps.len() as i64,
                    body
                ],
                |row| row.get(0),
            )
            .doing(DOING)?;
        transaction.commit().doing(DOING)?;
        assert!(number >= 1, "the first plan has number 1");
        Ok(Ok(number))
    }

    /// Ticks off the next step of a plan; with the last one the plan is done.
    ///
    /// # Errors
    /// Fails when the history cannot be written; the inner result refuses a plan that has ended, and a step that is not
    /// the next one.
    pub fn tick_step(&mut self, plan: i64, step: usize, by: &Actor) -> Changed<()> {
        const DOING: &str = "ticking off a step";
        let transaction = self.transaction(DOING)?;
        let (steps, done) = match open(&transaction, plan).doing(DOING)? {
            Ok(found) => found,
            Err(refusal) => return Ok(Err(refusal)),
        };
        assert!(done < steps, "a plan under way with all its steps done");
        let next = done + 1;
        if step != next {
            return Ok(Err(PlanRefusal::NotNext { step, next }));
        }
        let insert = "INSERT INTO tooling_step (plan_id, step, done_us, who, role) VALUES (?1, ?2, ?3, ?4, ?5)";
        let row = params![plan, step as i64, by.at_us, by.who, by.role];
        transaction.execute(insert, row).doing(DOING)?;
        if step == steps {
            end(&transaction, plan, "done", by, None).doing(DOING)?;
        }
        transaction.commit().doing(DOING)?;
        Ok(Ok(()))
    }

    /// Takes back the tick of the last step that is done, while the plan is under way.
    ///
    /// # Errors
    /// Fails when the history cannot be written; the inner result refuses a plan that has ended, and a step that is not
    /// the last one done.
    pub fn untick_step(&mut self, plan: i64, step: usize) -> Changed<()> {
        const DOING: &str = "taking back a step";
        let transaction = self.transaction(DOING)?;
        let last = match open(&transaction, plan).doing(DOING)? {
            Ok((_, done)) => done,
            Err(refusal) => return Ok(Err(refusal)),
        };
        if step != last || last == 0 {
            return Ok(Err(PlanRefusal::NotLast { step, last }));
        }
        let delete = "DELETE FROM tooling_step WHERE plan_id = ?1 AND step = ?2";
        let deleted = transaction.execute(delete, params![plan, step as i64]);
        assert_eq!(deleted.doing(DOING)?, 1, "a step done without its row");
        transaction.commit().doing(DOING)?;
        Ok(Ok(()))
    }

    /// Ends a plan before all its steps are done.
    ///
    /// # Errors
    /// Fails when the history cannot be written; the inner result refuses a plan that has ended, and an empty reason.
    pub fn abandon_plan(&mut self, plan: i64, why: &str, by: &Actor) -> Changed<()> {
        const DOING: &str = "abandoning a plan";
        if why.trim().is_empty() {
            return Ok(Err(PlanRefusal::NoReason));
        }
        let transaction = self.transaction(DOING)?;
        if let Err(refusal) = open(&transaction, plan).doing(DOING)? {
            return Ok(Err(refusal));
        }
        end(&transaction, plan, "abandoned", by, Some(why.trim())).doing(DOING)?;
        transaction.commit().doing(DOING)?;
        Ok(Ok(()))
    }
}

fn under_way(connection: &Connection) -> rusqlite::Result<Option<i64>> {
    let select = "SELECT id FROM tooling_plan WHERE under_way = 1";
    connection
        .query_row(select, [], |row| row.get(0))
        .optional()
}

/// Returns two numbers of a plan under way: of all its steps, and of the steps that are done.
fn open(
    transaction: &Transaction<'_>,
    plan: i64,
) -> rusqlite::Result<std::result::Result<(usize, usize), PlanRefusal>> {
    let select = "SELECT under_way, steps, (SELECT count(*) FROM tooling_step WHERE plan_id = id)
        FROM tooling_plan WHERE id = ?1";
    let read = |row: &Row<'_>| {
        let is_open = row.get::<_, Option<i64>>(0)?.is_some();
        Ok((is_open, count(row, 1)?, count(row, 2)?))
    };
    let found = transaction.query_row(select, [plan], read).optional()?;
    Ok(match found {
        None => Err(PlanRefusal::Unknown { plan }),
        Some((false, _, _)) => Err(PlanRefusal::Ended { plan }),
        Some((true, steps, done)) => Ok((steps, done)),
    })
}

fn end(
    transaction: &Transaction<'_>,
    plan: i64,
    how: &str,
    by: &Actor,
    why: Option<&str>,
) -> rusqlite::Result<()> {
    let changed = transaction.execute(
        "UPDATE tooling_plan SET under_way = NULL, ended = ?2, ended_us = ?3, ended_by = ?4, why = ?5 WHERE id = ?1",
        params![plan, how, by.at_us, by.who, why],
    )?;
    assert_eq!(changed, 1, "a plan under way without its row");
    Ok(())
}

fn count(row: &Row<'_>, column: usize) -> rusqlite::Result<usize> {
    Ok(usize::try_from(row.get::<_, i64>(column)?).unwrap_or(0))
}

const ENTRIES: &str = "SELECT id, started_us, who, role, kind, body ->> '$.scene', body ->> '$.to', steps,
    (SELECT count(*) FROM tooling_step WHERE plan_id = id), ended, ended_us, ended_by, why FROM tooling_plan";

fn entry(row: &Row<'_>) -> rusqlite::Result<PlanEntry> {
    let end = match row.get::<_, Option<String>>(9)? {
        None => None,
        Some(how) => Some(PlanEnd {
            how,
            at: Moment(row.get(10)?),
            who: row.get(11)?,
            why: row.get(12)?,
        }),
    };
    Ok(PlanEntry {
        plan: row.get(0)?,
        started: Moment(row.get(1)?),
        who: row.get(2)?,
        role: row.get(3)?,
        kind: row.get(4)?,
        scene: row.get(5)?,
        to: row.get(6)?,
        steps: count(row, 7)?,
        done: count(row, 8)?,
        end,
    })
}

impl Archive {
    /// Returns at most `limit` plans, the latest first.
    ///
    /// # Errors
    /// Fails when the history cannot be read.
    pub fn plans(&self, limit: u32) -> Result<Vec<PlanEntry>> {
        self.source
            .file()?
            .prepare(&format!("{ENTRIES} ORDER BY id DESC LIMIT ?1"))
            .and_then(|mut it| it.query_map([limit], entry)?.collect())
            .doing("reading plans")
    }

    /// Returns the number of the plan under way.
    ///
    /// # Errors
    /// Fails when the history cannot be read.
    pub fn plan_under_way(&self) -> Result<Option<i64>> {
        under_way(self.source.file()?).doing("reading the plan under way")
    }

    /// Returns a plan with the steps that are done; `None` when no plan has this number.
    ///
    /// # Errors
    /// Fails when the history cannot be read.
    pub fn plan(&self, number: i64) -> Result<Option<StartedPlan>> {
        const DOING: &str = "reading a plan";
        let select = format!("{ENTRIES} WHERE id = ?1");
        let found = self.source.file()?.query_row(&select, [number], entry);
        let Some(entry) = found.optional().doing(DOING)? else {
            return Ok(None);
        };
        let body = "SELECT body FROM tooling_plan WHERE id = ?1";
        let body: serde_json::Value = self
            .source
            .file()?
            .query_row(body, [number], |row| row.get(0))
            .doing(DOING)?;
        let plan: rusqlite::Result<_> =
            serde_json::from_value(body).map_err(|error| FromSqlError::Other(error.into()).into());
        let read = |row: &Row<'_>| {
            Ok(StepDone {
                step: count(row, 0)?,
                at: Moment(row.get(1)?),
                who: row.get(2)?,
                role: row.get(3)?,
            })
        };
        let ticks =
            "SELECT step, done_us, who, role FROM tooling_step WHERE plan_id = ?1 ORDER BY step";
        let ticks = self.source.file()?.prepare(ticks);
        let ticks = ticks.and_then(|mut it| it.query_map([number], read)?.collect());
        Ok(Some(StartedPlan {
            entry,
            plan: plan.doing(DOING)?,
            ticks: ticks.doing(DOING)?,
        }))
    }
}

impl PlanEntry {
    /// Returns true while the plan is neither done nor abandoned.
    pub fn is_under_way(&self) -> bool {
        self.end.is_none()
    }
}
