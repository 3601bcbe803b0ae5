//! `/api/history/rejudge`: judges the stored values of a lot by a recipe, as `history rejudge --json` does; writes
//! nothing.

use super::super::error::{ApiError, blocking};
use super::super::router::App;
use super::feed::{self, Pieces};
use crate::answers::{As, Stream};
use crate::asked::{Asked, members};
use axum::extract::State;
use config::load_recipe;
use history::Archive;
use history::inquiry::rejudge::{Changes, RejudgedPart, Rejudging};
use serde::Deserialize;
use std::io::{self, Write};
use utoipa::{IntoParams, ToSchema};

/// Members of the route, which select lot and recipe.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct RejudgeQuery {
    /// Name of the lot.
    #[param(example = "L-1122")]
    lot: String,
    /// Name of a recipe of the plant.
    #[param(example = "jzc-22f-012")]
    recipe: String,
    /// Number of the run; all runs when absent.
    #[param(example = 1)]
    run: Option<u32>,
    /// True: only parts whose verdict changes.
    #[param(example = true)]
    changed: Option<bool>,
}

members!(RejudgeQuery);

/// A part, or the summary as the last element.
#[derive(ToSchema)]
#[serde(untagged)]
#[expect(
    dead_code,
    reason = "describes the two objects that are written one by one"
)]
pub(crate) enum Rejudged {
    Part(RejudgedPart),
    Summary(Changes),
}

/// `GET /api/history/rejudge`: returns an array of parts with the summary as its last element.
pub(crate) async fn rejudge(
    State(app): App,
    Asked(asked): Asked<RejudgeQuery>,
) -> Result<As<Stream<Rejudged>>, ApiError> {
    let RejudgeQuery {
        lot,
        recipe,
        run,
        changed,
    } = asked;
    let changed = changed.unwrap_or(false);
    let (archive, place) = app.readers.open().await?;
    let folder = app.shared.config.clone();
    let prepared = blocking(move || -> Result<(Archive, Rejudging), ApiError> {
        let recipe = load_recipe(&folder, &recipe)?;
        let question = Rejudging::of(&archive, lot, run, recipe)?;
        Ok((archive, question))
    });
    let (archive, question) = prepared.await?;
    let parts = feed::streamed((archive, place), move |archive, out| {
        written(&question, archive, changed, out)
    });
    Ok(super::json_stream(parts))
}

fn written(
    question: &Rejudging,
    archive: &Archive,
    changed: bool,
    out: &mut Pieces,
) -> io::Result<()> {
    type Lost = Box<dyn std::error::Error + Send + Sync>;
    out.write_all(b"[\n")?;
    let each = |part: RejudgedPart| -> Result<(), Lost> {
        if part.changes() || !changed {
            serde_json::to_writer(&mut *out, &part)?;
            out.write_all(b",\n")?;
        }
        Ok(())
    };
    let summary = question.each(archive, each).map_err(io::Error::other)?;
    serde_json::to_writer(&mut *out, &summary.map_err(io::Error::other)?)?;
    out.write_all(b"\n]\n")
}
