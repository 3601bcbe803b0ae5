//! `/api/history/report/...`: the pages of `history report` and `history spc --page`, to be opened and printed.

use super::super::error::HmiError;
use super::super::router::Desk;
use super::asked::{Charting, Printed, asked, language};
use axum::extract::State;
use axum::http::header::CONTENT_SECURITY_POLICY;
use axum::http::{HeaderName, Uri};
use axum::response::Html;
use history::inquiry::{InquiryError, charts, checks, paper};
use history::{Archive, Filter};

/// A page is complete in itself: its own style, nothing from elsewhere, no script.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; \
    form-action 'none'; frame-ancestors 'none'";

/// A page for A4.
pub(in super::super) type Page = ([(HeaderName, &'static str); 1], Html<String>);

/// `page` with its policy.
pub(in super::super) fn on_paper(page: String) -> Page {
    ([(CONTENT_SECURITY_POLICY, POLICY)], Html(page))
}

/// `GET /api/history/report/lot`.
pub(in super::super) async fn lot(State(desk): State<Desk>, uri: Uri) -> Result<Page, HmiError> {
    let (filter, own) = printed(&uri, "report/lot", &["lot", "run", "recipe"])?;
    refuse("seq", own.seq.is_some())?;
    page(desk, move |archive| {
        let on = paper::paper(language(own.lang));
        Ok(paper::lot_report(archive, &filter, own.ideal_cycle_s, &on)?)
    })
    .await
}

/// `GET /api/history/report/certificate`.
pub(in super::super) async fn certificate(
    State(desk): State<Desk>,
    uri: Uri,
) -> Result<Page, HmiError> {
    let (filter, own) = printed(&uri, "report/certificate", &["lot", "run", "recipe"])?;
    refuse("ideal_cycle_s", own.ideal_cycle_s.is_some())?;
    let Some(seq) = own.seq else {
        return Err(InquiryError::member("seq", "missing: which part of the lot").into());
    };
    page(desk, move |archive| {
        let on = paper::paper(language(own.lang));
        Ok(paper::part_certificate(archive, &filter, seq, &on)?)
    })
    .await
}

/// `GET /api/history/report/alarms`.
pub(in super::super) async fn alarms(State(desk): State<Desk>, uri: Uri) -> Result<Page, HmiError> {
    let (filter, own) = printed(&uri, "report/alarms", super::OF_ALARMS)?;
    refuse("seq", own.seq.is_some())?;
    refuse("ideal_cycle_s", own.ideal_cycle_s.is_some())?;
    page(desk, move |archive| {
        let on = paper::paper(language(own.lang));
        Ok(paper::alarm_list(archive, &filter, &on)?)
    })
    .await
}

/// `GET /api/history/report/chart`.
pub(in super::super) async fn chart(State(desk): State<Desk>, uri: Uri) -> Result<Page, HmiError> {
    let (filter, how) = asked::<Charting>(&uri)?;
    checks::validate(&filter)?;
    let last = how.last()?;
    page(desk, move |archive| {
        let on = paper::paper(language(how.lang));
        let about = filter.lot.clone().unwrap_or_default();
        let charts = super::charted(archive, filter, &how)?;
        Ok(charts::page(&on, &about, &charts, last))
    })
    .await
}

async fn page(
    desk: Desk,
    made: impl FnOnce(&Archive) -> Result<String, HmiError> + Send + 'static,
) -> Result<Page, HmiError> {
    desk.readers.read(made).await.map(on_paper)
}

fn printed(uri: &Uri, route: &str, used: &[&str]) -> Result<(Filter, Printed), HmiError> {
    let (filter, own) = asked::<Printed>(uri)?;
    checks::only(&filter, route, used)?;
    Ok((filter, own))
}

pub(super) fn refuse(member: &'static str, found: bool) -> Result<(), HmiError> {
    if found {
        return Err(InquiryError::member(member, "not a member of this page").into());
    }
    Ok(())
}
