//! Occurrences of alarms, as they leave the history.

use super::error::{Doing, Result};
use super::{Archive, Filter, Moment};
use machine::station::catalogue::AlarmCode;
use rusqlite::params_from_iter;
use serde::Serialize;
use texts::{Args, Lang};

/// Where an alarm stands (ISA-18.2, states B to E; a shelved one keeps its state).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AlarmState {
    /// It stands and nobody has seen it.
    Unacknowledged,
    /// It stands and was seen.
    Acknowledged,
    /// It has gone before anybody saw it.
    ReturnedUnacknowledged,
    /// It has gone and was seen: back to normal.
    Normal,
}

/// Put out of sight for a while.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Shelf {
    /// Until when.
    pub until: Moment,
    /// Who did it.
    pub by: String,
    /// Why.
    pub reason: String,
}

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
    /// The message as shown, English.
    pub text: String,
    /// Arguments of the message by name; none in rows of before schema 9.
    pub args: Args,
    /// The message in Chinese; none where its arguments are missing, and for a code of another program.
    pub text_zh: Option<String>,
    /// The cause that the catalogue has for the code, Chinese; none for a code of another program.
    pub cause_zh: Option<&'static str>,
    /// When it came.
    pub raised: Moment,
    /// When it went; none while it stands, and for one that ended its run.
    pub cleared: Option<Moment>,
    /// When somebody had seen it.
    pub acknowledged: Option<Moment>,
    /// Who.
    pub acknowledged_by: Option<String>,
    /// How it was shelved last.
    pub shelf: Option<Shelf>,
    /// What follows from it.
    pub state: AlarmState,
}

impl AlarmState {
    fn of(cleared: Option<Moment>, acknowledged: Option<Moment>) -> Self {
        match (cleared, acknowledged) {
            (None, None) => Self::Unacknowledged,
            (None, Some(_)) => Self::Acknowledged,
            (Some(_), None) => Self::ReturnedUnacknowledged,
            (Some(_), Some(_)) => Self::Normal,
        }
    }
}

/// Arguments as they are stored.
pub(super) fn args(stored: Option<serde_json::Value>) -> Args {
    let args = stored.and_then(|it| serde_json::from_value(it).ok());
    args.unwrap_or_default()
}

impl Archive {
    /// Alarms of the runs that the filter leaves (lot, run, recipe), raised in its span, in order of time;
    /// the filter's page of them.
    pub fn alarms(&self, filter: &Filter) -> Result<Vec<Alarm>> {
        const DOING: &str = "reading alarms";
        let select = filter.alarms();
        let mut statement = self.connection.prepare(&select.sql).doing(DOING)?;
        let rows = statement.query_map(params_from_iter(&select.values), |row| {
            let moment = |column: usize| {
                let at: rusqlite::Result<Option<i64>> = row.get(column);
                at.map(|it| it.map(Moment))
            };
            let (cleared, acknowledged) = (moment(6)?, moment(7)?);
            let code: String = row.get(2)?;
            let (known, args) = (AlarmCode::from_name(&code), args(row.get(12)?));
            Ok(Alarm {
                lot: row.get(0)?,
                run: row.get(1)?,
                text_zh: known.and_then(|it| it.message(args.clone()).try_say(Lang::Zh)),
                cause_zh: known.map(|it| it.help(Lang::Zh)[0]),
                code,
                args,
                line: row.get(3)?,
                text: row.get(4)?,
                raised: Moment(row.get(5)?),
                cleared,
                acknowledged,
                acknowledged_by: row.get(8)?,
                shelf: match moment(9)? {
                    Some(until) => Some(Shelf {
                        until,
                        by: row.get::<_, Option<String>>(10)?.unwrap_or_default(),
                        reason: row.get::<_, Option<String>>(11)?.unwrap_or_default(),
                    }),
                    None => None,
                },
                state: AlarmState::of(cleared, acknowledged),
            })
        });
        rows.and_then(Iterator::collect).doing(DOING)
    }
}
