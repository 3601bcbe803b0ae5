//! The page of many rigs, which only reads, from a database with the histories of the rigs.
//!
//! | route | answer |
//! |---|---|
//! | `GET /`, `GET /page/...` | the page of all rigs; the script of another page |
//! | `GET /api/fleet` | what each rig is doing and has made |
//! | `GET /api/history/...` | the history of all rigs, as `history ... --from` gives it |
//! | `GET /rigs/SITE/RIG/` and the same below it | the page and the history of one rig, down to the raw replies |
//! | `POST /api/quality/grr` | a gauge study of the readings in the body; stores nothing |
//! | `GET /api/openapi.json` | the OpenAPI document |
//!
//! All clients share one overview, which arrives through a watch channel; a route of the history opens a reader of its
//! own. There are no sessions, because no route changes anything; orders and the audit of people stay on the page of
//! the rig.

use super::api::{Route, document, of_history};
use super::history::{Archives, Readers};
use super::server::serve_routes;
use super::{Tls, gauge, page};
use crate::router::routed;
use ::history::inquiry::rigs::Overview;
use axum::Json;
use axum::Router;
use axum::extract::{FromRef, State};
use serde::Deserialize;
use serde_json::Value;
use std::sync::{Arc, LazyLock};
use tokio::net::TcpListener;
use tokio::sync::watch;
use utoipa::IntoParams;

/// Links between the server and the rest of the program.
#[derive(Debug, Clone)]
pub struct FleetShared {
    /// What each rig is doing and has made.
    pub overview: watch::Receiver<Overview>,
    /// The histories.
    pub archives: Arc<dyn Archives>,
}

/// State of the routes.
#[derive(Debug, Clone)]
struct Fleet {
    overview: watch::Receiver<Overview>,
    readers: Readers,
}

impl FromRef<Fleet> for Readers {
    fn from_ref(fleet: &Fleet) -> Self {
        fleet.readers.clone()
    }
}

/// Members of a path that name a rig.
#[derive(Debug, Deserialize, IntoParams)]
#[expect(dead_code, reason = "describes what the readers take from the path")]
struct OfRig {
    /// Name of the plant.
    #[param(example = "suzhou")]
    site: String,
    /// Name of the rig.
    #[param(example = "rig-07")]
    rig: String,
}

/// Path of the page of a rig.
const OF_RIG: &str = "/rigs/{site}/{rig}";

/// Serves the page of many rigs at `listener` until `ended` turns true or loses its sender.
pub async fn serve_fleet(
    listener: TcpListener,
    tls: Option<Tls>,
    shared: FleetShared,
    ended: watch::Receiver<bool>,
) {
    serve_routes(listener, tls, (router(shared), None), ended).await;
}

fn router(shared: FleetShared) -> Router {
    routed(routes()).with_state(Fleet {
        overview: shared.overview,
        readers: Readers::new(shared.archives),
    })
}

fn routes() -> Vec<Route<Fleet>> {
    let mut routes = vec![
        Route::get("/", "The page of all rigs.", page::fleet_page),
        Route::get("/page/{file}", "The script of another page.", page::script),
        Route::get("/api/fleet", "What each rig does and made.", overview),
        Route::post(
            "/api/quality/grr",
            "Gauge repeatability and reproducibility of the readings in the body; stores nothing.",
            gauge::study,
        )
        .refuses(&[500]),
        Route::get("/api/openapi.json", "This document.", openapi),
        Route::get("/", "The page of a rig.", page::fleet_page).below::<OfRig>(OF_RIG),
        Route::post(
            "/api/quality/grr",
            "Gauge repeatability and reproducibility, for the page of a rig.",
            gauge::study,
        )
        .refuses(&[500])
        .below::<OfRig>(OF_RIG),
    ];
    routes.extend(of_history());
    let of_rig = of_history().into_iter();
    routes.extend(of_rig.map(|it| it.below::<OfRig>(OF_RIG)));
    routes
}

/// `GET /api/fleet`.
async fn overview(State(fleet): State<Fleet>) -> Json<Overview> {
    Json(fleet.overview.borrow().clone())
}

static DOCUMENT: LazyLock<Value> = LazyLock::new(|| document::of(routes()));

async fn openapi() -> Json<Value> {
    Json(DOCUMENT.clone())
}

#[cfg(test)]
mod tests;
