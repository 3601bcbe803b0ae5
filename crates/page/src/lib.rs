//! The HTTP server: the pages, the view of the machine as JSON and as events, the history, figures for Prometheus.
//!
//! - Clients read the state of the rig, and change it only by *orders*. In the next pass of the control cycle the
//!   station accepts each order or refuses it with a reason.
//! - The view comes through a watch channel, so that the cycle never waits for a client: a slow client skips to the
//!   latest view, and views do not queue.
//! - A route refuses with JSON: the status in words, the reason in English and Chinese, its code (`error.rs`).
//! - A body has at most 16 kB. The server limits connections in number and time (`server.rs`). A request that changes
//!   anything must not come from a page of another site.
//! - When the program ends, every event stream ends, and the server cuts connections still open after [`GRACE`].
//!
//! | route | answer |
//! |---|---|
//! | `GET /`, `GET /page/...` | the operator's page with what all pages share; the script of another page |
//! | `GET /api/view` | the view |
//! | `GET /api/events` | the view as server-sent events: at once, on change, otherwise once a second; a beat each second |
//! | `POST /api/login\|logout\|password`, `GET /api/me`, `POST /api/setup`, `GET /api/setup/needed` | sessions; the first engineer |
//! | `GET /api/people`, `POST /api/people/change` | people, for engineers (`people.rs`) |
//! | `POST /api/orders` | `{"order":"stop"}` and the others of [`machine::view::Order`] |
//! | `GET /api/history/...` | JSON, pages and files as the command `history` gives them; routes in `history.rs` |
//! | `GET /api/recipes...`, `POST /api/recipes/revise\|approve` | recipes and their revisions (`recipes.rs`, `approval.rs`) |
//! | `GET /api/lots`, `GET /api/wear` | lots with the orders that their states allow; wear counters (`lots.rs`) |
//! | `GET /api/plans/...`, `POST /api/plans/preview\|start\|tick\|abandon` | plans for tooling, ticked off (`plans.rs`) |
//! | `GET /api/calibration` | factors with date, uncertainty and due date; reference parts with their last readings |
//! | `GET /mimic.svg` | the machine to scale, from above and from the front |
//! | `GET /api/trace` | the last traffic of every line, with its meaning |
//! | `GET /api/openapi.json` | the OpenAPI document |
//! | `GET /metrics` | Prometheus text |
//!
//! Reading needs no login; orders and revisions need one (`sessions.rs`). A route refuses every member that it does not
//! take.
//!
//! The page of many rigs has routes of its own, which only read (`fleet.rs`).
//!
//! Without a certificate the page listens on this computer alone:
//!
//! ```
//! use page::{ListenError, Listener};
//! use std::net::SocketAddr;
//! let refused = Listener::open(SocketAddr::from(([0, 0, 0, 0], 8080)), None);
//! assert!(matches!(refused, Err(ListenError::InTheClear(_))));
//! ```

pub mod access;
mod answers;
mod api;
mod approval;
mod asked;
mod calibration;
mod error;
mod events;
mod external;
mod fleet;
mod gauge;
mod history;
mod language;
mod login;
mod lots;
mod metrics;
mod mimic;
mod orders;
mod origin;
mod page;
mod people;
mod plans;
mod prompt;
mod recipes;
mod router;
mod server;
mod sessions;
mod trace;

pub use approval::approve_with_password;
use config::Folder;
pub use fleet::{FleetShared, serve_fleet};
pub use history::{Archives, RigName};
use machine::view::{Mimic, OrderRequest};
pub use orders::WAITING;
pub use plans::{ListedScene, PlanAnswer, PlanFault, PlanMaker, PlanQuestion};
pub use server::{ListenError, Listener, Tls, serve};
pub use sessions::Sessions;
pub use trace::Traffic;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{mpsc, watch};

/// Time for which open connections may finish when the program ends.
pub const GRACE: Duration = Duration::from_secs(1);

/// Links between the server and the rest of the program.
#[derive(Debug, Clone)]
pub struct Shared {
    /// The latest view; once its sender is gone, beats say that the controller has ended.
    pub view: watch::Receiver<machine::view::View>,
    /// The history file, which may not exist yet.
    pub db: PathBuf,
    /// Files of the configuration with the recipes.
    pub config: Folder,
    /// Shapes of the machine, from which `GET /mimic.svg` draws it to scale.
    pub mimic: Arc<Mimic>,
    /// Sessions and people.
    pub sessions: Sessions,
    /// The last traffic of the lines.
    pub traffic: Traffic,
    /// Makes plans for tooling.
    pub plans: Arc<dyn PlanMaker>,
    /// Queue to the cycle, which answers each order in its next pass.
    pub orders: mpsc::Sender<OrderRequest>,
}

/// Resolves when the program ends.
async fn end_of_program(mut ended: watch::Receiver<bool>) {
    // A lost sender also means the end.
    let _ = ended.wait_for(|ended| *ended).await;
}

#[cfg(test)]
mod tests;
