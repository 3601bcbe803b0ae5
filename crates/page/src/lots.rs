//! `/api/lots` and `/api/wear`, for the page of lots.
//!
//! | route | members | answer |
//! |---|---|---|
//! | `GET /api/lots` | `limit`, `offset` | array of lots, latest run first: state, recipe, counts over all runs, and `why_not` |
//! | `GET /api/wear` | | array of wear counters of the rig that the server shows |
//!
//! `why_not` maps each order about lots to null, or to the reason (`code`, `args`, `en`, `zh`) why the state of the lot
//! forbids it. For the lot under way the buttons of the view apply instead.

use super::error::{ApiError, JsonResult, Members};
use super::router::App;
use axum::Json;
use axum::extract::{Query, State};
use history::{Archive, Decision, LotEntry, LotState, Wear};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use texts::Message;

/// Default of `limit`.
const SHOWN: u32 = 20;
/// Greatest `limit`, because the server counts all parts of each listed lot.
const MOST: u32 = 200;

/// A lot with the orders that its state allows.
#[derive(Debug, Serialize)]
pub(super) struct ListedLot {
    #[serde(flatten)]
    line: LotEntry,
    why_not: BTreeMap<&'static str, Option<Message>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Paging {
    limit: Option<u32>,
    offset: Option<u32>,
}

/// `GET /api/lots`.
pub(super) async fn lots(State(app): App, page: Members<Paging>) -> JsonResult<Vec<ListedLot>> {
    let Query(Paging { limit, offset }) = page?;
    let limit = ApiError::ranged("limit", limit, SHOWN, MOST)?;
    let read = move |archive: &Archive| Ok(archive.lot_book(limit, offset.unwrap_or(0))?);
    let book = app.readers.read(read).await?;
    let listed = book.into_iter().map(|line| ListedLot {
        why_not: why_not(line.standing.state),
        line,
    });
    Ok(Json(listed.collect()))
}

fn why_not(state: LotState) -> BTreeMap<&'static str, Option<Message>> {
    let decisions = Decision::ALL
        .into_iter()
        .map(|it| (it.order(), it.refusal(state)));
    let held = (state == LotState::Held).then(|| Message::new("refusal", "release_first"));
    decisions.chain([("start", held)]).collect()
}

/// `GET /api/wear`.
pub(super) async fn wear(State(app): App) -> JsonResult<Vec<Wear>> {
    let simulated = app.shared.view.borrow().simulated;
    let read = move |archive: &Archive| Ok(archive.wear(simulated)?);
    app.readers.read(read).await.map(Json)
}
