//! From the list of routes to a service, and what holds for all of them.

use super::error::HmiError;
use super::history::Readers;
use super::{Shared, api};
use axum::Json;
use axum::Router;
use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::{HeaderName, HeaderValue, Method, Uri, header};
use axum::middleware::{Next, from_fn};
use axum::response::Response;
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use tokio::sync::watch;

/// Largest body of a request, bytes.
pub(super) const BODY_LIMIT: usize = 16 * 1024;

/// What every route may use.
#[derive(Debug, Clone)]
pub(super) struct Desk {
    pub shared: Shared,
    /// True once the program ends.
    pub ended: watch::Receiver<bool>,
    /// Streams of events now open.
    pub screens: Arc<AtomicUsize>,
    pub readers: Readers,
}

/// All routes over `shared`.
pub(super) fn router(shared: Shared, ended: watch::Receiver<bool>) -> Router {
    let desk = Desk {
        readers: Readers::new(shared.db.clone()),
        shared,
        ended,
        screens: Arc::default(),
    };
    let offers = api::offers().into_iter();
    offers
        .fold(Router::new(), |router, offer| {
            router.route(offer.path, offer.handler)
        })
        .fallback(nothing_there)
        .method_not_allowed_fallback(wrong_method)
        .layer(DefaultBodyLimit::max(BODY_LIMIT))
        .layer(from_fn(plain_headers))
        .with_state(desk)
}

/// `GET /api/view`.
pub(super) async fn view(State(desk): State<Desk>) -> Json<machine::view::View> {
    Json(desk.shared.view.borrow().clone())
}

async fn nothing_there(uri: Uri) -> HmiError {
    let path = uri.path().to_owned();
    HmiError::NoSuchRoute { path }
}

async fn wrong_method(method: Method, uri: Uri) -> HmiError {
    let path = uri.path().to_owned();
    HmiError::WrongMethod { path, method }
}

/// Forbids browsers and proxies to keep an answer that does not allow it itself, to guess its type, and to frame it.
async fn plain_headers(request: Request, next: Next) -> Response {
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
