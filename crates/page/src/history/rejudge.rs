//! `/api/history/rejudge`: judges the stored values of a lot by a recipe, as `history rejudge --json` does; writes
//! nothing.

use super::super::error::{ApiError, Members, blocking};
use super::super::router::App;
use super::feed::{self, Pieces};
use axum::extract::{Query, State};
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use config::load_recipe;
use history::Archive;
use history::inquiry::rejudge::{RejudgedPart, Rejudging};
use serde::Deserialize;
use std::io::{self, Write};

/// Members of the route, which select lot and recipe.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RejudgeQuery {
    lot: String,
    recipe: String,
    /// Number of the run; all runs when absent.
    run: Option<u32>,
    /// True to return only parts whose verdict changes.
    #[serde(default)]
    changed: bool,
}

/// `GET /api/history/rejudge`: returns an array of parts with the summary as its last element.
pub(crate) async fn rejudge(
    State(app): App,
    asked: Members<RejudgeQuery>,
) -> Result<Response, ApiError> {
    let Query(RejudgeQuery {
        lot,
        recipe,
        run,
        changed,
    }) = asked?;
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
    Ok(([(CONTENT_TYPE, "application/json")], parts).into_response())
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
