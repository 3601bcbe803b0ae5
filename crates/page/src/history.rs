//! `/api/history/...`: the command `history` over HTTP, with its filter in the query string.
//!
//! `api.rs` lists the routes and their members; `members.rs` has the parts of the query strings.
//!
//! `lang` is `zh` or `en`; when absent, the header `Accept-Language` decides, and without that header the language is
//! English. A route answers 400 to a member that it does not use, with the name of the member, and 404 when it needs a
//! lot, run or part that does not exist. At most four readers at a time work on blocking threads; they do not delay the
//! writer.

pub(super) mod compared;
pub(super) mod export;
mod feed;
pub(super) mod members;
pub(super) mod paper;
mod readers;
pub(super) mod rejudge;

use super::access::Role;
use super::answers::{As, Stream};
use super::asked::{Asked, members as asked_members};
use super::error::{ApiError, JsonResult, blocking};
use super::sessions::{Sessions, require_role};
use axum::Json;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use history::inquiry::charts::{Charted, charts};
use history::inquiry::figures::{self, Classes};
use history::inquiry::{InquiryError, checks};
use history::{
    Alarm, Archive, Batch, Filter, LotSummary, Moment, OrderChoice, OrderEntry, Part, Yield,
};
use members::{
    Charting, OfParts, OneLot, OneParameter, Paging, Runs, TimeSpan, ValueRange, filter,
};
use quality::Summary;
use quality::rules::Rules;
pub(super) use readers::Readers;
pub use readers::{Archives, RigName};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// Members that select parts.
pub(super) type Filtered = (Runs, TimeSpan, OfParts, ValueRange, Paging);

/// `GET /api/history/query`.
pub(super) async fn query(
    readers: Readers,
    Asked(asked): Asked<Filtered>,
) -> Result<As<Stream<Part>>, ApiError> {
    let filter = filter(asked);
    checks::validate(&filter)?;
    let (archive, place) = readers.open().await?;
    let param = filter.param.clone();
    let known = move || checks::parameters(&archive, param.as_deref()).map(|_| archive);
    let archive = blocking(known).await?;
    let parts = feed::streamed((archive, place), move |archive, out| {
        feed::parts(archive, &filter, out)
    });
    Ok(json_stream(parts))
}

/// Returns the answer whose `body` is a streamed JSON array.
fn json_stream<T>(body: axum::body::Body) -> As<Stream<T>> {
    As::new(([(CONTENT_TYPE, "application/json")], body).into_response())
}

/// Number of parts that a filter selects.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Count {
    parts: u64,
}

/// `GET /api/history/count`.
pub(super) async fn count(
    readers: Readers,
    Asked(asked): Asked<(Runs, TimeSpan, OfParts, ValueRange)>,
) -> JsonResult<Count> {
    let filter = filter(asked);
    checks::validate(&filter)?;
    let read = move |archive: &Archive| {
        checks::parameters(archive, filter.param.as_deref())?;
        let parts = archive.count_parts(&filter)?;
        Ok(Count { parts })
    };
    readers.read(read).await.map(Json)
}

/// `GET /api/history/list`.
pub(super) async fn list(
    readers: Readers,
    Asked((runs, opened)): Asked<(Runs, OpenedQuery)>,
) -> JsonResult<Vec<LotSummary>> {
    let read = move |archive: &Archive| Ok(archive.lots_since(&filter(runs), opened.since)?);
    readers.read(read).await.map(Json)
}

/// `GET /api/history/batches`.
pub(super) async fn batches(readers: Readers, Asked(lot): Asked<OneLot>) -> JsonResult<Vec<Batch>> {
    let filter = filter(lot);
    let read = move |archive: &Archive| {
        checks::known_runs(archive, &filter)?;
        Ok(archive.batches(&filter)?)
    };
    readers.read(read).await.map(Json)
}

/// `GET /api/history/yield`.
pub(super) async fn yields(readers: Readers, Asked(span): Asked<TimeSpan>) -> JsonResult<Yield> {
    let since = span.since.unwrap_or(Moment(i64::MIN));
    let until = span.until.unwrap_or(Moment(i64::MAX));
    let read = move |archive: &Archive| Ok(archive.yield_between(since, until)?);
    readers.read(read).await.map(Json)
}

/// Member that `list` takes besides [`Runs`].
#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct OpenedQuery {
    /// Only runs that began at this time or later: RFC 3339, or local as `2026-11-22`, `today`, `-8h`.
    #[param(value_type = Option<String>, example = "2026-11-22T00:00:00Z")]
    since: Option<Moment>,
}

