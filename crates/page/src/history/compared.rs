//! `/api/history/compare` and `report/comparison`: lots side by side; `rejects` and `alarm-counts`: reasons of rejects,
//! and alarms, the most frequent first.

use super::super::error::{ApiError, JsonResult};
use super::Readers;
use super::members::{OneParameter, Printed, Runs, TimeSpan, filter};
use super::paper::{Page, page};
use crate::asked::{Asked, members};
use crate::language::Preferred;
use axum::Json;
use history::inquiry::comparison::{Comparison, compare};
use history::inquiry::pareto::{Ranked, Rejects, alarms, rejects};
use history::inquiry::{InquiryError, paper};
use history::report::comparison::comparison;
use history::{Archive, Filter};
use serde::Deserialize;
use utoipa::IntoParams;

/// Member of the query string that only a comparison takes.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct OfLots {
    /// Names of two to eight different lots, as a JSON array.
    #[param(example = r#"["L-1121","L-1122"]"#)]
    lots: String,
}

members!(OfLots);

fn compared(archive: &Archive, of: &OneParameter, lots: &OfLots) -> Result<Comparison, ApiError> {
    let names: Vec<String> = serde_json::from_str(&lots.lots).map_err(|_| {
        let reason = format!("found {:?}, expected a JSON array of names", lots.lots);
        InquiryError::member("lots", reason)
    })?;
    Ok(compare(archive, &of.param, &names)?)
}

/// `GET /api/history/compare`.
pub(crate) async fn lots(
    readers: Readers,
    Asked((of, lots)): Asked<(OneParameter, OfLots)>,
) -> JsonResult<Comparison> {
    let read = move |archive: &Archive| compared(archive, &of, &lots);
    readers.read(read).await.map(Json)
}

/// `GET /api/history/report/comparison`.
pub(crate) async fn printed(
    readers: Readers,
    preferred: Preferred,
    Asked((of, lots, printed)): Asked<(OneParameter, OfLots, Printed)>,
) -> Result<Page, ApiError> {
    page(&readers, move |archive| {
        let on = paper::paper_of(archive, &Filter::default(), preferred.unless(printed.lang))?;
        Ok(comparison(&on, &compared(archive, &of, &lots)?))
    })
    .await
}

/// `GET /api/history/rejects`.
pub(crate) async fn reasons(
    readers: Readers,
    Asked(asked): Asked<(Runs, TimeSpan)>,
) -> JsonResult<Rejects> {
    let read = move |archive: &Archive| Ok(rejects(archive, &filter(asked), 0)?);
    readers.read(read).await.map(Json)
}

/// `GET /api/history/alarm-counts`.
pub(crate) async fn alarm_counts(
    readers: Readers,
    Asked(asked): Asked<(Runs, TimeSpan)>,
) -> JsonResult<Vec<Ranked>> {
    let read = move |archive: &Archive| Ok(alarms(archive, &filter(asked))?);
    readers.read(read).await.map(Json)
}
