//! `/api/history/report/...`: the pages of `history report` and `history spc --page`, for printing.

use super::super::error::ApiError;
use super::Readers;
use super::members::{Charting, OfParts, OneLot, Paging, Printed, Runs, TimeSpan, filter};
use crate::answers::{self, As};
use crate::asked::{Asked, members};
use crate::language::Preferred;
use axum::http::HeaderName;
use axum::http::header::CONTENT_SECURITY_POLICY;
use axum::response::Html;
use history::Archive;
use history::inquiry::{charts, checks, paper};
use serde::Deserialize;
use utoipa::IntoParams;

/// Content security policy of a printed page: inline style only, no script, no other source.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; \
    form-action 'none'; frame-ancestors 'none'";

/// Answer with a page for A4, and [`POLICY`] in its header.
pub(crate) type Page = As<answers::Html, ([(HeaderName, &'static str); 1], Html<String>)>;

/// Adds a header with [`POLICY`] to `page`.
pub(crate) fn with_policy(page: String) -> Page {
    As::new(([(CONTENT_SECURITY_POLICY, POLICY)], Html(page)))
}

/// Member of the query string that only `report/lot` takes.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct OfReport {
    /// Shortest cycle that the line can keep, s, for the OEE; the 5 % quantile of the cycle times when absent.
    #[param(example = 1.0)]
    ideal_cycle_s: Option<f64>,
}

/// Member of the query string that only `report/certificate` takes.
#[derive(Debug, Deserialize, IntoParams)]
pub(crate) struct OfCertificate {
    /// Number of the part.
    #[param(example = 1)]
    seq: u64,
}

members!(OfReport, OfCertificate);

/// `GET /api/history/report/lot`.
pub(crate) async fn lot(
    readers: Readers,
    preferred: Preferred,
    Asked((lot, printed, own)): Asked<(OneLot, Printed, OfReport)>,
) -> Result<Page, ApiError> {
    let filter = filter(lot);
    page(&readers, move |archive| {
        let on = paper::paper_of(archive, &filter, preferred.unless(printed.lang))?;
        Ok(paper::lot_report(archive, &filter, own.ideal_cycle_s, &on)?)
    })
    .await
}

/// `GET /api/history/report/certificate`.
pub(crate) async fn certificate(
    readers: Readers,
    preferred: Preferred,
    Asked((lot, printed, own)): Asked<(OneLot, Printed, OfCertificate)>,
) -> Result<Page, ApiError> {
    let filter = filter(lot);
    page(&readers, move |archive| {
        let on = paper::paper_of(archive, &filter, preferred.unless(printed.lang))?;
        Ok(paper::part_certificate(archive, &filter, own.seq, &on)?)
    })
    .await
}

/// `GET /api/history/report/alarms`.
pub(crate) async fn alarms(
    readers: Readers,
    preferred: Preferred,
    Asked((asked, printed)): Asked<((Runs, TimeSpan, Paging), Printed)>,
) -> Result<Page, ApiError> {
    let filter = filter(asked);
    page(&readers, move |archive| {
        let on = paper::paper_of(archive, &filter, preferred.unless(printed.lang))?;
        Ok(paper::alarm_list(archive, &filter, &on)?)
    })
    .await
}

/// `GET /api/history/report/chart`.
pub(crate) async fn chart(
    readers: Readers,
    preferred: Preferred,
    Asked((asked, how, printed)): Asked<((Runs, TimeSpan, OfParts), Charting, Printed)>,
) -> Result<Page, ApiError> {
    let filter = filter(asked);
    checks::validate(&filter)?;
    let last = how.last()?;
    page(&readers, move |archive| {
        let on = paper::paper_of(archive, &filter, preferred.unless(printed.lang))?;
        let about = filter.lot.clone().unwrap_or_default();
        let charts = super::charted(archive, &filter, &how)?;
        Ok(charts::page(&on, &about, &charts, last))
    })
    .await
}

pub(super) async fn page(
    readers: &Readers,
    made: impl FnOnce(&Archive) -> Result<String, ApiError> + Send + 'static,
) -> Result<Page, ApiError> {
    readers.read(made).await.map(with_policy)
}