/// Members of `show`, which select one part.
#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct PartQuery {
    /// Name of the lot.
    #[param(example = "L-1122")]
    lot: String,
    /// Number of the part.
    #[param(example = 1)]
    seq: u64,
    /// Number of the run; all runs when absent.
    #[param(example = 1)]
    run: Option<u32>,
    /// `lot` (when absent) or `golden`.
    #[param(example = "lot")]
    kind: Option<String>,
}

/// Members that `orders` takes besides the filter.
#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct AuditQuery {
    /// Name at login; all people when absent.
    #[param(example = "li")]
    who: Option<String>,
    /// Name of the order, as in `POST /api/orders`; all orders when absent.
    #[param(example = "start")]
    order: Option<String>,
}

asked_members!(OpenedQuery, PartQuery, AuditQuery);

/// `GET /api/history/show`.
pub(super) async fn show(
    readers: Readers,
    Asked(which): Asked<PartQuery>,
) -> JsonResult<Vec<Part>> {
    let PartQuery {
        lot,
        seq,
        run,
        kind,
    } = which;
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
    readers.read(read).await.map(Json)
}

/// `GET /api/history/stats`.
pub(super) async fn stats(
    readers: Readers,
    Asked((asked, of)): Asked<((Runs, TimeSpan, OfParts), OneParameter)>,
) -> JsonResult<Summary> {
    let filter = filter(asked);
    checks::validate(&filter)?;
    let read =
        move |archive: &Archive| Ok(figures::figures(archive, &of.param, &filter, None)?.summary);
    readers.read(read).await.map(Json)
}

/// `GET /api/history/histogram`.
pub(super) async fn histogram(
    readers: Readers,
    Asked((asked, of)): Asked<((Runs, TimeSpan, OfParts), OneParameter)>,
) -> JsonResult<Classes> {
    let filter = filter(asked);
    checks::validate(&filter)?;
    let read = move |archive: &Archive| Ok(figures::histogram(archive, &of.param, &filter)?);
    readers.read(read).await.map(Json)
}

/// `GET /api/history/spc`.
pub(super) async fn spc(
    readers: Readers,
    Asked((asked, how)): Asked<((Runs, TimeSpan, OfParts), Charting)>,
) -> JsonResult<Vec<Charted>> {
    let filter = filter(asked);
    checks::validate(&filter)?;
    let last = how.last()?;
    let read = move |archive: &Archive| {
        let charts = charted(archive, &filter, &how)?;
        Ok(charts.into_iter().map(|it| it.last(last)).collect())
    };
    readers.read(read).await.map(Json)
}

/// `GET /api/history/alarms`.
pub(super) async fn alarms(
    readers: Readers,
    Asked(asked): Asked<(Runs, TimeSpan, Paging)>,
) -> JsonResult<Vec<Alarm>> {
    let read = move |archive: &Archive| Ok(archive.alarms(&filter(asked))?);
    readers.read(read).await.map(Json)
}

/// `GET /api/history/orders`. Logins and changes of people are for engineers.
pub(super) async fn orders(
    readers: Readers,
    State(sessions): State<Sessions>,
    headers: HeaderMap,
    Asked((asked, AuditQuery { who, order })): Asked<((Runs, TimeSpan, Paging), AuditQuery)>,
) -> JsonResult<Vec<OrderEntry>> {
    let reader = sessions.who(&headers).await?;
    let of_people = |order: &str| OrderChoice::OF_PEOPLE.contains(&order);
    if order.as_deref().is_some_and(of_people) {
        let reader = reader.as_ref().ok_or(ApiError::NotLoggedIn)?;
        require_role(reader, Role::Engineer)?;
    }
    let is_engineer = reader.is_some_and(|it| it.role >= Role::Engineer);
    let choice = OrderChoice {
        who,
        order,
        without_people: !is_engineer,
    };
    let read = move |archive: &Archive| Ok(archive.orders(&filter(asked), &choice)?);
    readers.read(read).await.map(Json)
}

fn charted(archive: &Archive, filter: &Filter, how: &Charting) -> Result<Vec<Charted>, ApiError> {
    let rules = how.rules.unwrap_or(Rules::Nelson);
    let by = (how.subgroup.unwrap_or(1), rules);
    Ok(charts(archive, filter, how.param.as_deref(), by)?)
}
