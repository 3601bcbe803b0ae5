//! `/api/history/...`: the command `history` over HTTP, with its filter in the query string.
//!
//! The filter is [`Filter`]: `lot`, `run`, `recipe`, `since`, `until` (RFC 3339), `verdict`, `bin`, `kind`
//! (`lot` when absent, `golden`, `all`), `suspect`, `param`, `min`, `max`, and the page of a long answer: `limit`,
//! `offset`.
//!
//! | route | members of the filter | others | answer |
//! |---|---|---|---|
//! | `list` | `lot`, `run`, `recipe` | | array of runs with their counts |
//! | `show` | `lot`, `run`, `kind` | `seq` | array with the part `seq` of every run, down to the raw replies |
//! | `query` | all | | array of parts, streamed because it may be long |
//! | `count` | all but the page | | `{"parts": n}`: parts that `query` would return |
//! | `yield` | `since`, `until` | | counts of the verdicts of all parts of lots in the span |
//! | `stats` | `param` and all but `min`, `max` | | one object, as `history stats --json` |
//! | `histogram` | the same | | `{"from", "width", "counts", "low", "high"}`; `low` and `high` only where all runs have the same |
//! | `spc` | the same; without `param` charts of the share of every bin | `subgroup`, `rules`, `last` | array of control charts |
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
//! `lang` is `zh` (when absent) or `en`. A route refuses a member that it does not use: 400 with the name. An unknown
//! lot, run or part is 404. A few readers at a time work on blocking threads; they do not delay the writer.

pub(super) mod export;
mod feed;
pub(super) mod members;
pub(super) mod paper;
mod readers;
pub(super) mod rejudge;

use super::error::{ApiError, JsonResult, Members, blocking};
use super::router::App;
use axum::Json;
use axum::extract::{Query, State};
use axum::http::Uri;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use history::inquiry::charts::{Charted, charts};
use history::inquiry::figures::{self, Classes};
use history::inquiry::{InquiryError, checks};
use history::{Alarm, Archive, Filter, LotSummary, Moment, OrderEntry, Part, Yield};
use members::{AuditMembers, ChartMembers, split};
use quality::Summary;
use quality::rules::Rules;
pub(super) use readers::Readers;
use serde::Deserialize;
use serde_json::{Value, json};

/// Members of the filter that the lists of alarms and orders take.
const OF_ALARMS: &[&str] = &["lot", "run", "recipe", "since", "until", "limit", "offset"];

/// `GET /api/history/query`.
pub(super) async fn query(State(app): App, filter: Members<Filter>) -> Result<Response, ApiError> {
    let Query(filter) = filter?;
    checks::validate(&filter)?;
    let (archive, place) = app.readers.open().await?;
    let param = filter.param.clone();
    let known = move || checks::parameters(&archive, param.as_deref()).map(|_| archive);
    let archive = blocking(known).await?;
    let parts = feed::streamed((archive, place), move |archive, out| {
        feed::parts(archive, &filter, out)
    });
    Ok(([(CONTENT_TYPE, "application/json")], parts).into_response())
}

/// `GET /api/history/count`.
pub(super) async fn count(State(app): App, filter: Members<Filter>) -> JsonResult<Value> {
    let Query(filter) = filter?;
    checks::validate(&filter)?;
    if filter.limit.is_some() || filter.offset.is_some() {
        return Err(InquiryError::member("limit, offset", "`count` is about all pages").into());
    }
    let read = move |archive: &Archive| {
        checks::parameters(archive, filter.param.as_deref())?;
        Ok(json!({"parts": archive.count_parts(&filter)?}))
    };
    app.readers.read(read).await.map(Json)
}

/// `GET /api/history/list`.
pub(super) async fn list(State(app): App, filter: Members<Filter>) -> JsonResult<Vec<LotSummary>> {
    let Query(filter) = filter?;
    checks::only(&filter, "list", &["lot", "run", "recipe"])?;
    let read = move |archive: &Archive| Ok(archive.lots(&filter)?);
    app.readers.read(read).await.map(Json)
}

