//! Carries out a person's order to acknowledge or shelve alarms of runs that have ended; the audit keeps the order with
//! the person's name.

use anyhow::bail;
use history::{AlarmChange, AlarmChangeRecord, OrderRecord, Row, Store};
use machine::station::orders::shelf_minutes;
use machine::view::{By, Order};
use serde_json::json;

/// Writes an order about alarms into the history, with the change that the order makes to alarms.
///
/// # Errors
/// Fails when no unacknowledged alarm has this code, or when the history cannot be written.
pub fn write(store: &mut Store, simulated: bool, order: &Order, by: &By) -> anyhow::Result<()> {
    let left = store.unacknowledged_alarms(simulated)?;
    let code = match order {
        Order::Acknowledge { alarm } => alarm.as_ref(),
        Order::Shelve { alarm, .. } => Some(alarm),
        _other => None,
    };
    if let Some(code) = code.filter(|code| left.iter().all(|it| it.code != **code)) {
        let known: Vec<&str> = left.iter().map(|it| it.code.as_str()).collect();
        bail!(
            "found no unacknowledged alarm {code:?}, expected one of {}",
            known.join(", ")
        );
    }
    let at_us = jiff::Timestamp::now().as_microsecond();
    let mut what = json!(order);
    what["alarm"] = json!(code);
    let audit = OrderRecord {
        at_us,
        who: by.who.clone(),
        origin: by.origin.clone(),
        what: what.to_string(),
        ..OrderRecord::default()
    };
    let change = change(simulated, order, by, at_us);
    let rows: Vec<Row> = [Row::Order(audit)].into_iter().chain(change).collect();
    Ok(store.record(&rows)?)
}

/// Returns the row of the change that an order makes to alarms; `None` when the order changes none.
pub fn change(simulated: bool, order: &Order, by: &By, at_us: i64) -> Option<Row> {
    let by = by.who.clone();
    let (code, change) = match order {
        Order::Acknowledge { alarm } => (alarm.clone(), AlarmChange::Acknowledged { by }),
        Order::Shelve {
            alarm,
            minutes,
            reason,
        } => {
            let minutes = i64::from(shelf_minutes(*minutes));
            let shelved = AlarmChange::Shelved {
                until_us: at_us + minutes * 60_000_000,
                by,
                reason: reason.clone(),
            };
            (Some(alarm.clone()), shelved)
        }
        _other => return None,
    };
    Some(Row::AlarmChange(AlarmChangeRecord {
        simulated,
        code,
        at_us,
        change,
    }))
}
