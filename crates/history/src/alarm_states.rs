//! Stored state changes of alarms (ISA-18.2): returned, acknowledged, shelved. A restart of the program loses none.
//!
//! A change applies to a code: one acknowledgement covers all occurrences of an alarm. Only [`AlarmChange::Returned`]
//! may apply to one of several alarms with the same code. A change on the real rig never applies to the simulated rig.

use super::Store;
use super::alarms::args;
use super::error::{Doing, Result};
use machine::station::catalogue::AlarmCode;
use machine::station::trouble::Alarm;
use rusqlite::{Connection, Transaction, params};
use texts::Args;

/// A state change of an alarm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum AlarmChange {
    /// The cause is gone.
    Returned {
        /// Name and value of the argument that distinguishes this alarm from others with the same code; `None` for all
        /// alarms with the code.
        only: Option<(&'static str, String)>,
    },
    /// A person has acknowledged the alarm.
    Acknowledged {
        /// Name of the person.
        by: String,
    },
    /// A person has shelved the alarm: it is hidden until a given time.
    Shelved {
        /// Time until which the alarm is hidden, microseconds since 1970 UTC.
        until_us: i64,
        /// Name of the person.
        by: String,
        /// Reason given by the person.
        reason: String,
    },
}

/// A state change, with the alarm that it applies to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AlarmChangeRecord {
    /// True for alarms of the simulated rig.
    pub simulated: bool,
    /// Code of the alarm; `None` for every alarm.
    pub code: Option<String>,
    /// Time of the change, microseconds since 1970 UTC.
    pub at_us: i64,
    /// The change.
    pub change: AlarmChange,
}

/// All unacknowledged occurrences of one alarm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnacknowledgedAlarm {
    /// Code of the alarm.
    pub code: String,
    /// Message in English.
    pub text: String,
    /// Arguments of the message by name.
    pub args: Args,
    /// Number of occurrences.
    pub count: u32,
    /// Time until which the alarm is hidden, microseconds since 1970 UTC; `None`: it is not shelved.
    pub shelved_until_us: Option<i64>,
}

impl UnacknowledgedAlarm {
    /// Returns the alarm; `None` when this version of the program does not know its code.
    pub fn alarm(&self) -> Option<Alarm> {
        Some(Alarm {
            code: AlarmCode::from_name(&self.code)?,
            args: self.args.clone(),
        })
    }
}

const CONCERNED: &str = "(?1 IS NULL OR alarm.code = ?1) AND alarm.run_id IN \
    (SELECT id FROM run WHERE (source = 'simulated') = ?2)";

pub(super) fn change(tx: &Transaction<'_>, it: &AlarmChangeRecord) -> Result<()> {
    if let AlarmChange::Shelved { until_us, .. } = &it.change {
        assert!(*until_us > it.at_us, "shelved for no time");
    }
    let made = match &it.change {
        AlarmChange::Returned { only } => {
            let (name, value) = only.as_ref().map(|(name, value)| (name, value)).unzip();
            tx.execute(
                &format!(
                    "UPDATE alarm SET cleared_at_us = ?3 WHERE cleared_at_us IS NULL AND {CONCERNED}
                     AND (?4 IS NULL OR alarm.args ->> ?4 = ?5)"
                ),
                params![it.code, it.simulated, it.at_us, name, value],
            )
        }
        AlarmChange::Acknowledged { by } => tx.execute(
            &format!(
                "INSERT INTO alarm_state (alarm_id, acknowledged_at_us, acknowledged_by)
                 SELECT id, ?3, ?4 FROM alarm WHERE {CONCERNED}
                 ON CONFLICT (alarm_id) DO UPDATE SET
                   acknowledged_at_us = excluded.acknowledged_at_us,
                   acknowledged_by = excluded.acknowledged_by
                 WHERE acknowledged_at_us IS NULL"
            ),
            params![it.code, it.simulated, it.at_us, by],
        ),
        AlarmChange::Shelved {
            until_us,
            by,
            reason,
        } => tx.execute(
            &format!(
                "INSERT INTO alarm_state (alarm_id, shelved_until_us, shelved_by, shelf_reason)
                 SELECT id, ?3, ?4, ?5 FROM alarm WHERE {CONCERNED}
                   AND id NOT IN (SELECT alarm_id FROM alarm_state
                     WHERE acknowledged_at_us IS NOT NULL AND cleared_at_us IS NOT NULL)
                 ON CONFLICT (alarm_id) DO UPDATE SET shelved_until_us = excluded.shelved_until_us,
                   shelved_by = excluded.shelved_by, shelf_reason = excluded.shelf_reason"
            ),
            params![it.code, it.simulated, until_us, by, reason],
        ),
    };
    made.doing("recording a change of an alarm")?;
    Ok(())
}

fn left(connection: &Connection, simulated: bool) -> rusqlite::Result<Vec<UnacknowledgedAlarm>> {
    connection
        .prepare(
            "SELECT alarm.code, alarm.text, alarm_state.shelved_until_us, alarm.args
             FROM alarm LEFT JOIN alarm_state ON alarm_state.alarm_id = alarm.id
             WHERE alarm_state.acknowledged_at_us IS NULL
               AND alarm.run_id IN (SELECT id FROM run WHERE (source = 'simulated') = ?1)
             ORDER BY alarm.id",
        )?
        .query_map([simulated], |row| {
            Ok(UnacknowledgedAlarm {
                code: row.get(0)?,
                text: row.get(1)?,
                count: 1,
                shelved_until_us: row.get(2)?,
                args: args(row.get(3)?),
            })
        })?
        .try_fold(Vec::new(), |left, row| row.map(|row| with(left, row)))
}

/// Appends the occurrence `last` to the unacknowledged alarms `left`. Removes an earlier occurrence of the same alarm
/// from `left` and adds its count to that of `last`.
fn with(
    mut left: Vec<UnacknowledgedAlarm>,
    mut last: UnacknowledgedAlarm,
) -> Vec<UnacknowledgedAlarm> {
    let is_same = |it: &UnacknowledgedAlarm| match (it.alarm(), last.alarm()) {
        (Some(it), Some(last)) => it.is_same(&last),
        (_, _) => it.code == last.code,
    };
    if let Some(at) = left.iter().position(is_same) {
        let earlier = left.remove(at);
        last.count += earlier.count;
        last.shelved_until_us = last.shelved_until_us.max(earlier.shelved_until_us);
    }
    left.push(last);
    left
}

impl Store {
    /// Returns the unacknowledged alarms of the real or the simulated rig in order of their last occurrence.
    /// Occurrences with the same code count as one alarm unless an argument, such as the name of a module,
    /// distinguishes them.
    pub fn unacknowledged_alarms(&self, simulated: bool) -> Result<Vec<UnacknowledgedAlarm>> {
        left(self.connection(), simulated).doing("reading unacknowledged alarms")
    }
}
