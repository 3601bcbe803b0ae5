//! Orders: what a screen wants done.
//!
//! An order goes to the cycle, which answers it in its next turn: taken, or not now and why, in English and
//! Chinese. A client can tell "not now" (409) from "no such thing" (400). Nothing is stored here: an order
//! that the controller does not take at once is refused, never kept for later.

use super::access::Role;
use super::error::HmiError;
use super::router::Desk;
use super::{gate, origin};
use crate::view::{NotTaken, ORDERS, Order};
use axum::Json;
use axum::extract::State;
use axum::extract::rejection::JsonRejection;
use axum::http::HeaderMap;
use serde::Serialize;
use tokio::sync::oneshot;

/// Orders that wait for the next turn; more at once than fingers on a panel.
pub const WAITING: usize = 16;

/// An order on its way to the cycle.
#[derive(Debug)]
pub struct Asked {
    /// What is wanted.
    pub order: Order,
    /// The way back.
    pub answer: oneshot::Sender<Result<(), NotTaken>>,
}

impl Asked {
    /// Answers; a screen that has gone away misses nothing that it could use.
    pub fn say(self, answer: Result<(), NotTaken>) {
        let _ = self.answer.send(answer);
    }
}

/// Body of the answer.
#[derive(Debug, Serialize)]
pub(super) struct Taken {
    order: &'static str,
}

/// `POST /api/orders`.
pub(super) async fn order(
    State(desk): State<Desk>,
    headers: HeaderMap,
    body: Result<Json<Order>, JsonRejection>,
) -> Result<Json<Taken>, HmiError> {
    origin::ours(&headers)?;
    let person = desk.shared.gate.at_least(Role::Operator, &headers).await?;
    let Json(order) = body?;
    gate::trusted(&person, needs(&order))?;
    let Some(word) = ORDERS.into_iter().find(|known| *known == order.order) else {
        return Err(HmiError::UnknownOrder {
            found: order.order.chars().take(40).collect(),
            known: ORDERS.join(", "),
        });
    };
    match give(&desk, order).await {
        None => Err(HmiError::NotNow {
            order: word,
            reason: "the controller has ended or does not answer; nothing was done".into(),
            reason_zh: "控制器已结束或无应答；未执行任何操作".into(),
        }),
        Some(Err(why)) => Err(HmiError::NotNow {
            order: word,
            reason: why.en,
            reason_zh: why.zh,
        }),
        Some(Ok(())) => Ok(Json(Taken { order: word })),
    }
}

/// Whoever moves single actuators or hides alarms must know the machine.
fn needs(order: &Order) -> Role {
    match order.order.as_str() {
        "mode" | "jog" | "step" | "shelve" => Role::Maintainer,
        _other => Role::Operator,
    }
}

async fn give(desk: &Desk, order: Order) -> Option<Result<(), NotTaken>> {
    let (answer, answered) = oneshot::channel();
    desk.shared.orders.try_send(Asked { order, answer }).ok()?;
    answered.await.ok()
}
