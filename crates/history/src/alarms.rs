//! Occurrences of alarms, as the history shows them.

use super::error::{Doing, Result};
use super::source::Read;
use super::{Archive, Filter, Moment};
use machine::station::catalogue::AlarmCode;
use machine::station::trouble;
use serde::Serialize;
use serde_json::{Value, json};
use texts::{Args, Lang};
use utoipa::ToSchema;

/// State of an alarm (ISA-18.2), apart from shelving, which [`Shelf`] describes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum AlarmState {
    /// Active, not acknowledged.
    Unacknowledged,
    /// Active, acknowledged.
    Acknowledged,
    /// No longer active, not acknowledged.
    ReturnedUnacknowledged,
    /// No longer active, acknowledged.
    Normal,
}

/// An alarm that a person hid for a time: until when, who, why.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct Shelf {
    /// Time until which the alarm is hidden.
    pub until: Moment,
    /// Name of the person who shelved the alarm.
    pub by: String,
    /// Reason given by the person.
    pub reason: String,
}

/// An occurrence of an alarm.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct Alarm {
    /// Name of the lot; `None` outside a run.
    pub lot: Option<String>,
    /// Number of the run within its lot.
    pub run: Option<u32>,
    /// Code of the alarm.
    pub code: String,
    /// Serial line that the alarm is about, if any.
    pub line: Option<String>,
    /// Message in English.
    pub text: String,
    /// Arguments of the message, by name; empty for rows older than schema 9.
    pub args: Args,
    /// Message in Chinese; `None` when the code is unknown or an argument is missing.
    pub text_zh: Option<String>,
    /// Cause in Chinese; `None` when the code is unknown.
    pub cause_zh: Option<&'static str>,
    /// Time at which the alarm was raised.
    pub raised: Moment,
    /// Time at which the cause had gone; `None` while the alarm is active, and for an alarm that ended its run.
    pub cleared: Option<Moment>,
    /// Time of the acknowledgement, if any.
    pub acknowledged: Option<Moment>,
    /// Person who acknowledged the alarm, if any.
    pub acknowledged_by: Option<String>,
    /// The last shelving of the alarm, if any.
    pub shelf: Option<Shelf>,
    /// State of the alarm, derived from `cleared` and `acknowledged`.
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

/// Reads the stored arguments of a message; returns no arguments when they are missing or damaged.
pub(super) fn args(stored: Option<Value>) -> Args {
    let args = stored.and_then(|it| serde_json::from_value(it).ok());
    args.unwrap_or_default()
}

/// Returns the Chinese text of an alarm; `None` when the code is unknown or an argument is missing.
pub(super) fn said(code: &str, args: Args) -> Option<String> {
    let code = AlarmCode::from_name(code)?;
    code.message(args).try_say(Lang::Zh)
}

/// Returns the JSON object (code and arguments) by which a row of another table, such as a lot state, names an alarm.
pub(super) fn stored(alarm: &trouble::Alarm) -> Value {
    json!({ "code": alarm.code.name(), "args": alarm.args })
}

/// Returns the Chinese text of an alarm that [`stored`] has converted; `None` without an alarm, when this version of
/// the program does not know its code, and when an argument is missing.
pub(super) fn chinese(stored: Option<Value>) -> Option<String> {
    let mut stored = stored?;
    let given = args(stored.get_mut("args").map(Value::take));
    said(stored.get("code")?.as_str()?, given)
}

impl Archive {
    /// Returns the alarms that lot, run, recipe and time span of the filter select, in order of time; limit and offset
    /// of the filter apply.
    pub fn alarms(&self, filter: &Filter) -> Result<Vec<Alarm>> {
        let alarms = filter.alarms().rows(&self.source, |row| {
            let moment = |column: usize| {
                let at: Read<Option<i64>> = row.get(column);
                at.map(|it| it.map(Moment))
            };
            let (cleared, acknowledged) = (moment(6)?, moment(7)?);
            let code: String = row.get(2)?;
            let (known, args) = (AlarmCode::from_name(&code), args(row.get(12)?));
            Ok(Alarm {
                lot: row.get(0)?,
                run: row.get(1)?,
                text_zh: said(&code, args.clone()),
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
                        by: row.get::<Option<String>>(10)?.unwrap_or_default(),
                        reason: row.get::<Option<String>>(11)?.unwrap_or_default(),
                    }),
                    None => None,
                },
                state: AlarmState::of(cleared, acknowledged),
            })
        });
        alarms.doing("reading alarms")
    }
}
