//! `/api/history/...`: the command `history` over HTTP, with the same filter in the query string.
//!
//! | route | members of the filter | answer |
//! |---|---|---|
//! | `query` | all | array of parts, streamed: it may be long |
//! | `list` | `lot`, `run`, `recipe` | array of runs with their counts |
//! | `show` | `lot`, `seq`, `kind` | array with that part of every run, down to the raw replies |
//! | `stats` | `param` and all but `min`, `max` | one object |
//!
//! A member that a route does not use is refused rather than ignored. Readers work beside the async
//! threads, at most [`AT_ONCE`] of them, and hold up no writer.

use super::error::HmiError;
use super::history_feed;
use super::router::Desk;
use crate::history::{Archive, Filter, LimitsSeen, LotSummary, Part};
use crate::quality::{Limits, Summary};
use axum::Json;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use axum::response::Response;
use serde::Deserialize;
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::task::spawn_blocking;

/// Readers at the same time; further ones wait.
const AT_ONCE: usize = 4;

type Filtered = Result<Query<Filter>, QueryRejection>;

/// Who reads the history, and how many.
#[derive(Debug, Clone)]
pub(super) struct Readers {
    db: PathBuf,
    places: Arc<Semaphore>,
}

impl Readers {
    pub fn new(db: PathBuf) -> Self {
        let places = Arc::new(Semaphore::new(AT_ONCE));
        Self { db, places }
    }

    /// An open archive and the place it takes, to be dropped together.
    pub async fn open(&self) -> Result<(Archive, OwnedSemaphorePermit), HmiError> {
        let place = Arc::clone(&self.places).acquire_owned().await;
        let place = place.map_err(|_| HmiError::ReaderLost)?;
        let db = self.db.clone();
        let archive = spawn_blocking(move || Archive::open(&db)).await;
        Ok((archive.map_err(|_| HmiError::ReaderLost)??, place))
    }

    async fn read<T: Send + 'static>(
        &self,
        read: impl FnOnce(&Archive) -> Result<T, HmiError> + Send + 'static,
    ) -> Result<T, HmiError> {
        let (archive, place) = self.open().await?;
        let work = move || {
            let found = read(&archive);
            drop(place);
            found
        };
        spawn_blocking(work)
            .await
            .map_err(|_| HmiError::ReaderLost)?
    }
}

/// `GET /api/history/query`.
pub(super) async fn query(
    State(desk): State<Desk>,
    filter: Filtered,
) -> Result<Response, HmiError> {
    let Query(filter) = filter?;
    sensible(&filter)?;
    history_feed::parts(&desk.readers, filter).await
}

/// `GET /api/history/list`.
pub(super) async fn list(
    State(desk): State<Desk>,
    filter: Filtered,
) -> Result<Json<Vec<LotSummary>>, HmiError> {
    let Query(filter) = filter?;
    let used = Filter {
        lot: filter.lot.clone(),
        run: filter.run,
        recipe: filter.recipe.clone(),
        ..Filter::default()
    };
    if used != filter {
        let reason = "`list` takes lot, run and recipe only".to_owned();
        return Err(HmiError::Query { reason });
    }
    let read = move |archive: &Archive| Ok(archive.lots(&filter)?);
    desk.readers.read(read).await.map(Json)
}

/// Which part.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Which {
    lot: String,
    seq: u64,
    /// `lot` (when absent) or `golden`.
    kind: Option<String>,
}

/// `GET /api/history/show`.
pub(super) async fn show(
    State(desk): State<Desk>,
    which: Result<Query<Which>, QueryRejection>,
) -> Result<Json<Vec<Part>>, HmiError> {
    let Query(Which { lot, seq, kind }) = which?;
    one_of("kind", kind.as_deref(), &["lot", "golden"])?;
    let read = move |archive: &Archive| {
        let kind = kind.as_deref().unwrap_or("lot");
        let parts = archive.show(&lot, seq, kind)?;
        if parts.is_empty() {
            let what = format!("lot {lot:?} has no {kind} part {seq}");
            return Err(HmiError::NotInHistory { what });
        }
        Ok(parts)
    };
    desk.readers.read(read).await.map(Json)
}

/// `GET /api/history/stats`.
pub(super) async fn stats(
    State(desk): State<Desk>,
    filter: Filtered,
) -> Result<Json<Summary>, HmiError> {
    let Query(mut filter) = filter?;
    sensible(&filter)?;
    let Some(param) = filter.param.take() else {
        return Err(refused("param", "missing: `stats` is about one parameter"));
    };
    if filter.min.is_some() || filter.max.is_some() {
        return Err(refused(
            "min, max",
            "`stats` is about all values, not a range of them",
        ));
    }
    let read = move |archive: &Archive| {
        known_parameter(archive, &param)?;
        known_runs(archive, &filter)?;
        let found = archive.values(&param, &filter)?;
        let limits = match found.limits {
            LimitsSeen::Same { low, high } => Limits { low, high },
            LimitsSeen::None | LimitsSeen::Differ => Limits::default(),
        };
        Ok(Summary::of(&param, &found.values, limits))
    };
    desk.readers.read(read).await.map(Json)
}

/// Refuses a filter that nothing can pass because of a slip.
fn sensible(filter: &Filter) -> Result<(), HmiError> {
    let verdicts = ["pass", "fail", "void", "unjudged"];
    one_of("verdict", filter.verdict.as_deref(), &verdicts)?;
    one_of("kind", filter.kind.as_deref(), &["lot", "golden", "all"])?;
    for (field, value) in [("min", filter.min), ("max", filter.max)] {
        if value.is_some_and(|it| !it.is_finite()) {
            return Err(refused(field, "expected a finite number"));
        }
        if value.is_some() && filter.param.is_none() {
            return Err(refused(field, "needs param"));
        }
    }
    match (filter.min, filter.max) {
        (Some(min), Some(max)) if min > max => Err(refused("min", "is above max")),
        _ => Ok(()),
    }
}

fn one_of(field: &'static str, found: Option<&str>, known: &[&str]) -> Result<(), HmiError> {
    match found {
        Some(found) if !known.contains(&found) => {
            let found: String = found.chars().take(40).collect();
            let reason = format!("found {found:?}, expected one of {}", known.join(", "));
            Err(HmiError::Filter { field, reason })
        }
        Some(_) | None => Ok(()),
    }
}

/// Refuses a parameter that the history has never seen.
pub(super) fn known_parameter(archive: &Archive, param: &str) -> Result<(), HmiError> {
    let known = archive.parameters()?;
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    one_of("param", Some(param), &known)
}

/// A lot or recipe that never was is a slip of the hand, not an empty answer.
fn known_runs(archive: &Archive, filter: &Filter) -> Result<(), HmiError> {
    let named = filter.lot.is_some() || filter.recipe.is_some() || filter.run.is_some();
    if named && archive.lots(filter)?.is_empty() {
        let what = "no run has this lot, run and recipe".to_owned();
        return Err(HmiError::NotInHistory { what });
    }
    Ok(())
}

fn refused(field: &'static str, reason: &str) -> HmiError {
    let reason = reason.to_owned();
    HmiError::Filter { field, reason }
}
