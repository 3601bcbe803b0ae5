//! Orders: what a screen wants done.
//!
//! An order goes to the cycle, which answers it in its next turn: taken, or not now and why, in English and
//! Chinese. A client can tell "not now" (409) from "no such thing" (400). Nothing is stored here: an order
//! that the controller does not take at once is refused, never kept for later. What a person may not order goes
//! to the controller too, marked as denied, because the audit has one writer. Strangers leave nothing there.

use super::access::{Person, Role};
use super::error::HmiError;
use super::router::Desk;
use super::{gate, origin};
use axum::Json;
use axum::extract::rejection::{ExtensionRejection, JsonRejection};
use axum::extract::{ConnectInfo, State};
use axum::http::HeaderMap;
use machine::view::{Answer, By, LOT_ORDERS, ORDERS, Order, OrderRequest};
use serde::Serialize;
use std::net::SocketAddr;
use texts::Message;
use tokio::sync::oneshot;

/// Orders that wait for the next turn; more at once than fingers on a panel.
pub const WAITING: usize = 16;

/// Body of the answer.
#[derive(Debug, Serialize)]
pub(super) struct Taken {
    order: &'static str,
}

/// `POST /api/orders`.
pub(super) async fn order(
    State(desk): State<Desk>,
    from: Result<ConnectInfo<SocketAddr>, ExtensionRejection>,
    headers: HeaderMap,
    body: Result<Json<Order>, JsonRejection>,
) -> Result<Json<Taken>, HmiError> {
    origin::ours(&headers)?;
    let person = desk.shared.gate.at_least(Role::Operator, &headers).await?;
    let Json(order) = body?;
    let by = By {
        who: person.name.clone(),
        role: person.role.to_string(),
        origin: from.map_or_else(|_| String::new(), |from| from.0.ip().to_string()),
    };
    let word = match allowed(&person, &order) {
        Ok(word) => word,
        Err(refused) => {
            note(&desk, order, by, refused.to_string());
            return Err(refused);
        }
    };
    match give(&desk, order, by).await {
        None => Err(HmiError::NotNow {
            order: word,
            why: Message::new("refusal", "controller_ended"),
        }),
        Some(Err(why)) => Err(HmiError::NotNow { order: word, why }),
        Some(Ok(())) => Ok(Json(Taken { order: word })),
    }
}

/// Whoever moves single actuators, hides alarms or releases what was held must know the machine.
fn needs(order: &Order) -> Role {
    match order.order.as_str() {
        "mode" | "jog" | "step" | "shelve" | "release_lot" | "replaced" => Role::Maintainer,
        _other => Role::Operator,
    }
}

/// The word of an order that is known and that the person may give.
fn allowed(person: &Person, order: &Order) -> Result<&'static str, HmiError> {
    gate::trusted(person, needs(order))?;
    let known = || ORDERS.into_iter().chain(LOT_ORDERS);
    known()
        .find(|known| *known == order.order)
        .ok_or_else(|| HmiError::UnknownOrder {
            found: order.order.chars().take(40).collect(),
            known: known().collect::<Vec<_>>().join(", "),
        })
}

async fn give(desk: &Desk, order: Order, by: By) -> Option<Answer> {
    let (answer, answered) = oneshot::channel();
    let request = OrderRequest::new(order, by, move |it| drop(answer.send(it)));
    desk.shared.orders.try_send(request).ok()?;
    answered.await.ok()
}

/// For the audit; a controller that has ended or is too busy to listen writes none.
fn note(desk: &Desk, order: Order, by: By, why: String) {
    let request = OrderRequest::denied(order, by, why);
    let _ = desk.shared.orders.try_send(request);
}