/// `GET /api/history/yield`.
pub(super) async fn yields(State(app): App, filter: Members<Filter>) -> JsonResult<Yield> {
    let Query(filter) = filter?;
    checks::only(&filter, "yield", &["since", "until"])?;
    let since = filter.since.unwrap_or(Moment(i64::MIN));
    let until = filter.until.unwrap_or(Moment(i64::MAX));
    let read = move |archive: &Archive| Ok(archive.yield_between(since, until)?);
    app.readers.read(read).await.map(Json)
}

/// Members of `show`, which select one part.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PartQuery {
    lot: String,
    seq: u64,
    /// Number of the run; all runs when absent.
    run: Option<u32>,
    /// `lot` (when absent) or `golden`.
    kind: Option<String>,
}

/// `GET /api/history/show`.
pub(super) async fn show(State(app): App, which: Members<PartQuery>) -> JsonResult<Vec<Part>> {
    let Query(PartQuery {
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
            return Err(InquiryError::missing(what).into());
        }
        Ok(parts)
    };
    app.readers.read(read).await.map(Json)
}

/// `GET /api/history/stats`.
pub(super) async fn stats(State(app): App, filter: Members<Filter>) -> JsonResult<Summary> {
    let (param, filter) = of_one_parameter(filter?.0, "stats")?;
    let read =
        move |archive: &Archive| Ok(figures::figures(archive, &param, &filter, None)?.summary);
    app.readers.read(read).await.map(Json)
}

/// `GET /api/history/histogram`.
pub(super) async fn histogram(State(app): App, filter: Members<Filter>) -> JsonResult<Classes> {
    let (param, filter) = of_one_parameter(filter?.0, "histogram")?;
    let read = move |archive: &Archive| Ok(figures::histogram(archive, &param, &filter)?);
    app.readers.read(read).await.map(Json)
}

/// `GET /api/history/spc`.
pub(super) async fn spc(State(app): App, uri: Uri) -> JsonResult<Vec<Charted>> {
    let (filter, how) = split::<ChartMembers>(&uri)?;
    checks::validate(&filter)?;
    if how.lang.is_some() {
        return Err(InquiryError::member("lang", "`spc` has no words, `report/chart` has").into());
    }
    let last = how.last()?;
    let read = move |archive: &Archive| {
        let charts = charted(archive, filter, &how)?;
        Ok(charts.into_iter().map(|it| it.last(last)).collect())
    };
    app.readers.read(read).await.map(Json)
}

/// `GET /api/history/alarms`.
pub(super) async fn alarms(State(app): App, filter: Members<Filter>) -> JsonResult<Vec<Alarm>> {
    let Query(filter) = filter?;
    checks::only(&filter, "alarms", OF_ALARMS)?;
    let read = move |archive: &Archive| Ok(archive.alarms(&filter)?);
    app.readers.read(read).await.map(Json)
}

/// `GET /api/history/orders`.
pub(super) async fn orders(State(app): App, uri: Uri) -> JsonResult<Vec<OrderEntry>> {
    let (filter, AuditMembers { who }) = split(&uri)?;
    checks::only(&filter, "orders", OF_ALARMS)?;
    let read = move |archive: &Archive| Ok(archive.orders(&filter, who.as_deref())?);
    app.readers.read(read).await.map(Json)
}

fn of_one_parameter(mut filter: Filter, route: &str) -> Result<(String, Filter), ApiError> {
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
    how: &ChartMembers,
) -> Result<Vec<Charted>, ApiError> {
    let param = filter.param.take();
    if filter.min.is_some() || filter.max.is_some() {
        let reason = "a control chart is about all values, not a range of them";
        return Err(InquiryError::member("min, max", reason).into());
    }
    let rules = how.rules.unwrap_or(Rules::Nelson);
    let by = (how.subgroup.unwrap_or(1), rules);
    Ok(charts(archive, &filter, param.as_deref(), by)?)
}
