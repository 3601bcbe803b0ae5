//! `/api/recipes/...`: recipes with their revisions, and the route that saves a new revision.
//!
//! | route | members | answer |
//! |---|---|---|
//! | `GET /api/recipes` | | array of recipes: `name`, `title_en`, `title_zh`, `number`, `hash`, `saved_at_us`, or `trouble` |
//! | `GET /api/recipes/show` | `name`, `revision` | one revision with its fields |
//! | `GET /api/recipes/card` | `name`, `lang` | operation process card for A4 |
//! | `POST /api/recipes/revise` | `name`, `from`, `values` | the new revision |
//!
//! Reading needs no login; a revision needs an engineer. The audit of orders gets every try of a logged-in person with its
//! outcome. The history is opened before the change, so that no revision begins without an audit.

use super::access::{Person, Role};
use super::error::{ApiError, JsonResult, Members, blocking};
use super::history::members::language;
use super::history::paper::{Page, with_policy};
use super::router::App;
use super::{origin, sessions};
use axum::Json;
use axum::extract::rejection::JsonRejection;
use axum::extract::{Query, State};
use axum::http::HeaderMap;
use config::{Change, Folder, Plant, Revision};
use history::inquiry::paper::paper;
use history::report::Lang;
use history::report::card;
use history::{OrderRecord, Row, Store};
use serde::{Deserialize, Serialize};
use serde_json::json;

/// A recipe in the list.
#[derive(Debug, Serialize)]
pub(super) struct ListedRecipe {
    name: String,
    title_en: String,
    title_zh: String,
    number: Option<u32>,
    hash: Option<String>,
    saved_at_us: Option<i64>,
    /// Error that keeps the recipe from loading; absent for a good recipe.
    trouble: Option<String>,
}

/// `GET /api/recipes`.
pub(super) async fn list(State(app): App) -> JsonResult<Vec<ListedRecipe>> {
    let folder = app.shared.config.clone();
    blocking(move || {
        let names = config::recipe_names(&folder).into_iter();
        Ok::<_, ApiError>(Json(names.map(|name| listed(&folder, name)).collect()))
    })
    .await
}

fn listed(folder: &Folder, name: String) -> ListedRecipe {
    let found = config::revision(folder, &name, None);
    let good = found.as_ref().ok();
    let title = |path: &str| {
        let title = good?.fields.iter().find(|it| it.path == path)?;
        Some(title.value.as_str()?.to_owned())
    };
    ListedRecipe {
        title_en: title("title_en").unwrap_or_default(),
        title_zh: title("title_zh").unwrap_or_default(),
        number: good.map(|it| it.number),
        hash: good.map(|it| it.hash.clone()),
        saved_at_us: good.and_then(|it| it.saved_at_us),
        trouble: found.as_ref().err().map(ToString::to_string),
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
    let folder = app.shared.config.clone();
    let read = move || config::revision(&folder, &name, revision);
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
    let folder = app.shared.config.clone();
    let made = move || {
        let recipe = config::load_recipe(&folder, &name)?;
        let paper = paper(language(lang));
        let plant = config::load_card(&folder)?;
        let card = card::card(&paper, &recipe, &plant);
        Ok::<_, ApiError>(with_policy(card))
    };
    blocking(made).await
}

/// `POST /api/recipes/revise`.
pub(super) async fn revise(
    State(app): App,
    from: origin::Peer,
    headers: HeaderMap,
    body: Result<Json<Change>, JsonRejection>,
) -> JsonResult<Revision> {
    let person = app.shared.sessions.author(&headers).await?;
    let Json(change) = body?;
    let origin = origin::address(from);
    let (folder, db) = (app.shared.config.clone(), app.shared.db.clone());
    blocking(move || {
        let mut audit = Store::open(&db)?;
        let done = revised(&folder, &person, &change);
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

fn revised(folder: &Folder, person: &Person, change: &Change) -> Result<Revision, ApiError> {
    sessions::require_role(person, Role::Engineer)?;
    let plant = Plant::load(folder)?;
    config::revise(&plant, change).map_err(|refused| ApiError::Revision { refused })
}

fn audit_entry(change: &Change, saved: Option<&Revision>) -> serde_json::Value {
    let number = saved.map(|it| it.number);
    json!({"order": "revise", "recipe": change.name, "revision": number, "from": change.from, "values": change.values})
}
