//! `POST /api/orders`: hands orders to the cycle.
//!
//! The cycle answers in its next pass: it accepts the order, or refuses it with the reason in English and Chinese
//! (409). The answer to a motion by hand comes when the motion has ended. A malformed order gets 400 and leaves no
//! trace. The server stores no order, and refuses one when the queue is full. An order that the role of the person
//! forbids also goes to the cycle, marked as denied, and the cycle writes it into the audit. Orders without a login
//! leave no trace.

use super::access::Role;
use super::asked::{Author, Body};
use super::error::{ApiError, JsonResult};
use super::router::{App, AppState};
use super::sessions;
use axum::Json;
use axum::extract::State;
use machine::view::{Answer, By, Order, OrderRequest};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use texts::Message;
use tokio::sync::mpsc::error::TrySendError;
use tokio::sync::oneshot;
use utoipa::ToSchema;

/// Greatest number of orders that wait for the next pass of the cycle; the server refuses a further order.
pub const WAITING: usize = 16;

/// Body of the answer to an accepted order.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Accepted {
    /// Name of the order, as in `POST /api/orders`.
    order: String,
    /// Remark about the outcome for the person who gave the order.
    #[serde(skip_serializing_if = "Option::is_none")]
    remark: Option<Message>,
}

/// `POST /api/orders`.
pub(super) async fn order(
    State(app): App,
    author: Author,
    Body(order): Body<Order>,
) -> JsonResult<Accepted> {
    let word = order.word();
    let by = author.by();
    if let Err(refused) = sessions::require_role(&author.person, needs(&word)) {
        note(&app, order, by, refused.message());
        return Err(refused);
    }
    match send(&app, order, by).await {
        Err(why) => Err(ApiError::NotNow { order: word, why }),
        Ok(remark) => Ok(Json(Accepted {
            order: word,
            remark,
        })),
    }
}

/// Returns the weakest role that may give the order: maintainer for orders that need knowledge of the machine, engineer
/// to reopen a complete lot, operator for all others.
fn needs(word: &str) -> Role {
    match word {
        "mode" | "jog" | "step" | "shelve" | "release_lot" | "replaced" => Role::Maintainer,
        "reopen_lot" => Role::Engineer,
        _other => Role::Operator,
    }
}

/// Writes into the schema of each order the role that the order needs, as `x-role`, and forbids unknown members.
pub(super) fn describe_roles(schemas: &mut BTreeMap<String, Value>) {
    let variants = schemas
        .get_mut("Order")
        .and_then(|it| it["oneOf"].as_array_mut());
    for variant in variants.into_iter().flatten() {
        let word = variant["properties"]["order"]["enum"][0].as_str();
        let role = needs(word.unwrap_or_default());
        variant["x-role"] = role.word().into();
        variant["additionalProperties"] = false.into();
    }
}

/// Sends the order and returns the answer of the cycle. Refuses the order when [`WAITING`] others wait, and when the
/// controller has ended.
async fn send(app: &AppState, order: Order, by: By) -> Answer {
    let ended = || Message::new("refusal", "controller_ended");
    let (answer, answered) = oneshot::channel();
    let request = OrderRequest::new(order, by, move |it| drop(answer.send(it)));
    app.shared.orders.try_send(request).map_err(|it| match it {
        TrySendError::Full(_) => Message::new("refusal", "orders_waiting").with("count", WAITING),
        TrySendError::Closed(_) => ended(),
    })?;
    answered.await.unwrap_or_else(|_| Err(ended()))
}

/// Sends a denied order to the audit; the order is lost when the controller has ended or its queue is full.
fn note(app: &AppState, order: Order, by: By, why: Message) {
    let request = OrderRequest::denied(order, by, why);
    let _ = app.shared.orders.try_send(request);
}
