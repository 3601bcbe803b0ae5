//! `/api/plans/...`: plans by which people take tooling off and put it on.
//!
//! Reading or previewing a plan needs no login. A maintainer starts a plan, ticks off its steps, takes back the last
//! tick, and abandons the plan; the audit of orders records every attempt of a logged-in person. The server makes one
//! plan at a time, on a thread that never drives the rig, and answers within [`LIMIT`].

mod shown;

pub use shown::{ListedScene, PlanAnswer, PlanFault, PlanMaker, PlanQuestion};
pub(super) use shown::{ShownPlan, StartedView};

use super::access::{Role, audited};
use super::asked::{Asked, Author, Body, members};
use super::error::{ApiError, JsonResult, blocking};
use super::history::members::Printed;
use super::history::paper::{Page, with_policy};
use super::language::Preferred;
use super::router::{App, AppState};
use super::sessions::{now_us, require_role};
use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use history::inquiry::paper::paper;
use history::report::plan::started_sheet;
use history::tooling::{Actor, PlanEntry, PlanKind, PlanRefusal, StartedPlan, ToolingPlan};
use history::{Archive, Store};
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;
use texts::Message;
use tokio::time::timeout;
use utoipa::{IntoParams, ToSchema};

/// Longest time for which a client waits for a plan.
pub(super) const LIMIT: Duration = Duration::from_secs(15);

/// Default of `limit` of the list.
const SHOWN: u32 = 20;
/// Greatest `limit` of the list.
const MOST: u32 = 200;

/// `GET /api/plans/scenes`.
pub(super) async fn scenes(State(app): App) -> JsonResult<Vec<ListedScene>> {
    let plans = Arc::clone(&app.shared.plans);
    blocking(move || plans.scenes().map(Json).map_err(refused)).await
}

#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct ListQuery {
    /// Largest number of plans in the answer, 1 to 200; 20 when absent.
    #[param(minimum = 1, maximum = 200, example = 20)]
    limit: Option<u32>,
}

#[derive(Debug, Deserialize, IntoParams)]
pub(super) struct PlanQuery {
    /// Number of the plan.
    #[param(example = 1)]
    plan: i64,
}

members!(ListQuery, PlanQuery);

/// `GET /api/plans/list`.
pub(super) async fn list(
    State(app): App,
    Asked(ListQuery { limit }): Asked<ListQuery>,
) -> JsonResult<Vec<PlanEntry>> {
    let limit = ApiError::ranged("limit", limit, SHOWN, MOST)?;
    let read = move |archive: &Archive| Ok(archive.plans(limit)?);
    app.readers.read(read).await.map(Json)
}

/// `GET /api/plans/show`.
pub(super) async fn show(
    State(app): App,
    Asked(PlanQuery { plan }): Asked<PlanQuery>,
) -> JsonResult<StartedView> {
    let read = move |archive: &Archive| found(archive, plan).map(|it| Json(it.into()));
    app.readers.read(read).await
}

/// `GET /api/plans/paper`.
pub(super) async fn print(
    State(app): App,
    preferred: Preferred,
    Asked((PlanQuery { plan }, printed)): Asked<(PlanQuery, Printed)>,
) -> Result<Page, ApiError> {
    let made = move |archive: &Archive| {
        let on = paper(preferred.unless(printed.lang));
        Ok(with_policy(started_sheet(&on, &found(archive, plan)?)))
    };
    app.readers.read(made).await
}

fn found(archive: &Archive, plan: i64) -> Result<StartedPlan, ApiError> {
    let missing = || refusal(PlanRefusal::Unknown { plan });
    archive.plan(plan)?.ok_or_else(missing)
}

/// `POST /api/plans/preview`.
pub(super) async fn preview(
    State(app): App,
    Body(question): Body<PlanQuestion>,
) -> JsonResult<ShownPlan> {
    let plan = made(&app, question).await?;
    Ok(Json(ShownPlan::new(&plan, &[])))
}

/// `POST /api/plans/start`.
pub(super) async fn start(
    State(app): App,
    author: Author,
    Body(question): Body<PlanQuestion>,
) -> JsonResult<StartedView> {
    let what = json!({ "order": "plan_start", "kind": question.kind.word(), "scene": question.scene,
        "to": question.to, "remove": question.remove, "forbid": question.forbid });
    let allowed = require_role(&author.person, Role::Maintainer);
    let plan = match allowed {
        Ok(()) => made(&app, question).await,
        Err(refused) => Err(refused),
    };
    changed(app, author, what, move |db, by| {
        let plan = plan?;
        Store::open(db)?.start_plan(&plan, by)?.map_err(refusal)
    })
    .await
}

/// Body that names a step of a plan under way.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Tick {
    /// Number of the plan.
    #[schema(example = 1)]
    plan: i64,
    /// Number of the step, from 1: to tick off, the next step; to take back a tick, the last step done.
    #[schema(example = 1)]
    step: usize,
}

