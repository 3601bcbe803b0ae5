//! `GET /api/trace`: the last traffic of every line with its meaning.
//!
//! `last` is the number of messages of each line, 1 to [`MOST`]; 100 when absent. The array is empty until a run has
//! opened its lines.

use super::error::{ApiError, JsonResult, Members};
use super::router::App;
use axum::Json;
use axum::extract::{Query, State};
use machine::view::LineTraffic;
use serde::Deserialize;
use std::fmt;
use std::sync::Arc;

/// Greatest `last`: the number of messages that each line keeps.
const MOST: usize = 1000;

/// Function that returns the last messages of every line; its argument is the largest number of messages per line.
type ReadTraffic = dyn Fn(usize) -> Vec<LineTraffic> + Send + Sync;

/// Access to the traffic of the lines; clones read the same lines.
#[derive(Clone)]
pub struct Traffic(Arc<ReadTraffic>);

impl Traffic {
    /// Wraps `read`, which returns at most the given number of messages of each line.
    pub fn new(read: impl Fn(usize) -> Vec<LineTraffic> + Send + Sync + 'static) -> Self {
        Self(Arc::new(read))
    }
}

impl fmt::Debug for Traffic {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("Traffic")
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TraceQuery {
    last: Option<usize>,
}

pub(super) async fn trace(
    State(app): App,
    asked: Members<TraceQuery>,
) -> JsonResult<Vec<LineTraffic>> {
    let Query(TraceQuery { last }) = asked?;
    let last = ApiError::ranged("last", last, 100, MOST)?;
    Ok(Json((app.shared.traffic.0)(last)))
}
