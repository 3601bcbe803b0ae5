//! The table of all routes, from which the program makes the router, the refusal of unknown members and the OpenAPI
//! document (`GET /api/openapi.json`). The types of a handler give the document its parameters, body and answer.

pub(super) mod document;
mod people;
mod plans;

use super::access::Role;
use super::answers::Answer;
use super::asked::pairs;
use super::error::ApiError;
use super::history::{self, Readers, compared, export, paper, rejudge};
use super::router::AppState;
use super::{
    approval, calibration, events, external, gauge, login, lots, metrics, mimic, orders, page,
    prompt, recipes, trace,
};
use axum::Json;
use axum::extract::{FromRef, Request};
use axum::handler::Handler;
use axum::middleware::{Next, from_fn};
use axum::routing::{MethodRouter, get, post};
use config::strict::Unreadable;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::LazyLock;
use utoipa::openapi::path::{Parameter, ParameterIn};
use utoipa::{IntoParams, ToSchema};

/// Description of a route in the OpenAPI document.
#[derive(Default)]
pub(super) struct Operation {
    pub parameters: Vec<Parameter>,
    pub body: Option<Value>,
    /// Media type and schema of the answer.
    pub answer: (&'static str, Value),
    /// Statuses of the refusals.
    pub refusals: BTreeSet<u16>,
    /// Schemas by name, to which other schemas refer.
    pub schemas: BTreeMap<String, Value>,
}

impl Operation {
    /// Keeps the schema of `T` and every schema to which it refers. Returns a reference to the schema of `T`; for a
    /// list, an optional value or any JSON, returns the schema itself.
    pub fn schema_of<T: ToSchema>(&mut self) -> Value {
        let mut named = Vec::new();
        T::schemas(&mut named);
        let (name, schema) = (T::name().into_owned(), T::schema());
        let inline = ["Option", "Value", "Vec"].contains(&name.as_str());
        let answer = match inline {
            true => json!(schema),
            false => json!({"$ref": format!("#/components/schemas/{name}")}),
        };
        named.extend((!inline).then_some((name, schema)));
        self.keep(named.into_iter().map(|(name, it)| (name, json!(it))));
        answer
    }

    /// Keeps named schemas; asserts that no name has two different schemas.
    fn keep(&mut self, named: impl IntoIterator<Item = (String, Value)>) {
        for (name, schema) in named {
            let before = self.schemas.insert(name.clone(), schema);
            let same = before.is_none_or(|it| it == self.schemas[&name]);
            assert!(same, "two schemas are named {name}");
        }
    }
}

/// Part of a request that a handler takes.
pub(super) trait Input {
    /// Describes this part in the OpenAPI document.
    fn describe(_operation: &mut Operation) {}
}

/// A handler whose argument and answer types describe its route in the OpenAPI document.
pub(super) trait Endpoint<T> {
    fn operation() -> Operation;
}

macro_rules! endpoints {
    ($($($kind:ident)*;)+) => {$(
        impl<F, Fut, Out, M, $($kind: Input),*> Endpoint<(M, $($kind,)*)> for F
        where
            F: FnOnce($($kind),*) -> Fut,
            Fut: Future<Output = Out>,
            Out: Answer,
        {
            fn operation() -> Operation {
                let mut operation = Operation::default();
                operation.refusals.insert(400);
                $($kind::describe(&mut operation);)*
                Out::describe(&mut operation);
                operation
            }
        }
    )+};
}
endpoints! { ; A; A B; A B C; A B C D; }

/// HTTP method of a route.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    Get,
    Post,
}

/// One route.
pub(super) struct Route<S = AppState> {
    pub path: Cow<'static, str>,
    pub method: Method,
    pub about: &'static str,
    pub operation: Operation,
    /// Weakest role that may use the route; `None` when the route needs no login.
    pub role: Option<Role>,
    pub handler: MethodRouter<S>,
}

/// Statuses of refusals of a route that reads the history: not found, failed, locked.
const OF_HISTORY: &[u16] = &[404, 500, 503];

