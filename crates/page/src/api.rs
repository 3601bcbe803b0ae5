//! Everything that may be asked of the screen's interface, as one list: the router is made of it, and so is the OpenAPI
//! document (`GET /api/openapi.json`). A route that is not in the list does not exist; one that is cannot be forgotten in
//! the document.

mod document;
mod history;
mod recipes;

use super::access::Role;
use super::router::Desk;
use super::{calibration, events, login, lots, metrics, mimic, orders, page, trace};
use axum::Json;
use axum::handler::Handler;
use axum::routing::{MethodRouter, get, post};
use std::sync::LazyLock;

const JSON: &str = "application/json";
const HTML: &str = "text/html";

/// The method of a route; a route has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    Get,
    Post,
}

/// A member of a query string or of a body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Member {
    pub name: &'static str,
    /// Unit, range, meaning.
    pub about: &'static str,
    pub required: bool,
}

/// One route.
#[derive(Debug)]
pub(super) struct Offer {
    pub path: &'static str,
    pub method: Method,
    pub about: &'static str,
    /// Media type of the answer.
    pub gives: &'static str,
    /// Of the query string, or of the JSON body of a `POST`.
    pub members: Vec<Member>,
    /// Weakest role that may ask; `None`: anybody.
    pub role: Option<Role>,
    pub handler: MethodRouter<Desk>,
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

impl Offer {
    fn get<T: 'static>(
        path: &'static str,
        gives: &'static str,
        about: &'static str,
        handler: impl Handler<T, Desk>,
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
        handler: impl Handler<T, Desk>,
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

/// All of them.
pub(super) fn offers() -> Vec<Offer> {
    let mut offers = vec![
        Offer::get("/", HTML, "The page, with everything that the operator needs.", page::page),
        Offer::get(
            "/page/{file}",
            "text/javascript",
            "The script of another page; `GET /` names it.",
            page::script,
        )
        .with(&[must("file", "Name with a hash of the script.")]),
        Offer::get("/api/view", JSON, "The whole view.", super::router::view),
        Offer::get(
            "/api/events",
            "text/event-stream",
            "The view as server-sent events `view`: at once, then on change; `beat` each second.",
            events::events,
        ),
        Offer::post(
            "/api/login",
            "A session: in the cookie, and as a token.",
            login::log_in,
        )
        .with(&[must("user", "As added by `relayrig user`."), must("password", "")]),
        Offer::post("/api/logout", "Ends the session that the request brings.", login::log_out),
        Offer::get("/api/me", JSON, "Name and role, or null for a stranger.", login::me),
        Offer::post(
            "/api/orders",
            "An order to the station: taken, or 409 with the reason in English and Chinese. `mode`, `jog`, `step`, \
             `shelve`, `release_lot` and `replaced` take a maintainer.",
            orders::order,
        )
        .with(&ORDER)
        .needs(Role::Operator),
        Offer::get(
            "/mimic.svg",
            "image/svg+xml",
            "The machine to scale, from the front and from above.",
            mimic::picture,
        ),
        Offer::get(
            "/api/trace",
            JSON,
            "The last traffic of every line, with its meaning.",
            trace::trace,
        )
        .with(&[may("last", "Messages of each line, 1 to 1000; 100 without it.")]),
        Offer::get(
            "/api/lots",
            JSON,
            "Lots over all their runs, the one run last first, each with what may be ordered of it.",
            lots::lots,
        )
        .with(&[
            may("limit", "So many at most, 1 to 200; 20 without it."),
            may("offset", "So many left out in front."),
        ]),
        Offer::get("/api/wear", JSON, "Uses of what wears since it was replaced.", lots::wear),
        Offer::get(
            "/api/calibration",
            JSON,
            "Factors with date, uncertainty and due date; golden parts with what was read last.",
            calibration::calibration,
        ),
        Offer::get("/metrics", "text/plain", "Figures as Prometheus text.", metrics::metrics),
        Offer::get("/api/openapi.json", JSON, "This document.", openapi),
    ];
    offers.extend(history::offers());
    offers.extend(recipes::offers());
    offers
}

/// Body of an order.
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
    may("reason", "Of `shelve` and `hold_lot`: why."),
    may(
        "lot",
        "Of `start` (without it the lot under way goes on), `hold_lot`, `release_lot`, `close_lot`: its name.",
    ),
    may("recipe", "Of `start` with a lot: name of its recipe."),
    may(
        "count",
        "Of `start` with a lot: parts wanted; without it the lot goes on until it is ended.",
    ),
    may(
        "retest",
        "Of `start` with a lot: its parts are tested again, to which this person has agreed.",
    ),
    may(
        "counter",
        "Of `replaced`: `probe_touches` or `jaw_closings`, which begins anew.",
    ),
];

static DOCUMENT: LazyLock<serde_json::Value> = LazyLock::new(|| document::of(&offers()));

async fn openapi() -> Json<serde_json::Value> {
    Json(DOCUMENT.clone())
}
