//! The screen: the operator's page, the view as JSON and as events, the history, figures for Prometheus.
//!
//! - A screen looks; it never writes to the rig. What it wants done it sends as an *order*, which the
//!   station takes or refuses with the reason in its next turn.
//! - The view comes through a watch channel, so that the cycle never waits for a screen: a slow one
//!   skips to the latest view, and nobody's lateness is stored.
//! - An answer in the range 4xx or 5xx is always JSON: `{"error": "<word>", "reason": "<sentence>"}`.
//! - A body is at most 16 kB; a request that changes anything must come from this very page or from
//!   no page at all.
//! - When the program ends, every stream of events ends too, and a connection that will not finish
//!   is left behind after [`GRACE`].
//!
//! | route | answer |
//! |---|---|
//! | `GET /` | the page, whole in one answer |
//! | `GET /api/view` | the view |
//! | `GET /api/events` | the view as server-sent events: at once, then on change; a beat each second |
//! | `POST /api/login\|logout`, `GET /api/me` | who is asking |
//! | `POST /api/orders` | `{"order":"stop"}` and the others of [`machine::view::ORDERS`] and [`machine::view::LOT_ORDERS`] |
//! | `GET /api/history/...` | JSON, pages and files as the command `history` gives them; routes in `history.rs` |
//! | `GET /api/recipes...`, `POST /api/recipes/revise` | what recipes say, and their next revisions (`recipes.rs`) |
//! | `GET /api/lots`, `GET /api/wear` | lots with what may be ordered of them; counters of what wears (`lots.rs`) |
//! | `GET /api/calibration` | factors with date, uncertainty and due date; golden parts with what was read last |
//! | `GET /mimic.svg` | the machine to scale, from above and from the front |
//! | `GET /api/trace` | the last traffic of every line, with its meaning |
//! | `GET /api/openapi.json` | this list for programs, made of `api.rs` like the router itself |
//! | `GET /metrics` | Prometheus text |
//!
//! Whoever reaches the address may look; who wants something done logs in (`gate.rs`).

pub mod access;
mod api;
mod calibration;
mod error;
mod events;
mod gate;
mod history;
mod login;
mod lots;
mod metrics;
mod mimic;
mod orders;
mod origin;
mod page;
mod recipes;
mod router;
mod trace;

pub use gate::Gate;
use machine::view::{Mimic, OrderRequest};
pub use orders::WAITING;
pub use trace::Traffic;

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::{mpsc, watch};

/// How long connections may take to finish after the end was announced.
pub const GRACE: Duration = Duration::from_secs(1);

/// What the screen shares with the rest of the program.
#[derive(Debug, Clone)]
pub struct Shared {
    /// The latest view; once its sender is gone, screens are told that the values are the last ones.
    pub view: watch::Receiver<machine::view::View>,
    /// The history file; it need not exist yet.
    pub db: PathBuf,
    /// The folder of the configuration, whose recipes are shown and revised.
    pub config: PathBuf,
    /// The machine to scale.
    pub mimic: Arc<Mimic>,
    /// Who may order what.
    pub gate: Gate,
    /// The last traffic of the lines.
    pub traffic: Traffic,
    /// To the cycle, which answers each order in its next turn.
    pub orders: mpsc::Sender<OrderRequest>,
}

/// Answers on `listener` until `ended` turns true or its sender is gone, then at most [`GRACE`] longer.
///
/// # Errors
/// The listener's own, which end the service.
pub async fn serve(
    listener: TcpListener,
    shared: Shared,
    ended: watch::Receiver<bool>,
) -> std::io::Result<()> {
    let router = router::router(shared, ended.clone());
    let router = router.into_make_service_with_connect_info::<SocketAddr>();
    let service = axum::serve(listener, router).with_graceful_shutdown(over(ended.clone()));
    tokio::select! {
        served = service => served,
        () = after_grace(ended) => Ok(()),
    }
}

/// Resolves once the program ends.
async fn over(mut ended: watch::Receiver<bool>) {
    // A sender that is gone says the same as one that says so.
    let _ = ended.wait_for(|ended| *ended).await;
}

async fn after_grace(ended: watch::Receiver<bool>) {
    over(ended).await;
    tokio::time::sleep(GRACE).await;
}

#[cfg(test)]
mod tests;