impl<S: Clone + Send + Sync + 'static> Route<S> {
    fn new<T, H: Endpoint<T>>(
        path: &'static str,
        method: Method,
        about: &'static str,
        (_, handler): (&H, MethodRouter<S>),
    ) -> Self {
        let operation = H::operation();
        let known = operation.parameters.iter();
        let known = known.filter(|it| it.parameter_in == ParameterIn::Query);
        let known: Vec<String> = known.map(|it| it.name.clone()).collect();
        let strict = from_fn(move |request: Request, next: Next| {
            let checked = refuse_unknown(&request, &known);
            async move {
                checked?;
                Ok::<_, ApiError>(next.run(request).await)
            }
        });
        Self {
            path: path.into(),
            method,
            about,
            operation,
            role: None,
            handler: handler.route_layer(strict),
        }
    }

    pub fn get<T: 'static, H: Handler<T, S> + Endpoint<T>>(
        path: &'static str,
        about: &'static str,
        handler: H,
    ) -> Self {
        let routed = get(handler.clone());
        Self::new(path, Method::Get, about, (&handler, routed))
    }

    pub fn post<T: 'static, H: Handler<T, S> + Endpoint<T>>(
        path: &'static str,
        about: &'static str,
        handler: H,
    ) -> Self {
        let routed = post(handler.clone());
        Self::new(path, Method::Post, about, (&handler, routed))
    }

    /// Adds statuses of refusals to those that the types of the handler imply.
    pub fn refuses(mut self, statuses: &[u16]) -> Self {
        self.operation.refusals.extend(statuses);
        self
    }

    /// Moves the route below `prefix`; `P` describes the path parameters of `prefix`.
    pub fn below<P: IntoParams>(mut self, prefix: &str) -> Self {
        self.path = format!("{prefix}{}", self.path).into();
        let own = P::into_params(|| Some(ParameterIn::Path));
        self.operation.parameters.extend(own);
        self.operation.refusals.insert(404);
        self
    }

    fn needs(mut self, role: Role) -> Self {
        self.role = Some(role);
        self
    }
}

/// Fails on a member of the query string that the route does not take.
fn refuse_unknown(request: &Request, known: &[String]) -> Result<(), ApiError> {
    let known: Vec<&str> = known.iter().map(String::as_str).collect();
    let found = pairs(request.uri())?;
    match found
        .iter()
        .find(|(name, _)| !known.contains(&name.as_str()))
    {
        Some((name, _)) => Err(Unreadable::unknown(name, &known).into()),
        None => Ok(()),
    }
}

/// Returns all routes.
pub(super) fn routes() -> Vec<Route> {
    let mut routes = vec![
        Route::get("/", "The page, with everything that the operator needs.", page::page),
        Route::get("/page/{file}", "The script of another page; `GET /` names it.", page::script),
        Route::get("/api/view", "The whole view.", super::router::view),
        Route::get(
            "/api/events",
            "The view as server-sent events `view`: at once, on change, otherwise once a second; `beat` each second.",
            events::events,
        ),
        Route::get("/api/picture", "The picture of the prompt that waits, or null.", prompt::picture)
            .refuses(&[500]),
        Route::post("/api/login", "A session: in the cookie, and as a token.", login::log_in)
            .refuses(&[401, 429, 500]),
        Route::post("/api/logout", "Ends the session that the request brings.", login::log_out)
            .refuses(&[500]),
        Route::get("/api/me", "Name and role, or null without a session.", login::me)
            .refuses(&[500]),
        Route::post(
            "/api/orders",
            "An order to the station: taken, or 409 with the reason in English and Chinese.",
            orders::order,
        )
        .refuses(&[409])
        .needs(Role::Operator),
        Route::get("/mimic.svg", "The machine to scale, from the front and from above.", mimic::picture),
        Route::get("/api/trace", "The last traffic of every line, with its meaning.", trace::trace),
        Route::get(
            "/api/lots",
            "Lots over all their runs, latest run first, each with the orders that its state allows.",
            lots::lots,
        )
        .refuses(OF_HISTORY),
        Route::post(
            "/api/lots/external",
            "Enters a result of a lot that was measured outside of the rig; the recipe of the lot judges it.",
            external::enter,
        )
        .refuses(OF_HISTORY)
        .needs(Role::Engineer),
        Route::get("/api/wear", "Uses of each wearing part since its replacement.", lots::wear)
            .refuses(OF_HISTORY),
        Route::get(
            "/api/calibration",
            "Factors with date, uncertainty and due date; reference parts with their last readings.",
            calibration::calibration,
        )
        .refuses(OF_HISTORY),
        Route::post(
            "/api/quality/grr",
            "Gauge repeatability and reproducibility of the readings in the body; stores nothing.",
            gauge::study,
        )
        .refuses(&[500]),
        Route::get("/metrics", "Figures as Prometheus text.", metrics::metrics),
        Route::get("/api/openapi.json", "This document.", openapi),
    ];
    routes.extend(of_history());
    routes.extend(of_own_history());
    routes.extend(people::routes());
    routes.extend(plans::routes());
    routes.extend(of_recipes());
    routes
}

