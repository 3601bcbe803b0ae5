//! `POST /api/quality/grr`: gauge repeatability and reproducibility of readings that the body brings. Stores nothing.

use super::asked::Body;
use super::error::{ApiError, JsonResult, blocking};
use axum::Json;
use history::inquiry::gauge::read_csv;
use quality::GaugeRr;
use quality::gauge_rr::anova;
use serde::Deserialize;
use utoipa::ToSchema;

/// Body of the request.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Study {
    /// CSV with the columns part, operator, trial and value.
    #[schema(
        example = "part,operator,trial,value\n1,li,1,5.1\n1,li,2,5.2\n2,li,1,6.1\n2,li,2,6.1"
    )]
    csv: String,
}

/// `POST /api/quality/grr`.
pub(super) async fn study(Body(study): Body<Study>) -> JsonResult<GaugeRr> {
    let refused = |reason: String| ApiError::Query {
        reason: format!("csv: {reason}"),
    };
    let evaluate = move || {
        let readings = read_csv(&study.csv).map_err(|error| refused(error.to_string()))?;
        anova(&readings).map_err(|error| refused(error.to_string()))
    };
    blocking(evaluate).await.map(Json)
}
