//! `/api/recipes/...`: recipes, their revisions and new revisions.
//!
//! | route | members | answer |
//! |---|---|---|
//! | `GET /api/recipes` | | array of recipes: `name`, `title_en`, `title_zh`, `number`, `hash`, `saved_at_us`, or `trouble` |
//! | `GET /api/recipes/show` | `name`, `revision` | one revision with its fields |
//! | `GET /api/recipes/card` | `name`, `lang` | operation process card for A4 |
//! | `POST /api/recipes/revise` | `name`, `from`, `values` | the new revision |
//!
//! Reading needs no login; a revision needs an engineer. The audit of orders gets every try of a logged-in person with its
//! outcome. The history is opened before the change, so that a revision without an audit is impossible to begin.

use super::access::{Person, Role};
use super::error::{ApiError, JsonResult, Members, blocking};
use super::history::paper::{Page, with_policy};
use super::router::App;
use super::{origin, sessions};
use axum::Json;
use axum::extract::rejection::{ExtensionRejection, JsonRejection};
use axum::extract::{ConnectInfo, Query, State};
use axum::http::HeaderMap;
use config::{Change, Plant, Revision};
use history::inquiry::paper::paper;
use history::report::Lang;
use history::report::card;
use history::{Identity, OrderRecord, Row, Store};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::net::SocketAddr;
use std::path::Path;

/// A recipe in the list.
#[derive(Debug, Serialize)]
pub(super) struct ListedRecipe {
    name: String,
    title_en: String,
    title_zh: String,
    number: Option<u32>,
    hash: Option<String>,
    saved_at_us: Option<i64>,
    /// Error that keeps it from loading; absent for a good recipe.
    trouble: Option<String>,
}

/// `GET /api/recipes`.
pub(super) async fn list(State(app): App) -> JsonResult<Vec<ListedRecipe>> {
    let dir = app.shared.config.clone();
    blocking(move || {
        let names = config::recipe_names(&dir).into_iter();
        Ok::<_, ApiError>(Json(names.map(|name| listed(&dir, name)).collect()))
    })
    .await
}

fn listed(dir: &Path, name: String) -> ListedRecipe {
    let found = config::revision(dir, &name, None);
    let title = |path: &str| {
        let fields = found
            .as_ref()
            .map(|it| it.fields.as_slice())
            .unwrap_or_default();
        let title = fields.iter().find(|it| it.path == path)?.value.as_str();
        Some(title?.to_owned())
    };
    ListedRecipe {
        title_en: title("title_en").unwrap_or_default(),
        title_zh: title("title_zh").unwrap_or_default(),
        number: found.as_ref().ok().map(|it| it.number),
        hash: found.as_ref().ok().map(|it| it.hash.clone()),
        saved_at_us: found.as_ref().ok().and_then(|it| it.saved_at_us),
        trouble: found.err().map(|it| it.to_string()),
        name,
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RevisionQuery {
    name: String,
    revision: Option<u32>,
}

/// `GET /api/recipes/show`.
pub(super) async fn show(State(app): App, which: Members<RevisionQuery>) -> JsonResult<Revision> {
    let Query(RevisionQuery { name, revision }) = which?;
    let dir = app.shared.config.clone();
    let read = move || config::revision(&dir, &name, revision);
    blocking(read).await.map(Json)
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CardQuery {
    name: String,
    lang: Option<Lang>,
}

/// `GET /api/recipes/card`.
pub(super) async fn card(State(app): App, printed: Members<CardQuery>) -> Result<Page, ApiError> {
    let Query(CardQuery { name, lang }) = printed?;
    let dir = app.shared.config.clone();
    let made = move || {
        let recipe = config::load_recipe(&dir, &name)?;
        let paper = paper(lang.unwrap_or(Lang::Zh));
        let plant = config::load_card(&dir)?;
        let card = card::card(&paper, &recipe, &plant);
        Ok::<_, ApiError>(with_policy(card))
    };
    blocking(made).await
}

/// `POST /api/recipes/revise`.
pub(super) async fn revise(
    State(app): App,
    from: Result<ConnectInfo<SocketAddr>, ExtensionRejection>,
    headers: HeaderMap,
    body: Result<Json<Change>, JsonRejection>,
) -> JsonResult<Revision> {
    origin::check(&headers)?;
    let person = app
        .shared
        .sessions
        .at_least(Role::Operator, &headers)
        .await?;
    let Json(change) = body?;
    let origin = from.map_or_else(|_| String::new(), |from| from.0.ip().to_string());
    let (dir, db) = (app.shared.config.clone(), app.shared.db.clone());
    blocking(move || {
        let mut audit = Store::open(&db, &Identity::of_this_program())?;
        let done = revised(&dir, &person, &change);
        let noted = audit.record(&[Row::Order(OrderRecord {
            lot: None,
            at_us: jiff::Timestamp::now().as_microsecond(),
            who: person.name,
            role: person.role.to_string(),
            origin,
            what: audit_entry(&change, done.as_ref().ok()).to_string(),
            refused: done.as_ref().err().map(ToString::to_string),
        })]);
        match (done, noted) {
            (Ok(_), Err(source)) => Err(ApiError::NotAudited { source }),
            (done, _) => done.map(Json),
        }
    })
    .await
}

fn revised(dir: &Path, person: &Person, change: &Change) -> Result<Revision, ApiError> {
    sessions::require_role(person, Role::Engineer)?;
    let plant = Plant::load(dir)?;
    config::revise(&plant, change).map_err(|refused| ApiError::Revision { refused })
}

fn audit_entry(change: &Change, saved: Option<&Revision>) -> serde_json::Value {
    let number = saved.map(|it| it.number);
    json!({"order": "revise", "recipe": change.name, "revision": number, "from": change.from, "values": change.values})
}
