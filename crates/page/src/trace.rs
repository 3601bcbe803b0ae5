//! `GET /api/trace`: the last traffic of every line with its meaning.
//!
//! `last` is how many messages of each line, 1 to [`MOST`]; 100 without it. Before a run has opened its lines the array is
//! empty.

use super::error::HmiError;
use super::router::Desk;
use axum::Json;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use machine::view::LineTraffic;
use serde::Deserialize;
use std::fmt;
use std::sync::Arc;

/// What the lines themselves remember.
const MOST: usize = 1000;

/// Gives the last so many messages of every line.
type Look = dyn Fn(usize) -> Vec<LineTraffic> + Send + Sync;

/// Where traffic is read from; copies read the same.
#[derive(Clone)]
pub struct Traffic(Arc<Look>);

impl Traffic {
    /// From whoever holds the lines; `look` is called with the number of messages wanted.
    pub fn new(look: impl Fn(usize) -> Vec<LineTraffic> + Send + Sync + 'static) -> Self {
        Self(Arc::new(look))
    }
}

impl fmt::Debug for Traffic {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("Traffic")
    }
}

/// Of the query string.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Asked {
    last: Option<usize>,
}

pub(super) async fn trace(
    State(desk): State<Desk>,
    asked: Result<Query<Asked>, QueryRejection>,
) -> Result<Json<Vec<LineTraffic>>, HmiError> {
    let Query(Asked { last }) = asked?;
    let last = last.unwrap_or(100);
    if !(1..=MOST).contains(&last) {
        let reason = format!("last: found {last}, expected 1 to {MOST}");
        return Err(HmiError::Query { reason });
    }
    Ok(Json((desk.shared.traffic.0)(last)))
}
