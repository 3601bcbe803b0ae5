//! `/api/history/...`: the command `history` over HTTP, with the same filter in the query string.
//!
//! The filter is [`Filter`]: `lot`, `run`, `recipe`, `since`, `until` (RFC 3339), `verdict`, `bin`, `kind`
//! (`lot` when absent, `golden`, `all`), `suspect`, `param`, `min`, `max`, and of an ordered answer the page: `limit`,
//! `offset`.
//!
//! | route | members of the filter | others | answer |
//! |---|---|---|---|
//! | `list` | `lot`, `run`, `recipe` | | array of runs with their counts |
//! | `show` | `lot`, `run`, `kind` | `seq` | array with that part of every run, down to the raw replies |
//! | `query` | all | | array of parts, streamed: it may be long |
//! | `count` | all but the page | | `{"parts": n}`: how long `query` would be |
//! | `yield` | `since`, `until` | | counts of verdicts of all production parts in the span |
//! | `stats` | `param` and all but `min`, `max` | | one object, as `history stats --json` |
//! | `histogram` | the same | | `{"from", "width", "counts", "low", "high"}`, limits where all runs agree |
//! | `spc` | the same; without `param` the share of every bin | `subgroup`, `rules`, `last` | array of control charts |
//! | `alarms` | `lot`, `run`, `recipe`, `since`, `until`, page | | array of alarms in order of time |
//! | `rejudge` | `lot`, `run`, `recipe` | `changed` | array of parts with the verdict of that recipe, then a summary, streamed |
//! | `orders` | `lot`, `run`, `recipe`, `since`, `until`, page | `who` | array of orders with their answers in order of time |
//! | `report/lot` | `lot`, `run`, `recipe` | `lang`, `ideal_cycle_s` | page for A4 |
//! | `report/certificate` | the same | `lang`, `seq` | page for A4 |
//! | `report/chart` | as `spc` | as `spc`, `lang` | page for A4 |
//! | `report/alarms` | as `alarms` | `lang` | page for A4 |
//! | `export.csv` | all | | CSV with byte order mark, streamed |
//! | `export.xlsx` | all | `lang` | spreadsheet with charts, of a bounded number of parts |
//!
//! `lang` is `zh` (when absent) or `en`. A member that a route does not use is refused rather than ignored:
//! 400 with the name. What never was is 404. Readers work beside the async threads, a few at a time, and
//! hold up no writer.

mod asked;
pub(super) mod export;
mod feed;
pub(super) mod paper;
mod readers;
pub(super) mod rejudge;

use super::error::HmiError;
use super::router::Desk;
use asked::{Audited, Charting, asked};
use axum::Json;
use axum::extract::rejection::QueryRejection;
use axum::extract::{Query, State};
use axum::http::Uri;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use history::inquiry::charts::{Charted, charts};
use history::inquiry::figures::{Classes, figures, histogram};
use history::inquiry::{InquiryError, checks};
use history::{Alarm, Archive, Filter, LotSummary, Moment, OrderEntry, Part, Yield};
use quality::Summary;
use quality::rules::Rules;
pub(super) use readers::Readers;
use serde::Deserialize;
use serde_json::{Value, json};
use tokio::task::spawn_blocking;

type Filtered = Result<Query<Filter>, QueryRejection>;

/// Members of the filter that alarms and orders know.
const OF_ALARMS: &[&str] = &["lot", "run", "recipe", "since", "until", "limit", "offset"];

/// `GET /api/history/query`.
pub(super) async fn query(
    State(desk): State<Desk>,
    filter: Filtered,
) -> Result<Response, HmiError> {
    let Query(filter) = filter?;
    checks::validate(&filter)?;
    let (archive, place) = desk.readers.open().await?;
    let param = filter.param.clone();
    let known = move || checks::parameters(&archive, param.as_deref()).map(|_| archive);
    let archive = spawn_blocking(known).await;
    let archive = archive.map_err(|_| HmiError::ReaderLost)??;
    let parts = feed::streamed((archive, place), move |archive, out| {
        feed::parts(archive, &filter, out)
    });
    Ok(([(CONTENT_TYPE, "application/json")], parts).into_response())
}

/// `GET /api/history/count`.
pub(super) async fn count(
    State(desk): State<Desk>,
    filter: Filtered,
) -> Result<Json<Value>, HmiError> {
    let Query(filter) = filter?;
    checks::validate(&filter)?;
    if filter.limit.is_some() || filter.offset.is_some() {
        return Err(InquiryError::member("limit, offset", "`count` is about all pages").into());
    }
    let read = move |archive: &Archive| {
        checks::parameters(archive, filter.param.as_deref())?;
        Ok(json!({"parts": archive.how_many(&filter)?}))
    };
    desk.readers.read(read).await.map(Json)
}

/// `GET /api/history/list`.
pub(super) async fn list(
    State(desk): State<Desk>,
    filter: Filtered,
) -> Result<Json<Vec<LotSummary>>, HmiError> {
    let Query(filter) = filter?;
    checks::only(&filter, "list", &["lot", "run", "recipe"])?;
    let read = move |archive: &Archive| Ok(archive.lots(&filter)?);
    desk.readers.read(read).await.map(Json)
}

