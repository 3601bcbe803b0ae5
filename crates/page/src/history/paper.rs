//! `/api/history/report/...`: the pages of `history report` and `history spc --page`, for printing.

use super::super::error::ApiError;
use super::super::router::{App, AppState};
use super::members::{ChartMembers, ReportMembers, language, split};
use axum::extract::State;
use axum::http::header::CONTENT_SECURITY_POLICY;
use axum::http::{HeaderName, Uri};
use axum::response::Html;
use history::inquiry::{InquiryError, charts, checks, paper};
use history::{Archive, Filter};

/// Content security policy of a printed page: inline style only, no script, no other source.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; \
    form-action 'none'; frame-ancestors 'none'";

/// Answer with a page for A4, and [`POLICY`] in its header.
pub(crate) type Page = ([(HeaderName, &'static str); 1], Html<String>);

/// Adds a header with [`POLICY`] to `page`.
pub(crate) fn with_policy(page: String) -> Page {
    ([(CONTENT_SECURITY_POLICY, POLICY)], Html(page))
}

/// `GET /api/history/report/lot`.
pub(crate) async fn lot(State(app): App, uri: Uri) -> Result<Page, ApiError> {
    let (filter, own) = printed(&uri, "report/lot", &["lot", "run", "recipe"])?;
    refuse("seq", own.seq.is_some())?;
    page(app, move |archive| {
        let on = paper::paper_of(archive, &filter, language(own.lang))?;
        Ok(paper::lot_report(archive, &filter, own.ideal_cycle_s, &on)?)
    })
    .await
}

/// `GET /api/history/report/certificate`.
pub(crate) async fn certificate(State(app): App, uri: Uri) -> Result<Page, ApiError> {
    let (filter, own) = printed(&uri, "report/certificate", &["lot", "run", "recipe"])?;
    refuse("ideal_cycle_s", own.ideal_cycle_s.is_some())?;
    let Some(seq) = own.seq else {
        return Err(InquiryError::member("seq", "missing: which part of the lot").into());
    };
    page(app, move |archive| {
        let on = paper::paper_of(archive, &filter, language(own.lang))?;
        Ok(paper::part_certificate(archive, &filter, seq, &on)?)
    })
    .await
}

/// `GET /api/history/report/alarms`.
pub(crate) async fn alarms(State(app): App, uri: Uri) -> Result<Page, ApiError> {
    let (filter, own) = printed(&uri, "report/alarms", super::OF_ALARMS)?;
    refuse("seq", own.seq.is_some())?;
    refuse("ideal_cycle_s", own.ideal_cycle_s.is_some())?;
    page(app, move |archive| {
        let on = paper::paper_of(archive, &filter, language(own.lang))?;
        Ok(paper::alarm_list(archive, &filter, &on)?)
    })
    .await
}

/// `GET /api/history/report/chart`.
pub(crate) async fn chart(State(app): App, uri: Uri) -> Result<Page, ApiError> {
    let (filter, how) = split::<ChartMembers>(&uri)?;
    checks::validate(&filter)?;
    let last = how.last()?;
    page(app, move |archive| {
        let on = paper::paper_of(archive, &filter, language(how.lang))?;
        let about = filter.lot.clone().unwrap_or_default();
        let charts = super::charted(archive, filter, &how)?;
        Ok(charts::page(&on, &about, &charts, last))
    })
    .await
}

async fn page(
    app: AppState,
    made: impl FnOnce(&Archive) -> Result<String, ApiError> + Send + 'static,
) -> Result<Page, ApiError> {
    app.readers.read(made).await.map(with_policy)
}

fn printed(uri: &Uri, route: &str, used: &[&str]) -> Result<(Filter, ReportMembers), ApiError> {
    let (filter, own) = split::<ReportMembers>(uri)?;
    checks::only(&filter, route, used)?;
    Ok((filter, own))
}

pub(super) fn refuse(member: &'static str, found: bool) -> Result<(), ApiError> {
    if found {
        return Err(InquiryError::member(member, "not a member of this page").into());
    }
    Ok(())
}