/// Returns the routes that read histories, of one rig or of all rigs in a database.
pub(super) fn of_history<S>() -> Vec<Route<S>>
where
    S: Clone + Send + Sync + 'static,
    Readers: FromRef<S>,
{
    let routes = [
        Route::get(
            "/api/history/list",
            "Runs of lots with their counts.",
            history::list,
        ),
        Route::get(
            "/api/history/show",
            "The part `seq` of every run, down to the raw replies.",
            history::show,
        ),
        Route::get(
            "/api/history/batches",
            "Batches of a lot, with the curves of their chamber; none for parts that were tested one by one.",
            history::batches,
        ),
        Route::get(
            "/api/history/external",
            "Results of a lot that were measured outside of the rig, and whether the lot is acceptable by them.",
            external::results,
        ),
        Route::get(
            "/api/history/query",
            "Parts that match the filter.",
            history::query,
        ),
        Route::get(
            "/api/history/count",
            "Number of parts that `query` would return.",
            history::count,
        ),
        Route::get(
            "/api/history/yield",
            "Counts of the verdicts of all parts of lots in the span.",
            history::yields,
        ),
        Route::get(
            "/api/history/stats",
            "Statistics of one parameter.",
            history::stats,
        ),
        Route::get(
            "/api/history/histogram",
            "Counts in classes of equal width.",
            history::histogram,
        ),
        Route::get(
            "/api/history/spc",
            "Control charts of a parameter; without one, of the share of each bin.",
            history::spc,
        ),
        Route::get(
            "/api/history/alarms",
            "Alarms in order of time.",
            history::alarms,
        ),
        Route::get(
            "/api/history/rejects",
            "Reasons of rejects, the most frequent first.",
            compared::reasons,
        ),
        Route::get(
            "/api/history/alarm-counts",
            "Alarms by code, the most frequent first.",
            compared::alarm_counts,
        ),
        Route::get(
            "/api/history/compare",
            "One parameter of several lots: figures, tests of equality, shares in common classes.",
            compared::lots,
        ),
        Route::get(
            "/api/history/report/comparison",
            "Lots side by side for A4.",
            compared::printed,
        ),
        Route::get(
            "/api/history/report/lot",
            "Report of a lot for A4.",
            paper::lot,
        ),
        Route::get(
            "/api/history/report/certificate",
            "Certificate of a part for A4.",
            paper::certificate,
        ),
        Route::get(
            "/api/history/report/chart",
            "Control charts for A4.",
            paper::chart,
        ),
        Route::get(
            "/api/history/report/alarms",
            "List of alarms for A4.",
            paper::alarms,
        ),
        Route::get(
            "/api/history/export.csv",
            "Parts as CSV with byte order mark.",
            export::csv,
        ),
        Route::get(
            "/api/history/export.xlsx",
            "Parts as a spreadsheet with charts, 100,000 at most.",
            export::xlsx,
        ),
    ];
    routes
        .into_iter()
        .map(|it| it.refuses(OF_HISTORY))
        .collect()
}

/// Returns the routes of the history that also need the recipes or the people of the rig.
fn of_own_history() -> Vec<Route> {
    let routes = [
        Route::get(
            "/api/history/rejudge",
            "The verdict of every part of the lot by another recipe, then a summary; writes nothing.",
            rejudge::rejudge,
        ),
        Route::get(
            "/api/history/orders",
            "The audit of orders: person, order and outcome, in order of time. Logins and changes of people are for \
             engineers.",
            history::orders,
        )
        .refuses(&[401, 403]),
    ];
    routes
        .into_iter()
        .map(|it| it.refuses(OF_HISTORY))
        .collect()
}

fn of_recipes() -> Vec<Route> {
    vec![
        Route::get(
            "/api/recipes",
            "Every recipe with its newest revision, or the error that keeps it from loading.",
            recipes::list,
        )
        .refuses(&[500, 503]),
        Route::get(
            "/api/recipes/show",
            "A revision: every key with form, unit, range and value.",
            recipes::show,
        )
        .refuses(OF_HISTORY),
        Route::get(
            "/api/recipes/revisions",
            "Who changed the recipe, when, why, and every key with its old and new value; latest first.",
            recipes::revisions,
        )
        .refuses(OF_HISTORY),
        Route::get("/api/recipes/card", "Operation process card for A4.", recipes::card)
            .refuses(&[404, 500]),
        Route::post(
            "/api/recipes/revise",
            "Saves the next revision of a recipe, which applies from the next run on, or with `save_as` a new recipe; 400 with \
             `key`, `found`, `expected` and `requirement` for a refused value, 409 when another revision came first or the \
             name is taken.",
            recipes::revise,
        )
        .refuses(&[404, 409, 503])
        .needs(Role::Engineer),
        Route::post(
            "/api/recipes/approve",
            "Approves the newest revision of a recipe; 409 for an engineer who saved or approved it, and when another \
             revision came first.",
            approval::approve,
        )
        .refuses(&[404, 409, 503])
        .needs(Role::Engineer),
    ]
}

static DOCUMENT: LazyLock<Value> = LazyLock::new(|| document::of(routes()));

/// Returns the OpenAPI document.
#[cfg(test)]
pub(super) fn document() -> Value {
    DOCUMENT.clone()
}

async fn openapi() -> Json<Value> {
    Json(DOCUMENT.clone())
}