/// `POST /api/plans/tick`.
pub(super) async fn tick(
    State(app): App,
    author: Author,
    Body(Tick { plan, step }): Body<Tick>,
) -> JsonResult<StartedView> {
    let what = json!({ "order": "plan_step", "plan": plan, "step": step });
    let allowed = require_role(&author.person, Role::Maintainer);
    changed(app, author, what, move |db, by| {
        allowed?;
        let ticked = Store::open(db)?.tick_step(plan, step, by)?;
        ticked.map(|()| plan).map_err(refusal)
    })
    .await
}

/// `POST /api/plans/untick`.
pub(super) async fn untick(
    State(app): App,
    author: Author,
    Body(Tick { plan, step }): Body<Tick>,
) -> JsonResult<StartedView> {
    let what = json!({ "order": "plan_step_back", "plan": plan, "step": step });
    let allowed = require_role(&author.person, Role::Maintainer);
    changed(app, author, what, move |db, _| {
        allowed?;
        let unticked = Store::open(db)?.untick_step(plan, step)?;
        unticked.map(|()| plan).map_err(refusal)
    })
    .await
}

/// Request to end a plan whose steps are not all done.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct Abandon {
    /// Number of the plan.
    #[schema(example = 1)]
    plan: i64,
    /// Reason, not empty.
    #[schema(example = "wrong nest")]
    reason: String,
}

/// `POST /api/plans/abandon`.
pub(super) async fn abandon(
    State(app): App,
    author: Author,
    Body(Abandon { plan, reason }): Body<Abandon>,
) -> JsonResult<StartedView> {
    let what = json!({ "order": "plan_abandon", "plan": plan, "reason": reason });
    let allowed = require_role(&author.person, Role::Maintainer);
    changed(app, author, what, move |db, by| {
        allowed?;
        let ended = Store::open(db)?.abandon_plan(plan, &reason, by)?;
        ended.map(|()| plan).map_err(refusal)
    })
    .await
}

/// Makes a plan on a thread of its own; refuses while another plan is being made.
async fn made(app: &AppState, question: PlanQuestion) -> Result<Box<ToolingPlan>, ApiError> {
    if question.kind == PlanKind::Disassembly && question.remove.is_empty() {
        return Err(bad(Message::new("refusal", "plan_without_elements")));
    }
    let Ok(place) = Arc::clone(&app.planning).try_acquire_owned() else {
        return Err(busy(Message::new("refusal", "plan_busy")));
    };
    let plans = Arc::clone(&app.shared.plans);
    // Only the end of this work allows the next plan, even if the client has gone before.
    let work = blocking(move || {
        let answer = plans.make(&question).map_err(refused);
        drop(place);
        answer
    });
    let too_long =
        |_| busy(Message::new("refusal", "plan_too_long").with("limit_s", LIMIT.as_secs()));
    match timeout(LIMIT, work).await.map_err(too_long)?? {
        PlanAnswer::Plan(plan) if plan.steps.is_empty() => {
            Err(conflict(Message::new("refusal", "plan_empty")))
        }
        PlanAnswer::Plan(plan) => Ok(plan),
        PlanAnswer::Locked(elements) => {
            let elements = elements.join(", ");
            let why = Message::new("refusal", "plan_locked").with("elements", elements);
            Err(conflict(why))
        }
    }
}

/// Changes a plan, records the attempt in the audit of orders, and returns the changed plan.
async fn changed(
    app: AppState,
    author: Author,
    what: Value,
    change: impl FnOnce(&Path, &Actor) -> Result<i64, ApiError> + Send + 'static,
) -> JsonResult<StartedView> {
    let db = app.shared.db.clone();
    let plan = blocking(move || {
        let by = Actor {
            who: author.person.name.clone(),
            role: author.person.role.to_string(),
            at_us: now_us(),
        };
        let work = || change(&db, &by);
        let done = audited(&db, author.by(), |_| what, ApiError::message, work);
        done.map_err(ApiError::from)?
    });
    let plan = plan.await?;
    let read = move |archive: &Archive| found(archive, plan).map(|it| Json(it.into()));
    app.readers.read(read).await
}

fn refusal(found: PlanRefusal) -> ApiError {
    let status = match found {
        PlanRefusal::Unknown { .. } => StatusCode::NOT_FOUND,
        PlanRefusal::NoReason => StatusCode::BAD_REQUEST,
        PlanRefusal::UnderWay { .. }
        | PlanRefusal::Ended { .. }
        | PlanRefusal::NotNext { .. }
        | PlanRefusal::NotLast { .. } => StatusCode::CONFLICT,
    };
    let why = found.message();
    ApiError::Plan { status, why }
}

fn refused(said: PlanFault) -> ApiError {
    bad(Message::new("refusal", "plan_refused").with("said", said))
}

fn bad(why: Message) -> ApiError {
    let status = StatusCode::BAD_REQUEST;
    ApiError::Plan { status, why }
}

fn conflict(why: Message) -> ApiError {
    let status = StatusCode::CONFLICT;
    ApiError::Plan { status, why }
}

fn busy(why: Message) -> ApiError {
    let status = StatusCode::SERVICE_UNAVAILABLE;
    ApiError::Plan { status, why }
}
