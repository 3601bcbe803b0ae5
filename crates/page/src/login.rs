//! `POST /api/login`, `POST /api/logout`, `GET /api/me`; the set-up of the first engineer; the change of one's own
//! password.

use super::access::Person;
use super::answers::Answer;
use super::asked::{Author, Body, OwnPage};
use super::error::{ApiError, JsonResult};
use super::router::App;
use super::sessions::{self, Session};
use axum::Json;
use axum::extract::State;
use axum::http::{HeaderMap, header::SET_COOKIE};
use axum::response::{AppendHeaders, IntoResponse};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// Body of `POST /api/login`.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Login {
    /// Name of the person, case-sensitive.
    #[schema(example = "li")]
    user: String,
    #[schema(format = Password)]
    password: String,
}

/// Body of `POST /api/setup`.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct SetUp {
    /// Set-up code that the program prints at its start.
    code: String,
    /// Name, 1 to 40 letters, digits, `.`, `-` or `_`.
    #[schema(example = "li")]
    user: String,
    /// 8 to 200 characters.
    #[schema(format = Password)]
    password: String,
}

/// Body of `POST /api/password`.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct OwnPassword {
    /// Present password.
    #[schema(format = Password)]
    present: String,
    /// 8 to 200 characters.
    #[schema(format = Password)]
    new: String,
}

/// Answer that opens a session; the cookie holds the same token.
#[derive(Debug, Serialize, ToSchema)]
struct LoggedIn {
    #[serde(flatten)]
    person: Person,
    /// Token for `Authorization: Bearer`.
    token: String,
}

/// Answer of `POST /api/logout`.
#[derive(Debug, Serialize, ToSchema)]
struct LoggedOut {
    /// Always true.
    logged_out: bool,
}

/// Answer of `GET /api/setup/needed`.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct SetUpState {
    /// True while the set-up code may add the first engineer.
    needed: bool,
}

pub(super) async fn log_in(
    State(app): App,
    own: OwnPage,
    headers: HeaderMap,
    Body(Login { user, password }): Body<Login>,
) -> Result<impl IntoResponse + Answer, ApiError> {
    let opened = app.shared.sessions.log_in(user, password, own.address);
    Ok(logged_in(opened.await?, &headers))
}

/// `POST /api/setup`.
pub(super) async fn set_up(
    State(app): App,
    own: OwnPage,
    headers: HeaderMap,
    Body(asked): Body<SetUp>,
) -> Result<impl IntoResponse + Answer, ApiError> {
    let SetUp {
        code,
        user,
        password,
    } = asked;
    let opened = (app.shared.sessions).set_up(code, user, password, own.address);
    Ok(logged_in(opened.await?, &headers))
}

/// `GET /api/setup/needed`.
pub(super) async fn needs_setup(State(app): App) -> JsonResult<SetUpState> {
    let needed = app.shared.sessions.needs_setup().await?;
    Ok(Json(SetUpState { needed }))
}

/// `POST /api/password`: ends the other sessions of the person.
pub(super) async fn set_own_password(
    State(app): App,
    Author { person, origin }: Author,
    headers: HeaderMap,
    Body(OwnPassword { present, new }): Body<OwnPassword>,
) -> Result<impl IntoResponse + Answer, ApiError> {
    let sessions = &app.shared.sessions;
    let opened = sessions.change_own_password(person, present, new, origin);
    Ok(logged_in(opened.await?, &headers))
}

fn logged_in((person, token): Session, headers: &HeaderMap) -> impl IntoResponse + Answer + use<> {
    tracing::info!("{} {} logged in", person.role, person.name);
    let cookie = sessions::cookie(Some(&token), headers);
    let cookie = AppendHeaders([(SET_COOKIE, cookie)]);
    (cookie, Json(LoggedIn { person, token }))
}

pub(super) async fn log_out(
    State(app): App,
    _own: OwnPage,
    headers: HeaderMap,
) -> Result<impl IntoResponse + Answer, ApiError> {
    app.shared.sessions.log_out(&headers).await?;
    let cookie = AppendHeaders([(SET_COOKIE, sessions::cookie(None, &headers))]);
    Ok((cookie, Json(LoggedOut { logged_out: true })))
}

/// `GET /api/me`: returns the person, `null` without a valid session.
pub(super) async fn me(State(app): App, headers: HeaderMap) -> JsonResult<Option<Person>> {
    Ok(Json(app.shared.sessions.who(&headers).await?))
}
