//! The list of all routes. Both the router and the OpenAPI document (`GET /api/openapi.json`) are made from it, so that
//! the document is complete.

mod document;
mod history;
mod recipes;

use super::access::Role;
use super::router::AppState;
use super::{calibration, events, login, lots, metrics, mimic, orders, page, trace};
use axum::Json;
use axum::handler::Handler;
use axum::routing::{MethodRouter, get, post};
use std::sync::LazyLock;

const JSON: &str = "application/json";
const HTML: &str = "text/html";

/// HTTP method of a route.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    Get,
    Post,
}

/// A member of a query string or of a body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Member {
    pub name: &'static str,
    /// Meaning with unit, range and default.
    pub about: &'static str,
    pub required: bool,
}

/// One route.
#[derive(Debug)]
pub(super) struct Route {
    pub path: &'static str,
    pub method: Method,
    pub about: &'static str,
    /// Media type of the answer.
    pub gives: &'static str,
    /// Members of the query string, or of the JSON body of a `POST`.
    pub members: Vec<Member>,
    /// Weakest role that may use the route; `None` when it needs no login.
    pub role: Option<Role>,
    pub handler: MethodRouter<AppState>,
}

const fn may(name: &'static str, about: &'static str) -> Member {
    Member {
        name,
        about,
        required: false,
    }
}

const fn must(name: &'static str, about: &'static str) -> Member {
    Member {
        name,
        about,
        required: true,
    }
}

impl Route {
    fn get<T: 'static>(
        path: &'static str,
        gives: &'static str,
        about: &'static str,
        handler: impl Handler<T, AppState>,
    ) -> Self {
        Self {
            path,
            method: Method::Get,
            about,
            gives,
            members: Vec::new(),
            role: None,
            handler: get(handler),
        }
    }

    fn post<T: 'static>(
        path: &'static str,
        about: &'static str,
        handler: impl Handler<T, AppState>,
    ) -> Self {
        Self {
            method: Method::Post,
            handler: post(handler),
            ..Self::get(path, JSON, about, || async {})
        }
    }

    fn with(mut self, members: &[Member]) -> Self {
        self.members.extend_from_slice(members);
        self
    }

    fn needs(mut self, role: Role) -> Self {
        self.role = Some(role);
        self
    }
}

/// Returns all routes.
pub(super) fn routes() -> Vec<Route> {
    let mut routes = vec![
        Route::get("/", HTML, "The page, with everything that the operator needs.", page::page),
        Route::get(
            "/page/{file}",
            "text/javascript",
            "The script of another page; `GET /` names it.",
            page::script,
        )
        .with(&[must("file", "Name with a hash of the script.")]),
        Route::get("/api/view", JSON, "The whole view.", super::router::view),
        Route::get(
            "/api/events",
            "text/event-stream",
            "The view as server-sent events `view`: at once, on change, otherwise once a second; `beat` each second.",
            events::events,
        ),
        Route::post(
            "/api/login",
            "A session: in the cookie, and as a token.",
            login::log_in,
        )
        .with(&[must("user", "As added by `relayrig user`."), must("password", "")]),
        Route::post("/api/logout", "Ends the session that the request brings.", login::log_out),
        Route::get("/api/me", JSON, "Name and role, or null without a session.", login::me),
        Route::post(
            "/api/orders",
            "An order to the station: taken, or 409 with the reason in English and Chinese. `mode`, `jog`, `step`, \
             `shelve`, `release_lot` and `replaced` take a maintainer, `reopen_lot` an engineer.",
            orders::order,
        )
        .with(&ORDER)
        .needs(Role::Operator),
        Route::get(
            "/mimic.svg",
            "image/svg+xml",
            "The machine to scale, from the front and from above.",
            mimic::picture,
        ),
        Route::get(
            "/api/trace",
            JSON,
            "The last traffic of every line, with its meaning.",
            trace::trace,
        )
        .with(&[may("last", "Messages of each line, 1 to 1000; 100 without it.")]),
        Route::get(
            "/api/lots",
            JSON,
            "Lots over all their runs, latest run first, each with the orders that its state allows.",
            lots::lots,
        )
        .with(&[
            may("limit", "Most lots of the answer, 1 to 200; 20 without it."),
            may("offset", "Number of lots to skip."),
        ]),
        Route::get("/api/wear", JSON, "Uses of each wearing part since its replacement.", lots::wear),
        Route::get(
            "/api/calibration",
            JSON,
            "Factors with date, uncertainty and due date; reference parts with their last readings.",
            calibration::calibration,
        ),
        Route::get("/metrics", "text/plain", "Figures as Prometheus text.", metrics::metrics),
        Route::get("/api/openapi.json", JSON, "This document.", openapi),
    ];
    routes.extend(history::routes());
    routes.extend(recipes::routes());
    routes
}

/// Members of the body of an order.
const ORDER: [Member; 11] = [
    must(
        "order",
        "`start`, `stop`, `hold` and the others that a refusal lists.",
    ),
    may("mode", "Of `mode`: `production`, `maintenance`, `manual`."),
    may(
        "motion",
        "Of `jog`: `pusher_extend` and the others that a refusal lists.",
    ),
    may(
        "alarm",
        "Of `acknowledge` (all without it) and `shelve`: code of the alarm.",
    ),
    may("minutes", "Of `shelve`: 1 to 480; 30 without it."),
    may("reason", "Reason of `shelve`, `hold_lot` and `reopen_lot`."),
    may(
        "lot",
        "Of `start` (without it the lot under way continues), `hold_lot`, `release_lot`, `close_lot`, `reopen_lot`: name of the lot.",
    ),
    may("recipe", "Of `start` with a lot: name of its recipe."),
    may(
        "count",
        "Of `start` with a lot: number of parts; without it the lot continues until it is ended.",
    ),
    may(
        "retest",
        "Of `start` with a lot that is tested again: name of the person who agreed.",
    ),
    may(
        "counter",
        "Of `replaced`: the counter to reset, `probe_touches` or `jaw_closings`.",
    ),
];

static DOCUMENT: LazyLock<serde_json::Value> = LazyLock::new(|| document::of(&routes()));

async fn openapi() -> Json<serde_json::Value> {
    Json(DOCUMENT.clone())
}
