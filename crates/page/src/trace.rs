//! `GET /api/trace`: the last traffic of every line with its meaning.
//!
//! `last` is the number of messages of each line, 1 to [`MOST`]; 100 when absent. The array is empty until a run has
//! opened its lines.

use super::asked::{Asked, members};
use super::error::{ApiError, JsonResult};
use super::router::App;
use axum::Json;
use axum::extract::State;
use machine::view::LineTraffic;
use serde::Deserialize;
use std::fmt;
use std::sync::Arc;
use utoipa::IntoParams;

/// Greatest `last`: the number of messages that each line keeps.
const MOST: u64 = 1000;

/// Function that returns the last messages of every line; its argument is the largest number of messages per line.
type ReadTraffic = dyn Fn(usize) -> Vec<LineTraffic> + Send + Sync;

/// Access to the last traffic of the lines; clones read the same lines.
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

#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct TraceQuery {
    /// Largest number of messages of each line, 1 to 1000; 100 when absent.
    #[param(minimum = 1, maximum = 1000, example = 10)]
    last: Option<u64>,
}

members!(TraceQuery);

pub(super) async fn trace(
    State(app): App,
    Asked(TraceQuery { last }): Asked<TraceQuery>,
) -> JsonResult<Vec<LineTraffic>> {
    let last = ApiError::ranged("last", last, 100, MOST)?;
    let last = usize::try_from(last).unwrap_or(usize::MAX);
    Ok(Json((app.shared.traffic.0)(last)))
}
