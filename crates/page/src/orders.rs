//! `POST /api/orders`: hands orders to the cycle.
//!
//! The cycle answers in its next turn: it takes the order, or refuses it with the reason in English and Chinese (409).
//! An unknown order gets 400. Nothing is stored here: when the queue is full the order is refused. An order that the
//! role of the person forbids also goes to the cycle, marked as denied, because the audit has one writer. Orders
//! without a login leave no trace.

use super::access::{Person, Role};
use super::error::{ApiError, JsonResult};
use super::router::{App, AppState};
use super::{origin, sessions};
use axum::Json;
use axum::extract::State;
use axum::extract::rejection::JsonRejection;
use axum::http::HeaderMap;
use machine::view::{Answer, By, LOT_ORDERS, ORDERS, Order, OrderRequest};
use serde::Serialize;
use texts::Message;
use tokio::sync::oneshot;

/// Largest number of orders that wait for the next turn of the cycle; a further one is refused.
pub const WAITING: usize = 16;

/// Body of the answer to an accepted order.
#[derive(Debug, Serialize)]
pub(super) struct Accepted {
    order: &'static str,
}

/// `POST /api/orders`.
pub(super) async fn order(
    State(app): App,
    from: origin::Peer,
    headers: HeaderMap,
    body: Result<Json<Order>, JsonRejection>,
) -> JsonResult<Accepted> {
    let person = app.shared.sessions.author(&headers).await?;
    let Json(order) = body?;
    let by = By {
        who: person.name.clone(),
        role: person.role.to_string(),
        origin: origin::address(from),
    };
    let word = match allowed(&person, &order) {
        Ok(word) => word,
        Err(refused) => {
            note(&app, order, by, refused.to_string());
            return Err(refused);
        }
    };
    match send(&app, order, by).await {
        None => Err(ApiError::NotNow {
            order: word,
            why: Message::new("refusal", "controller_ended"),
        }),
        Some(Err(why)) => Err(ApiError::NotNow { order: word, why }),
        Some(Ok(())) => Ok(Json(Accepted { order: word })),
    }
}

/// Returns the weakest role that may give `order`: maintainer if it takes knowledge of the machine, engineer to reopen
/// a complete lot, else operator.
fn needs(order: &Order) -> Role {
    match order.order.as_str() {
        "mode" | "jog" | "step" | "shelve" | "release_lot" | "replaced" => Role::Maintainer,
        "reopen_lot" => Role::Engineer,
        _other => Role::Operator,
    }
}

/// Returns the name of the order. Fails when it is unknown or the role of the person is too weak.
fn allowed(person: &Person, order: &Order) -> Result<&'static str, ApiError> {
    sessions::require_role(person, needs(order))?;
    let known = || ORDERS.into_iter().chain(LOT_ORDERS);
    known()
        .find(|known| *known == order.order)
        .ok_or_else(|| ApiError::UnknownOrder {
            found: order.order.chars().take(40).collect(),
            known: known().collect::<Vec<_>>().join(", "),
        })
}

/// Sends the order and returns the answer of the cycle; `None` when the controller has ended or its queue is full.
async fn send(app: &AppState, order: Order, by: By) -> Option<Answer> {
    let (answer, answered) = oneshot::channel();
    let request = OrderRequest::new(order, by, move |it| drop(answer.send(it)));
    app.shared.orders.try_send(request).ok()?;
    answered.await.ok()
}

/// Sends a denied order to the audit; it is lost when the controller has ended or its queue is full.
fn note(app: &AppState, order: Order, by: By, why: String) {
    let request = OrderRequest::denied(order, by, why);
    let _ = app.shared.orders.try_send(request);
}
