//! `POST /api/login`, `POST /api/logout`, `GET /api/me`.

use super::access::Person;
use super::error::HmiError;
use super::router::Desk;
use super::{gate, origin};
use axum::Json;
use axum::extract::State;
use axum::extract::rejection::JsonRejection;
use axum::http::{HeaderMap, header::SET_COOKIE};
use axum::response::{AppendHeaders, IntoResponse};
use serde::{Deserialize, Serialize};

/// Body of `POST /api/login`.
#[derive(Debug, Deserialize)]
pub(super) struct Login {
    user: String,
    password: String,
}

/// Its answer; the same session is in the cookie.
#[derive(Debug, Serialize)]
struct LoggedIn {
    #[serde(flatten)]
    person: Person,
    /// For `Authorization: Bearer`.
    token: String,
}

pub(super) async fn log_in(
    State(desk): State<Desk>,
    headers: HeaderMap,
    body: Result<Json<Login>, JsonRejection>,
) -> Result<impl IntoResponse, HmiError> {
    origin::ours(&headers)?;
    let Json(Login { user, password }) = body?;
    let (person, token) = desk.shared.gate.log_in(user, password).await?;
    tracing::info!("{} {} logged in", person.role, person.name);
    let cookie = AppendHeaders([(SET_COOKIE, gate::cookie(Some(&token)))]);
    Ok((cookie, Json(LoggedIn { person, token })))
}

pub(super) async fn log_out(
    State(desk): State<Desk>,
    headers: HeaderMap,
) -> Result<impl IntoResponse, HmiError> {
    origin::ours(&headers)?;
    desk.shared.gate.log_out(&headers).await?;
    let cookie = AppendHeaders([(SET_COOKIE, gate::cookie(None))]);
    Ok((cookie, Json(serde_json::json!({ "logged_out": true }))))
}

/// The person, or `null` for a stranger.
pub(super) async fn me(
    State(desk): State<Desk>,
    headers: HeaderMap,
) -> Result<Json<Option<Person>>, HmiError> {
    Ok(Json(desk.shared.gate.who(&headers).await?))
}
