//! `/api/recipes/...`: recipes with their revisions, and the route that saves a new revision.
//!
//! Reading needs no login; a revision needs an engineer. The audit of orders gets every attempt of a logged-in person
//! with its outcome. The server opens the audit before the change, so that no revision escapes the audit. `approval.rs`
//! adds the engineers who saved or approved a revision.

use super::access::{Person, Role, audited};
use super::approval::ApprovalState;
use super::asked::{Asked, Author, Body, members};
use super::error::{ApiError, JsonResult, blocking};
use super::history::paper::{Page, with_policy};
use super::language::Preferred;
use super::router::App;
use super::sessions;
use axum::Json;
use axum::extract::State;
use config::{Approval, Change, Folder, Plant, Revision};
use history::inquiry::paper::paper;
use history::report::Lang;
use history::report::card;
use history::{Archive, RevisionEntry};
use machine::dut::prompt::Prompt;
use serde::{Deserialize, Serialize};
use std::path::Path;
use utoipa::{IntoParams, ToSchema};

/// A recipe in the list.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct ListedRecipe {
    name: String,
    title_en: String,
    title_zh: String,
    /// Number of the newest revision; null for a faulty recipe.
    number: Option<u32>,
    /// SHA-256 of the text of the newest revision.
    hash: Option<String>,
    /// Time at which the newest revision was saved, microseconds since 1970 UTC.
    saved_at_us: Option<i64>,
    /// False while the plant requires an approval that the newest revision lacks.
    approved: bool,
    /// Error that keeps the recipe from loading; null for a good recipe.
    trouble: Option<String>,
}

/// `GET /api/recipes`.
pub(super) async fn list(State(app): App) -> JsonResult<Vec<ListedRecipe>> {
    let (folder, db) = (app.shared.config.clone(), app.shared.db.clone());
    blocking(move || {
        let wanted = config::approval(&folder)?;
        let names = config::recipe_names(&folder).into_iter();
        let all = names.map(|name| listed(&folder, (wanted, &db), name));
        all.collect::<Result<_, ApiError>>().map(Json)
    })
    .await
}

fn listed(
    folder: &Folder,
    (wanted, db): (Approval, &Path),
    name: String,
) -> Result<ListedRecipe, ApiError> {
    let found = config::revision(folder, &name, None);
    let good = found.as_ref().ok();
    let title = |path: &str| {
        let title = good?.fields.iter().find(|it| it.path == path)?;
        Some(title.value.as_str()?.to_owned())
    };
    let approval = good.map(|it| ApprovalState::read(wanted, db, it));
    let approval = approval.transpose()?.flatten();
    Ok(ListedRecipe {
        approved: approval.is_none_or(|it| it.is_approved()),
        title_en: title("title_en").unwrap_or_default(),
        title_zh: title("title_zh").unwrap_or_default(),
        number: good.map(|it| it.number),
        hash: good.map(|it| it.hash.clone()),
        saved_at_us: good.and_then(|it| it.saved_at_us),
        trouble: found.as_ref().err().map(ToString::to_string),
        name,
    })
}

/// A revision with its approval.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct ShownRevision {
    #[serde(flatten)]
    revision: Revision,
    /// Approval of the revision; null in a plant that requires no approval.
    approval: Option<ApprovalState>,
    /// Prompts of every lot, from `lot.toml`; the prompts of the recipe are in `fields`.
    prompts_of_lots: Vec<Prompt>,
}

impl ShownRevision {
    pub fn read(folder: &Folder, db: &Path, revision: Revision) -> Result<Self, ApiError> {
        let approval = ApprovalState::read(config::approval(folder)?, db, &revision)?;
        let prompts_of_lots = config::prompts_of_lots(folder)?;
        Ok(Self {
            revision,
            approval,
            prompts_of_lots,
        })
    }
}

#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct RevisionQuery {
    /// Name of the recipe.
    #[param(example = "jzc-22f-012")]
    name: String,
    /// Number of the revision, from 1; the newest when absent.
    #[param(minimum = 1, example = 1)]
    revision: Option<u32>,
}

/// `GET /api/recipes/show`.
pub(super) async fn show(
    State(app): App,
    Asked(RevisionQuery { name, revision }): Asked<RevisionQuery>,
) -> JsonResult<ShownRevision> {
    let (folder, db) = (app.shared.config.clone(), app.shared.db.clone());
    let read = move || {
        let revision = config::revision(&folder, &name, revision)?;
        ShownRevision::read(&folder, &db, revision)
    };
    blocking(read).await.map(Json)
}

#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct CardQuery {
    /// Name of the recipe.
    #[param(example = "jzc-22f-012")]
    name: String,
    /// Language, `zh` or `en`; when absent, the language of `Accept-Language`, else English.
    #[param(inline)]
    lang: Option<Lang>,
}

members!(RevisionQuery, CardQuery);

/// `GET /api/recipes/card`.
pub(super) async fn card(
    State(app): App,
    preferred: Preferred,
    Asked(CardQuery { name, lang }): Asked<CardQuery>,
) -> Result<Page, ApiError> {
    let folder = app.shared.config.clone();
    let made = move || {
        let recipe = config::load_recipe(&folder, &name)?;
        let paper = paper(preferred.unless(lang));
        let plant = config::load_card(&folder)?;
        let card = card::card(&paper, &recipe, &plant);
        Ok::<_, ApiError>(with_policy(card))
    };
    blocking(made).await
}

#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct RecipeQuery {
    /// Name of the recipe.
    #[param(example = "jzc-22f-012")]
    name: String,
}

members!(RecipeQuery);

/// `GET /api/recipes/revisions`.
pub(super) async fn revisions(
    State(app): App,
    Asked(RecipeQuery { name }): Asked<RecipeQuery>,
) -> JsonResult<Vec<RevisionEntry>> {
    let folder = app.shared.config.clone();
    let read = move |archive: &Archive| {
        config::revision(&folder, &name, None)?;
        Ok(archive.revisions(&name)?)
    };
    app.readers.read(read).await.map(Json)
}

/// `POST /api/recipes/revise`.
pub(super) async fn revise(
    State(app): App,
    author: Author,
    Body(change): Body<Change>,
) -> JsonResult<ShownRevision> {
    let (folder, db) = (app.shared.config.clone(), app.shared.db.clone());
    blocking(move || {
        let (what, revise) = (
            |saved: Option<&_>| change.audit(saved),
            || revised(&folder, &author.person, &change),
        );
        let saved = audited(&db, author.by(), what, ApiError::message, revise)??;
        ShownRevision::read(&folder, &db, saved).map(Json)
    })
    .await
}

fn revised(folder: &Folder, person: &Person, change: &Change) -> Result<Revision, ApiError> {
    sessions::require_role(person, Role::Engineer)?;
    let plant = Plant::load(folder)?;
    config::revise(&plant, change).map_err(|refused| ApiError::Revision { refused })
}
