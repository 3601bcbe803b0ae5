//! Orders: what a screen wants done.
//!
//! `stop` sets the flag that the cycle reads in its next turn; saying it twice does no harm. The other
//! orders of the state model (ISA-TR88.00.02) are known by name and refused with the reason, so that
//! a client can tell "not here" from "no such thing".

use super::access::Role;
use super::error::HmiError;
use super::origin;
use super::router::Desk;
use axum::Json;
use axum::extract::State;
use axum::extract::rejection::JsonRejection;
use axum::http::HeaderMap;
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;

/// Known, but not taken by this page.
const ELSEWHERE: [&str; 9] = [
    "start",
    "hold",
    "unhold",
    "suspend",
    "unsuspend",
    "abort",
    "clear",
    "reset",
    "complete",
];

/// Body of the request. Members that an order does not need are let pass.
#[derive(Debug, Deserialize)]
pub(super) struct Order {
    order: String,
}

/// Body of the answer.
#[derive(Debug, Serialize)]
pub(super) struct Taken {
    order: &'static str,
    /// It had been given before.
    already: bool,
}

/// `POST /api/orders`.
pub(super) async fn order(
    State(desk): State<Desk>,
    headers: HeaderMap,
    body: Result<Json<Order>, JsonRejection>,
) -> Result<Json<Taken>, HmiError> {
    origin::ours(&headers)?;
    desk.shared.gate.at_least(Role::Operator, &headers).await?;
    let Json(order) = body?;
    if order.order == "stop" {
        return stop(&desk).map(Json);
    }
    match ELSEWHERE.into_iter().find(|known| *known == order.order) {
        Some(order) => Err(HmiError::NotNow {
            order,
            reason: "this page takes `stop` only; a lot is started from the command line",
        }),
        None => Err(HmiError::UnknownOrder {
            found: order.order.chars().take(40).collect(),
            known: format!("stop, {}", ELSEWHERE.join(", ")),
        }),
    }
}

fn stop(desk: &Desk) -> Result<Taken, HmiError> {
    let order = "stop";
    // Set in any case: a stop is never lost by being early or late.
    let already = desk.shared.stop.swap(true, Ordering::SeqCst);
    if desk.shared.view.has_changed().is_err() {
        let reason = "the controller has ended; nothing is running";
        return Err(HmiError::NotNow { order, reason });
    }
    Ok(Taken { order, already })
}
