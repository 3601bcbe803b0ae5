//! `/api/recipes/...`: what the recipes say, and their next revisions.
//!
//! | route | members | answer |
//! |---|---|---|
//! | `GET /api/recipes` | | array of recipes: `name`, `title_en`, `title_zh`, `number`, `hash`, `saved_at_us`, or `trouble` |
//! | `GET /api/recipes/show` | `name`, `revision` | one revision with its fields |
//! | `GET /api/recipes/card` | `name`, `lang` | operation process card for A4 |
//! | `POST /api/recipes/revise` | `name`, `from`, `values` | the new revision |
//!
//! Everybody reads; an engineer revises, and whatever a known person tried is in the audit of orders with the answer. The
//! history is opened first: where nothing can be noted nothing is changed.

use super::access::{Person, Role};
use super::error::HmiError;
use super::history::paper::{Page, on_paper};
use super::router::Desk;
use super::{gate, origin};
use axum::Json;
use axum::extract::rejection::{ExtensionRejection, JsonRejection, QueryRejection};
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
use tokio::task::spawn_blocking;

/// A recipe in the list.
#[derive(Debug, Serialize)]
pub(super) struct Listed {
    name: String,
    title_en: String,
    title_zh: String,
    number: Option<u32>,
    hash: Option<String>,
    saved_at_us: Option<i64>,
    /// Why it does not load.
    trouble: Option<String>,
}

/// `GET /api/recipes`.
pub(super) async fn list(State(desk): State<Desk>) -> Result<Json<Vec<Listed>>, HmiError> {
    let dir = desk.shared.config.clone();
    beside(move || {
        let names = config::recipe_names(&dir).into_iter();
        Ok(Json(names.map(|name| listed(&dir, name)).collect()))
    })
    .await
}

fn listed(dir: &Path, name: String) -> Listed {
    let found = config::revision(dir, &name, None);
    let title = |path: &str| {
        let fields = found
            .as_ref()
            .map(|it| it.fields.as_slice())
            .unwrap_or_default();
        let title = fields.iter().find(|it| it.path == path)?.value.as_str();
        Some(title?.to_owned())
    };
    Listed {
        title_en: title("title_en").unwrap_or_default(),
        title_zh: title("title_zh").unwrap_or_default(),
        number: found.as_ref().ok().map(|it| it.number),
        hash: found.as_ref().ok().map(|it| it.hash.clone()),
        saved_at_us: found.as_ref().ok().and_then(|it| it.saved_at_us),
        trouble: found.err().map(|it| it.to_string()),
        name,
    }
}

/// Which revision.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Which {
    name: String,
    revision: Option<u32>,
}

/// `GET /api/recipes/show`.
pub(super) async fn show(
    State(desk): State<Desk>,
    which: Result<Query<Which>, QueryRejection>,
) -> Result<Json<Revision>, HmiError> {
    let Query(Which { name, revision }) = which?;
    let dir = desk.shared.config.clone();
    beside(move || Ok(Json(config::revision(&dir, &name, revision)?))).await
}

/// Which card.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Printed {
    name: String,
    lang: Option<Lang>,
}

/// `GET /api/recipes/card`.
pub(super) async fn card(
    State(desk): State<Desk>,
    printed: Result<Query<Printed>, QueryRejection>,
) -> Result<Page, HmiError> {
    let Query(Printed { name, lang }) = printed?;
    let dir = desk.shared.config.clone();
    let made = move || {
        let recipe = config::load_recipe(&dir, &name)?;
        let paper = paper(lang.unwrap_or(Lang::Zh));
        let plant = config::load_card(&dir)?;
        Ok(on_paper(card::card(
            paper.language,
            &recipe,
            &plant,
            &paper.made,
        )))
    };
    beside(made).await
}

/// `POST /api/recipes/revise`.
pub(super) async fn revise(
    State(desk): State<Desk>,
    from: Result<ConnectInfo<SocketAddr>, ExtensionRejection>,
    headers: HeaderMap,
    body: Result<Json<Change>, JsonRejection>,
) -> Result<Json<Revision>, HmiError> {
    origin::ours(&headers)?;
    let person = desk.shared.gate.at_least(Role::Operator, &headers).await?;
    let Json(change) = body?;
    let origin = from.map_or_else(|_| String::new(), |from| from.0.ip().to_string());
    let (dir, db) = (desk.shared.config.clone(), desk.shared.db.clone());
    beside(move || {
        let mut audit = Store::open(&db, &Identity::of_this_program())?;
        let done = revised(&dir, &person, &change);
        let noted = audit.record(&[Row::Order(OrderRecord {
            lot: None,
            at_us: jiff::Timestamp::now().as_microsecond(),
            who: person.name,
            role: person.role.to_string(),
            origin,
            what: noted_as(&change, done.as_ref().ok()).to_string(),
            refused: done.as_ref().err().map(ToString::to_string),
        })]);
        match (done, noted) {
            (Ok(_), Err(source)) => Err(HmiError::Unnoted { source }),
            (done, _) => done.map(Json),
        }
    })
    .await
}

fn revised(dir: &Path, person: &Person, change: &Change) -> Result<Revision, HmiError> {
    gate::trusted(person, Role::Engineer)?;
    let plant = Plant::load(dir)?;
    config::revise(&plant, change).map_err(|refused| HmiError::Revision { refused })
}

fn noted_as(change: &Change, saved: Option<&Revision>) -> serde_json::Value {
    let number = saved.map(|it| it.number);
    json!({"order": "revise", "recipe": change.name, "revision": number, "from": change.from, "values": change.values})
}

/// What `work` makes of files, beside the async threads.
async fn beside<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, HmiError> + Send + 'static,
) -> Result<T, HmiError> {
    spawn_blocking(work)
        .await
        .map_err(|_| HmiError::ReaderLost)?
}