/// `GET /api/history/yield`.
pub(super) async fn yields(
    State(desk): State<Desk>,
    filter: Filtered,
) -> Result<Json<Yield>, HmiError> {
    let Query(filter) = filter?;
    checks::only(&filter, "yield", &["since", "until"])?;
    let since = filter.since.unwrap_or(Moment(i64::MIN));
    let until = filter.until.unwrap_or(Moment(i64::MAX));
    let read = move |archive: &Archive| Ok(archive.yield_between(since, until)?);
    desk.readers.read(read).await.map(Json)
}

/// Which part.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Which {
    lot: String,
    seq: u64,
    /// Only of this run.
    run: Option<u32>,
    /// `lot` (when absent) or `golden`.
    kind: Option<String>,
}

/// `GET /api/history/show`.
pub(super) async fn show(
    State(desk): State<Desk>,
    which: Result<Query<Which>, QueryRejection>,
) -> Result<Json<Vec<Part>>, HmiError> {
    let Query(Which {
        lot,
        seq,
        run,
        kind,
    }) = which?;
    checks::one_of("kind", kind.as_deref(), &["lot", "golden"])?;
    let read = move |archive: &Archive| {
        let kind = kind.as_deref().unwrap_or("lot");
        let mut parts = archive.show(&lot, seq, kind)?;
        parts.retain(|part| run.is_none_or(|run| part.run == run));
        if parts.is_empty() {
            let what = format!("lot {lot:?} has no {kind} part {seq}");
            return Err(InquiryError::not_there(what).into());
        }
        Ok(parts)
    };
    desk.readers.read(read).await.map(Json)
}

/// `GET /api/history/stats`.
pub(super) async fn stats(
    State(desk): State<Desk>,
    filter: Filtered,
) -> Result<Json<Summary>, HmiError> {
    let (param, filter) = of_one_parameter(filter?.0, "stats")?;
    let read = move |archive: &Archive| Ok(figures(archive, &param, &filter, None)?.summary);
    desk.readers.read(read).await.map(Json)
}

/// `GET /api/history/histogram`.
pub(super) async fn classes(
    State(desk): State<Desk>,
    filter: Filtered,
) -> Result<Json<Classes>, HmiError> {
    let (param, filter) = of_one_parameter(filter?.0, "histogram")?;
    let read = move |archive: &Archive| Ok(histogram(archive, &param, &filter)?);
    desk.readers.read(read).await.map(Json)
}

/// `GET /api/history/spc`.
pub(super) async fn spc(
    State(desk): State<Desk>,
    uri: Uri,
) -> Result<Json<Vec<Charted>>, HmiError> {
    let (filter, how) = asked::<Charting>(&uri)?;
    checks::validate(&filter)?;
    if how.lang.is_some() {
        return Err(InquiryError::member("lang", "`spc` has no words, `report/chart` has").into());
    }
    let last = how.last()?;
    let read = move |archive: &Archive| {
        let charts = charted(archive, filter, &how)?;
        Ok(charts.into_iter().map(|it| it.last(last)).collect())
    };
    desk.readers.read(read).await.map(Json)
}

/// `GET /api/history/alarms`.
pub(super) async fn alarms(
    State(desk): State<Desk>,
    filter: Filtered,
) -> Result<Json<Vec<Alarm>>, HmiError> {
    let Query(filter) = filter?;
    checks::only(&filter, "alarms", OF_ALARMS)?;
    let read = move |archive: &Archive| Ok(archive.alarms(&filter)?);
    desk.readers.read(read).await.map(Json)
}

/// `GET /api/history/orders`.
pub(super) async fn orders(
    State(desk): State<Desk>,
    uri: Uri,
) -> Result<Json<Vec<OrderEntry>>, HmiError> {
    let (filter, Audited { who }) = asked(&uri)?;
    checks::only(&filter, "orders", OF_ALARMS)?;
    let read = move |archive: &Archive| Ok(archive.orders(&filter, who.as_deref())?);
    desk.readers.read(read).await.map(Json)
}

fn of_one_parameter(mut filter: Filter, route: &str) -> Result<(String, Filter), HmiError> {
    checks::validate(&filter)?;
    if filter.min.is_some() || filter.max.is_some() {
        let reason = format!("`{route}` is about all values, not a range of them");
        return Err(InquiryError::member("min, max", reason).into());
    }
    let Some(param) = filter.param.take() else {
        let reason = format!("missing: `{route}` is about one parameter");
        return Err(InquiryError::member("param", reason).into());
    };
    Ok((param, filter))
}

fn charted(
    archive: &Archive,
    mut filter: Filter,
    how: &Charting,
) -> Result<Vec<Charted>, HmiError> {
    let param = filter.param.take();
    if filter.min.is_some() || filter.max.is_some() {
        let reason = "a control chart is about all values, not a range of them";
        return Err(InquiryError::member("min, max", reason).into());
    }
    let by = (
        how.subgroup.unwrap_or(1),
        how.rules.unwrap_or(Rules::Nelson),
    );
    Ok(charts(archive, &filter, param.as_deref(), by)?)
}
