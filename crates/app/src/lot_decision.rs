//! Writes a person's decision to hold, release, close or reopen a lot that is not under way; the audit keeps it with
//! the name, like an order at a screen.

use crate::admission::standing;
use history::{Decision, HistoryError, LotStateRecord, OrderRecord, ReopeningRecord, Row, Store};
use machine::view::{By, Order};
use serde_json::json;
use std::path::Path;
use texts::Message;

/// Writes an order about a lot, and the state that the order gives the lot.
///
/// # Errors
/// Fails with the refusal for an unknown lot, a state of the lot that forbids the decision, a missing reason, or a
/// history that cannot be written.
pub fn write(db: &Path, order: &Order, by: &By, decision: Decision) -> Result<(), Message> {
    let reason = order.reason.as_deref().unwrap_or_default();
    let lot = order.lot.as_deref().unwrap_or_default();
    decision.check_reason(reason)?;
    let refused = |code| Message::new("refusal", code);
    let trouble = |error: HistoryError| refused("program_trouble").with("detail", error);
    let standing = standing(db, lot).map_err(trouble)?;
    let state = standing.ok_or_else(|| refused("no_such_lot").with("lot", lot))?;
    decision.refusal(state.state).map_or(Ok(()), Err)?;
    let rows = [audit(order, by), state_row(order, by, decision)];
    let store = Store::open(db);
    store
        .and_then(|mut store| store.record(&rows))
        .map_err(trouble)
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

/// Returns the row that puts the order's lot into its new state.
pub fn state_row(order: &Order, by: &By, decision: Decision) -> Row {
    let why = order.reason.clone().unwrap_or_default();
    let lot = order.lot.clone().unwrap_or_default();
    let at_us = jiff::Timestamp::now().as_microsecond();
    match decision {
        Decision::Reopen => Row::Reopened(ReopeningRecord {
            lot,
            at_us,
            who: by.who.clone(),
            why,
        }),
        Decision::Hold | Decision::Release | Decision::Close => Row::LotState(LotStateRecord {
            lot,
            state: decision.becomes(),
            why: (decision == Decision::Hold).then(|| format!("{why} ({})", by.who)),
            at_us,
        }),
    }
}
