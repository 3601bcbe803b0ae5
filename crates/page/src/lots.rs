//! `/api/lots`, `/api/wear`: what the page of lots shows beside the view.
//!
//! | route | members | answer |
//! |---|---|---|
//! | `GET /api/lots` | `limit`, `offset` | array of lots, the one run last first: state, recipe, counts over all runs, and `why_not` |
//! | `GET /api/wear` | | array of counters of what wears, of the rig that is shown |
//!
//! `why_not` names each order about lots with null, or with the reason (`code`, `args`, `en`, `zh`) for which the state of the lot
//! forbids it. Of the lot under way the buttons of the view tell the same.

use super::error::HmiError;
use super::router::Desk;
use axum::Json;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use history::{Archive, Decision, LotEntry, LotState, Wear};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use texts::Message;

/// Lots of an answer when nobody says how many.
const SHOWN: u32 = 20;
/// The most that may be asked for: every one is counted.
const MOST: u32 = 200;

/// A lot with what may be ordered of it.
#[derive(Debug, Serialize)]
pub(super) struct Listed {
    #[serde(flatten)]
    line: LotEntry,
    why_not: BTreeMap<&'static str, Option<Message>>,
}

/// Of the query string.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Page {
    limit: Option<u32>,
    offset: Option<u32>,
}

/// `GET /api/lots`.
pub(super) async fn lots(
    State(desk): State<Desk>,
    page: Result<Query<Page>, QueryRejection>,
) -> Result<Json<Vec<Listed>>, HmiError> {
    let Query(Page { limit, offset }) = page?;
    let limit = limit.unwrap_or(SHOWN);
    if !(1..=MOST).contains(&limit) {
        let reason = format!("limit: found {limit}, expected 1 to {MOST}");
        return Err(HmiError::Query { reason });
    }
    let read = move |archive: &Archive| Ok(archive.lot_book(limit, offset.unwrap_or(0))?);
    let book = desk.readers.read(read).await?;
    let listed = book.into_iter().map(|line| Listed {
        why_not: why_not(line.standing.state),
        line,
    });
    Ok(Json(listed.collect()))
}

fn why_not(state: LotState) -> BTreeMap<&'static str, Option<Message>> {
    let decisions = Decision::ALL
        .into_iter()
        .map(|it| (it.order(), it.why_not(state)));
    let held = (state == LotState::Held).then(|| Message::new("refusal", "release_first"));
    decisions.chain([("start", held)]).collect()
}

/// `GET /api/wear`.
pub(super) async fn wear(State(desk): State<Desk>) -> Result<Json<Vec<Wear>>, HmiError> {
    let simulated = desk.shared.view.borrow().simulated;
    let read = move |archive: &Archive| Ok(archive.wear(simulated)?);
    desk.readers.read(read).await.map(Json)
}
