//! Writes a person's decision to hold, release or close a lot that is not running now. The audit keeps the decision
//! with the person's name, like an order from a screen.

use history::{Decision, HistoryError, LotStateRecord, OrderRecord, Row, Store};
use machine::view::{By, Order};
use serde_json::json;
use std::path::Path;

/// Writes an order about a lot, and the state that the order gives the lot.
///
/// # Errors
/// Fails when the history cannot be written.
pub fn write(db: &Path, order: &Order, by: &By, decision: Decision) -> Result<(), HistoryError> {
    let rows = [audit(order, by), state(order, by, decision)];
    Store::open(db)?.record(&rows)
}

/// Returns the audit row of an order that is given while no run of its lot is under way.
pub fn audit(order: &Order, by: &By) -> Row {
    Row::Order(OrderRecord {
        lot: None,
        at_us: jiff::Timestamp::now().as_microsecond(),
        who: by.who.clone(),
        role: by.role.clone(),
        origin: by.origin.clone(),
        what: json!(order).to_string(),
        refused: None,
    })
}

/// Returns the row that puts the lot of the order into its new state.
pub fn state(order: &Order, by: &By, decision: Decision) -> Row {
    let reason = order.reason.as_deref().unwrap_or_default();
    Row::LotState(LotStateRecord {
        lot: order.lot.clone().unwrap_or_default(),
        state: decision.becomes(),
        why: (decision == Decision::Hold).then(|| format!("{reason} ({})", by.who)),
        at_us: jiff::Timestamp::now().as_microsecond(),
    })
}
