//! The router, its shared state and the headers of every answer.

use super::api::Route;
use super::error::ApiError;
use super::history::Readers;
use super::{Sessions, Shared, api, events};
use axum::Json;
use axum::Router;
use axum::body::Bytes;
use axum::extract::{FromRef, Request, State};
use axum::http::{HeaderName, HeaderValue, Method, Uri, header};
use axum::middleware::{Next, from_fn};
use axum::response::Response;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use tokio::sync::{Semaphore, watch};

/// State that every route may use.
#[derive(Debug, Clone)]
pub(super) struct AppState {
    pub shared: Shared,
    /// Turns true when the program ends.
    pub ended: watch::Receiver<bool>,
    /// Number of open event streams.
    pub streams: Arc<AtomicUsize>,
    /// The last view as an event; see [`events::publish`].
    pub events: watch::Receiver<Bytes>,
    pub readers: Readers,
    /// Semaphore with one permit: the server makes one plan at a time.
    pub planning: Arc<Semaphore>,
}

impl FromRef<AppState> for Readers {
    fn from_ref(app: &AppState) -> Self {
        app.readers.clone()
    }
}

impl FromRef<AppState> for Sessions {
    fn from_ref(app: &AppState) -> Self {
        app.shared.sessions.clone()
    }
}

/// Extractor by which a route receives [`AppState`].
pub(super) type App = State<AppState>;

/// Returns the router of all routes; starts the task that writes views as events for all streams.
pub(super) fn router(shared: Shared, ended: watch::Receiver<bool>) -> Router {
    let (publisher, events) = watch::channel(Bytes::new());
    let app = AppState {
        readers: Readers::new(Arc::new(shared.db.clone())),
        shared,
        ended,
        streams: Arc::default(),
        events,
        planning: Arc::new(Semaphore::new(1)),
    };
    let (view, streams) = (app.shared.view.clone(), Arc::clone(&app.streams));
    tokio::spawn(events::publish(view, publisher, streams));
    routed(api::routes()).with_state(app)
}

/// Returns the router of `routes`, with the refusals and headers common to all routes.
pub(super) fn routed<S: Clone + Send + Sync + 'static>(routes: Vec<Route<S>>) -> Router<S> {
    routes
        .into_iter()
        .fold(Router::new(), |all, it| all.route(&it.path, it.handler))
        .fallback(no_such_route)
        .method_not_allowed_fallback(wrong_method)
        .layer(from_fn(default_headers))
}

/// `GET /api/view`.
pub(super) async fn view(State(app): App) -> Json<machine::view::View> {
    Json(app.shared.view.borrow().clone())
}

async fn no_such_route(uri: Uri) -> ApiError {
    let path = uri.path().to_owned();
    ApiError::NoSuchRoute { path }
}

async fn wrong_method(method: Method, uri: Uri) -> ApiError {
    let path = uri.path().to_owned();
    ApiError::WrongMethod { path, method }
}

/// Adds headers that forbid browsers and proxies to guess the type of an answer, to frame it and, unless the answer
/// itself allows it, to store it.
async fn default_headers(request: Request, next: Next) -> Response {
    const ALWAYS: [(HeaderName, &str); 4] = [
        (header::CACHE_CONTROL, "no-store"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::X_FRAME_OPTIONS, "DENY"),
        (header::REFERRER_POLICY, "no-referrer"),
    ];
    let mut response = next.run(request).await;
    for (name, value) in ALWAYS {
        let value = HeaderValue::from_static(value);
        response.headers_mut().entry(name).or_insert(value);
    }
    response
}
