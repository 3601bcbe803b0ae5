//! `POST /api/login`, `POST /api/logout`, `GET /api/me`.

use super::access::Person;
use super::error::{ApiError, JsonResult};
use super::router::App;
use super::{origin, sessions};
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

/// Answer of `POST /api/login`; the cookie holds the same token.
#[derive(Debug, Serialize)]
struct LoggedIn {
    #[serde(flatten)]
    person: Person,
    /// Token for `Authorization: Bearer`.
    token: String,
}

pub(super) async fn log_in(
    State(app): App,
    headers: HeaderMap,
    body: Result<Json<Login>, JsonRejection>,
) -> Result<impl IntoResponse, ApiError> {
    origin::check(&headers)?;
    let Json(Login { user, password }) = body?;
    let (person, token) = app.shared.sessions.log_in(user, password).await?;
    tracing::info!("{} {} logged in", person.role, person.name);
    let cookie = AppendHeaders([(SET_COOKIE, sessions::cookie(Some(&token)))]);
    Ok((cookie, Json(LoggedIn { person, token })))
}

pub(super) async fn log_out(
    State(app): App,
    headers: HeaderMap,
) -> Result<impl IntoResponse, ApiError> {
    origin::check(&headers)?;
    app.shared.sessions.log_out(&headers).await?;
    let cookie = AppendHeaders([(SET_COOKIE, sessions::cookie(None))]);
    Ok((cookie, Json(serde_json::json!({ "logged_out": true }))))
}

/// `GET /api/me`: returns the person, `null` without a valid session.
pub(super) async fn me(State(app): App, headers: HeaderMap) -> JsonResult<Option<Person>> {
    Ok(Json(app.shared.sessions.who(&headers).await?))
}
