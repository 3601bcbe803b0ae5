//! Writes a person's decision to hold, release, close or reopen a lot that is not under way; the audit keeps the
//! decision with the person's name, like an order at a screen.

use crate::admission::standing;
use history::{
    Decision, HistoryError, HoldReason, LotStateRecord, OrderRecord, ReopeningRecord, Row, Store,
};
use machine::view::{By, Order};
use serde_json::json;
use std::path::Path;
use texts::Message;

/// Decision that an order of a person makes about a lot, with its reason.
#[derive(Debug, Clone, Copy)]
pub struct AboutLot<'a> {
    /// Hold, release, close or reopen.
    pub decision: Decision,
    /// Name of the lot.
    pub lot: &'a str,
    /// Reason; empty when the order names none.
    pub reason: &'a str,
}

/// Writes an order about a lot into the history, with the state that the order gives the lot.
///
/// # Errors
/// Fails with the refusal for an unknown lot, a state of the lot that forbids the decision, a missing reason, or a
/// history that cannot be written.
pub fn write(db: &Path, order: &Order, by: &By, about: AboutLot<'_>) -> Result<(), Message> {
    let AboutLot {
        decision,
        lot,
        reason,
    } = about;
    decision.check_reason(reason)?;
    let refused = |code| Message::new("refusal", code);
    let trouble = |error: HistoryError| refused("program_trouble").with("said", error);
    let standing = standing(db, lot).map_err(trouble)?;
    let state = standing.ok_or_else(|| refused("no_such_lot").with("lot", lot))?;
    decision.refusal(state.state).map_or(Ok(()), Err)?;
    let rows = [audit(order, by), about.state_row(by)];
    let store = Store::open(db);
    store
        .and_then(|mut store| store.record(&rows))
        .map_err(trouble)
}

/// Returns the audit row of an order that a person gives while no run of its lot is under way.
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

impl<'a> AboutLot<'a> {
    /// Returns the decision that `order` makes; `None` for an order that is not about a lot.
    pub fn of(order: &'a Order) -> Option<Self> {
        let (decision, lot, reason) = match order {
            Order::HoldLot { lot, reason } => (Decision::Hold, lot, Some(reason)),
            Order::ReleaseLot { lot, reason } => (Decision::Release, lot, reason.as_ref()),
            Order::CloseLot { lot, reason } => (Decision::Close, lot, reason.as_ref()),
            Order::ReopenLot { lot, reason } => (Decision::Reopen, lot, Some(reason)),
            _other => return None,
        };
        Some(Self {
            decision,
            lot,
            reason: reason.map(String::as_str).unwrap_or_default(),
        })
    }

    /// Returns the row that puts the lot into its new state.
    pub fn state_row(self, by: &By) -> Row {
        let (lot, why) = (self.lot.to_owned(), self.reason.to_owned());
        let at_us = jiff::Timestamp::now().as_microsecond();
        match self.decision {
            Decision::Reopen => Row::Reopened(ReopeningRecord {
                lot,
                at_us,
                who: by.who.clone(),
                why,
            }),
            Decision::Hold | Decision::Release | Decision::Close => Row::LotState(LotStateRecord {
                lot,
                state: self.decision.becomes(),
                why: (self.decision == Decision::Hold)
                    .then(|| HoldReason::Person(format!("{why} ({})", by.who))),
                at_us,
            }),
        }
    }
}
