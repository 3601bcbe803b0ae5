//! `/api/history/rejudge`: the parts of a lot held against a recipe, as `history rejudge --json`. Nothing is written.

use super::super::error::HmiError;
use super::super::router::Desk;
use super::feed::{self, Pieces};
use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use config::load_recipe;
use history::Archive;
use history::inquiry::rejudge::{RejudgedPart, Rejudging};
use serde::Deserialize;
use std::io::{self, Write};
use tokio::task::spawn_blocking;

/// Which lot by which recipe.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in super::super) struct Asked {
    lot: String,
    recipe: String,
    /// Only this run of the lot.
    run: Option<u32>,
    /// Only parts whose verdict changes.
    #[serde(default)]
    changed: bool,
}

/// `GET /api/history/rejudge`: an array of parts, the summary last.
pub(in super::super) async fn rejudge(
    State(desk): State<Desk>,
    asked: Result<Query<Asked>, QueryRejection>,
) -> Result<Response, HmiError> {
    let Query(Asked {
        lot,
        recipe,
        run,
        changed,
    }) = asked?;
    let (archive, place) = desk.readers.open().await?;
    let dir = desk.shared.config.clone();
    let prepared = spawn_blocking(move || -> Result<(Archive, Rejudging), HmiError> {
        let recipe = load_recipe(&dir, &recipe)?;
        let question = Rejudging::of(&archive, lot, run, recipe)?;
        Ok((archive, question))
    });
    let (archive, question) = prepared.await.map_err(|_| HmiError::ReaderLost)??;
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
