//! The view of the machine as server-sent events.
//!
//! | event | data | when |
//! |---|---|---|
//! | `view` | the whole view | on connecting; on change, at most 20 times a second; otherwise once a second |
//! | `beat` | `{"alive":true}` | each second; `false` after the controller has ended |
//!
//! A client that receives nothing for three seconds, or `"alive":false`, has old values and must show them as old. A
//! slow client skips views and never gets an older view after a newer one. After the end of a stream a browser waits 1
//! s before it connects again (`retry`). The stream ends with the program.

use super::answers::{As, Events};
use super::end_of_program;
use super::router::{App, AppState};
use axum::body::{Body, Bytes};
use axum::extract::State;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::response::IntoResponse;
use futures_util::stream;
use machine::view::View;
use std::convert::Infallible;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::{Instant, sleep_until};

/// Least time between two views on one stream.
const PACE: Duration = Duration::from_millis(50);
/// Time between two beats, and between two views when nothing has changed.
const BEAT: Duration = Duration::from_secs(1);

/// `GET /api/events`.
pub(super) async fn events(State(app): App) -> As<Events> {
    let events = stream::unfold(Feed::new(&app), |mut feed| async move {
        let event = feed.next().await?;
        Some((Ok::<_, Infallible>(event), feed))
    });
    let headers = [
        (CONTENT_TYPE, "text/event-stream"),
        (CACHE_CONTROL, "no-cache"),
    ];
    As::new((headers, Body::from_stream(events)).into_response())
}

/// Writes every due view as an event, once for all streams; writes none while there is no stream. The task ends with
/// its runtime.
pub(super) fn publish(
    mut views: watch::Receiver<View>,
    events: watch::Sender<Bytes>,
    streams: Arc<AtomicUsize>,
) -> impl Future<Output = ()> {
    let mut sent = views.borrow_and_update().clone();
    async move {
        loop {
            changed(&mut views, Instant::now(), &mut sent).await;
            sent.clone_from(&views.borrow_and_update());
            if streams.load(Ordering::Relaxed) > 0 {
                events.send_replace(event_of(&sent));
            }
        }
    }
}

fn event_of(view: &View) -> Bytes {
    let data = serde_json::to_string(view).unwrap_or_default();
    format!("event: view\ndata: {data}\n\n").into()
}

/// The stream of one browser.
struct Feed {
    view: watch::Receiver<View>,
    /// The last view as the bytes of an event, which all streams share.
    events: watch::Receiver<Bytes>,
    over: Pin<Box<dyn Future<Output = ()> + Send>>,
    has_begun: bool,
    next_beat: Instant,
    _counted: Counted,
}

impl Feed {
    fn new(app: &AppState) -> Self {
        Self {
            view: app.shared.view.clone(),
            events: app.events.clone(),
            over: Box::pin(end_of_program(app.ended.clone())),
            has_begun: false,
            next_beat: Instant::now() + BEAT,
            _counted: Counted::new(&app.streams),
        }
    }

    /// Returns the next event. A due beat comes before a view, so that a busy rig cannot suppress beats.
    async fn next(&mut self) -> Option<Bytes> {
        if !std::mem::replace(&mut self.has_begun, true) {
            self.events.mark_unchanged();
            let retry = b"retry: 1000\n".as_slice();
            return Some([retry, &event_of(&self.view.borrow())].concat().into());
        }
        tokio::select! {
            biased;
            () = &mut self.over => None,
            () = sleep_until(self.next_beat) => {
                self.next_beat = Instant::now() + BEAT;
                let alive = self.view.has_changed().is_ok();
                Some(format!("event: beat\ndata: {{\"alive\":{alive}}}\n\n").into())
            }
            Ok(()) = self.events.changed() => Some(self.events.borrow_and_update().clone()),
        }
    }
}

/// Waits until the next view is due after the view `sent`, which went out at `at`: a view that differs from `sent` is
/// due [`PACE`] after `at`, any other new view [`BEAT`] after `at`. Never resolves after the sender of views has gone.
async fn changed(views: &mut watch::Receiver<View>, at: Instant, sent: &mut View) {
    sleep_until(at + PACE).await;
    while views.changed().await.is_ok() {
        if at.elapsed() >= BEAT || !same_content(&views.borrow_and_update(), sent) {
            return;
        }
    }
    std::future::pending().await
}

/// Returns true when the views differ at most in wall-clock times, which change with every view of the cycle; copies
/// those times from `view` to `sent`.
fn same_content(view: &View, sent: &mut View) -> bool {
    sent.at_us = view.at_us;
    sent.machine.phases_s.clone_from(&view.machine.phases_s);
    view == sent
}

/// Counts as one open stream until this value is dropped.
struct Counted(Arc<AtomicUsize>);

impl Counted {
    fn new(streams: &Arc<AtomicUsize>) -> Self {
        streams.fetch_add(1, Ordering::Relaxed);
        Self(Arc::clone(streams))
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}
