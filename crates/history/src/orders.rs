//! Audit of orders: who gave which order from where, and how the program answered. Rows never change.

use super::error::{Doing, Result};
use super::store::RowIds;
use super::{Archive, Filter, Moment};
use machine::form::KeyChange;
use rusqlite::{Row, Transaction, params};
use serde::Serialize;
use serde_json::{Value, json};
use texts::{Lang, Message};
use utoipa::ToSchema;

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
    /// The refusal; `None` for an accepted order.
    pub refused: Option<Message>,
}

/// An order as the audit shows it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
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
    pub what: Value,
    /// Reason of the refusal, English; `None` for an accepted order.
    pub refused: Option<String>,
    /// Reason of the refusal, Chinese; `None` for an accepted order, and in rows older than schema 12.
    pub refused_zh: Option<String>,
}

/// Which orders of the audit to read, besides the filter.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct OrderChoice {
    /// Name of the person; `None` for all people.
    pub who: Option<String>,
    /// Name of the order; `None` for all orders.
    pub order: Option<String>,
    /// True leaves out the entries of [`Self::OF_PEOPLE`].
    pub without_people: bool,
}

impl OrderChoice {
    /// Names of the entries about people: changes of people and passwords, refused logins.
    pub const OF_PEOPLE: [&'static str; 2] = ["people", "login"];
}

pub(super) fn insert(tx: &Transaction<'_>, row_ids: &RowIds, it: &OrderRecord) -> Result<()> {
    let run = it.lot.as_deref().map(|lot| row_ids.run(lot)).transpose()?;
    let why = it.refused.as_ref();
    let text = why.map(|it| it.say(Lang::En));
    let refusal = why.map(|it| json!({ "code": it.code(), "args": it.args() }));
    tx.prepare_cached(
        "INSERT INTO ordered (at_us, run_id, who, role, origin, what, refused, refusal)
         VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
    )
    .and_then(|mut statement| {
        statement.execute(params![
            it.at_us, run, it.who, it.role, it.origin, it.what, text, refusal
        ])
    })
    .doing("recording an order")?;
    Ok(())
}

/// A revision of a recipe, as the audit of orders has it.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct RevisionEntry {
    /// Number of the revision.
    pub revision: u32,
    /// Time of the change.
    pub at: Moment,
    /// Name of the person.
    pub who: String,
    /// Role of the person; empty for a change on the command line.
    pub role: String,
    /// Why the values changed; empty for revisions of earlier programs.
    pub reason: String,
    /// Changed keys with old and new value; none for revisions of earlier programs, which recorded new values only.
    pub changes: Vec<KeyChange>,
    /// A line for each changed key.
    pub lines: Vec<String>,
}

/// Returns the changed keys of a `revise` order, and a line of text for each. For an order of an earlier program, which
/// recorded new values only, returns lines but no changed keys.
fn key_changes(what: &Value) -> (Vec<KeyChange>, Vec<String>) {
    let changes: Vec<KeyChange> =
        serde_json::from_value(what["changes"].clone()).unwrap_or_default();
    let lines = match what["values"].as_object() {
        Some(values) if changes.is_empty() => {
            let line = |(key, new): (&String, &Value)| format!("{key}: {new}");
            values.iter().map(line).collect()
        }
        Some(_) | None => changes.iter().map(KeyChange::to_string).collect(),
    };
    (changes, lines)
}

/// Returns the Chinese text of a stored refusal; `None` when this version of the program does not know its code, or
/// when an argument is missing.
fn chinese(stored: Value) -> Option<String> {
    let args = serde_json::from_value(stored.get("args")?.clone()).ok()?;
    let code = stored.get("code")?.as_str()?.to_owned();
    Message::of("refusal", code, args).try_say(Lang::Zh)
}

impl Archive {
    /// Returns the revisions of a recipe that people saved through the program, the latest first.
    pub fn revisions(&self, recipe: &str) -> Result<Vec<RevisionEntry>> {
        let read = |row: &Row<'_>| {
            let what: Value = row.get(3)?;
            let (changes, lines) = key_changes(&what);
            Ok(RevisionEntry {
                at: Moment(row.get(0)?),
                who: row.get(1)?,
                role: row.get(2)?,
                revision: row.get(4)?,
                reason: what["reason"].as_str().unwrap_or_default().to_owned(),
                lines,
                changes,
            })
        };
        let select = "SELECT at_us, who, role, what, what ->> '$.revision' FROM ordered
            WHERE refused IS NULL AND what ->> '$.order' IN ('revise', 'new_recipe') AND what ->> '$.recipe' = ?1
            ORDER BY id DESC";
        (self.source.file()?.prepare(select))
            .and_then(|mut statement| statement.query_map([recipe], read)?.collect())
            .doing("reading revisions")
    }

    /// Returns the orders that lot, run, recipe and time span of the filter select, in order of time. Limit and offset
    /// of the filter count orders.
    pub fn orders(&self, filter: &Filter, choice: &OrderChoice) -> Result<Vec<OrderEntry>> {
        filter
            .orders(choice)
            .rows(&self.source, |row| {
                Ok(OrderEntry {
                    at: Moment(row.get(0)?),
                    lot: row.get(1)?,
                    run: row.get(2)?,
                    who: row.get(3)?,
                    role: row.get(4)?,
                    origin: row.get(5)?,
                    what: row.get(6)?,
                    refused: row.get(7)?,
                    refused_zh: row.get::<Option<serde_json::Value>>(8)?.and_then(chinese),
                })
            })
            .doing("reading orders")
    }
}
