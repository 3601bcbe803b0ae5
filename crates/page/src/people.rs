//! `GET /api/people`, `POST /api/people/change`: an engineer reads and changes people.
//!
//! The audit of orders gets every change that a logged-in person tries, with the outcome but without passwords.

use super::access::{Entry, PersonChange, Role};
use super::asked::{Author, Body};
use super::error::JsonResult;
use super::router::App;
use super::sessions::{now_us, require_role};
use axum::Json;
use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

/// Answer to a change.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Changed {
    /// The new password, if the rig drew it because the request gave none.
    password: Option<String>,
}

/// `GET /api/people`.
pub(super) async fn list(State(app): App, Author { person, .. }: Author) -> JsonResult<Vec<Entry>> {
    require_role(&person, Role::Engineer)?;
    let entries = app
        .shared
        .sessions
        .with(|register| register.entries(now_us()));
    entries.await.map(Json)
}

/// `POST /api/people/change`.
pub(super) async fn change(
    State(app): App,
    author: Author,
    Body(change): Body<PersonChange>,
) -> JsonResult<Changed> {
    let (by, what) = (author.by(), change.what());
    let done = app.shared.sessions.audited(by, what, move |register| {
        require_role(&author.person, Role::Engineer)?;
        Ok(change.apply(register, now_us())?)
    });
    let password = done.await?;
    Ok(Json(Changed { password }))
}
