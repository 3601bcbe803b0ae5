//! Occurrences of alarms.

use super::error::{Doing, Result};
use super::{Archive, Filter, Moment};
use machine::station::catalogue::AlarmCode;
use serde::Serialize;
use texts::{Args, Lang};

/// State of an alarm (ISA-18.2, states B to E); shelving does not change it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AlarmState {
    /// Active, not acknowledged.
    Unacknowledged,
    /// Active, acknowledged.
    Acknowledged,
    /// Cleared before it was acknowledged.
    ReturnedUnacknowledged,
    /// Cleared and acknowledged.
    Normal,
}

/// Shelving of an alarm.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Shelf {
    /// End of the shelving.
    pub until: Moment,
    /// Name of the person.
    pub by: String,
    /// Reason given by the person.
    pub reason: String,
}

/// An occurrence of an alarm.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Alarm {
    /// Name of the lot; `None` outside a run.
    pub lot: Option<String>,
    /// Number of the run within its lot.
    pub run: Option<u32>,
    /// Code of the alarm.
    pub code: String,
    /// Serial line that it concerns, if any.
    pub line: Option<String>,
    /// Message in English.
    pub text: String,
    /// Arguments of the message by name; empty before schema 9.
    pub args: Args,
    /// Message in Chinese; `None` for an unknown code or missing arguments.
    pub text_zh: Option<String>,
    /// Cause in Chinese; `None` for an unknown code.
    pub cause_zh: Option<&'static str>,
    /// Time of the alarm.
    pub raised: Moment,
    /// Time at which it was cleared; `None` while it is active and when it ended its run.
    pub cleared: Option<Moment>,
    /// Time of the acknowledgement.
    pub acknowledged: Option<Moment>,
    /// Person who acknowledged it.
    pub acknowledged_by: Option<String>,
    /// Last shelving.
    pub shelf: Option<Shelf>,
    /// State that follows from these times.
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

/// Reads stored arguments; empty when they are missing or damaged.
pub(super) fn args(stored: Option<serde_json::Value>) -> Args {
    let args = stored.and_then(|it| serde_json::from_value(it).ok());
    args.unwrap_or_default()
}

impl Archive {
    /// Returns the alarms of the selected runs (lot, run, recipe) and span in order of time, one page.
    pub fn alarms(&self, filter: &Filter) -> Result<Vec<Alarm>> {
        let alarms = filter.alarms().rows(&self.connection, |row| {
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
        alarms.doing("reading alarms")
    }
}
