//! The view of the machine as server-sent events.
//!
//! | event | data | when |
//! |---|---|---|
//! | `view` | the whole view | on connecting; on change, at most 20 times a second; otherwise once a second |
//! | `beat` | `{"alive":true}` | each second; `false` after the controller has ended |
//!
//! A browser that receives nothing for three seconds, or `"alive":false`, has old values and must show them as such. A
//! slow browser skips views and never gets an older one after a newer one. The stream ends with the program.

use super::end_of_program;
use super::router::{App, AppState};
use axum::extract::State;
use axum::response::Sse;
use axum::response::sse::Event;
use futures_util::stream::{self, Stream};
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
/// Time that a browser waits before it connects again.
const RETRY: Duration = Duration::from_secs(1);

/// `GET /api/events`.
pub(super) async fn events(State(app): App) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let feed = Feed::new(&app);
    Sse::new(stream::unfold(feed, |mut feed| async move {
        let event = feed.next().await?;
        Some((Ok(event), feed))
    }))
}

/// The stream of one browser.
struct Feed {
    view: watch::Receiver<View>,
    over: Pin<Box<dyn Future<Output = ()> + Send>>,
    /// Last view sent, with the instant of sending; `None` before the first.
    sent: Option<(Instant, View)>,
    next_beat: Instant,
    _counted: Counted,
}

/// What the stream does next.
enum Turn {
    View,
    Beat,
    Over,
}

impl Feed {
    fn new(app: &AppState) -> Self {
        Self {
            view: app.shared.view.clone(),
            over: Box::pin(end_of_program(app.ended.clone())),
            sent: None,
            next_beat: Instant::now() + BEAT,
            _counted: Counted::new(&app.streams),
        }
    }

    async fn next(&mut self) -> Option<Event> {
        match self.turn().await {
            Turn::View => {
                let view = self.view.borrow_and_update().clone();
                let event = Event::default().event("view");
                let event = event.data(serde_json::to_string(&view).ok()?);
                let first = self.sent.replace((Instant::now(), view)).is_none();
                Some(if first { event.retry(RETRY) } else { event })
            }
            Turn::Beat => {
                self.next_beat = Instant::now() + BEAT;
                let alive = self.view.has_changed().is_ok();
                let data = format!("{{\"alive\":{alive}}}");
                Some(Event::default().event("beat").data(data))
            }
            Turn::Over => None,
        }
    }

    /// Waits for the next turn. A due beat comes before a view, so that a busy rig cannot suppress beats.
    async fn turn(&mut self) -> Turn {
        let Some((at, sent)) = &mut self.sent else {
            return Turn::View;
        };
        tokio::select! {
            biased;
            () = &mut self.over => Turn::Over,
            () = sleep_until(self.next_beat) => Turn::Beat,
            () = changed(&mut self.view, *at, sent) => Turn::View,
        }
    }
}

/// Resolves when a view is due after the one that was sent at `at`: from [`PACE`] after `at` a view that differs from
/// `sent`, from [`BEAT`] after `at` any new view. Never resolves after the sender of views has gone.
async fn changed(views: &mut watch::Receiver<View>, at: Instant, sent: &mut View) {
    sleep_until(at + PACE).await;
    while views.changed().await.is_ok() {
        if at.elapsed() >= BEAT || !same_content(&views.borrow_and_update(), sent) {
            return;
        }
    }
    std::future::pending().await
}

/// Returns true when the views differ at most in wall-clock times, which each turn of the cycle changes; copies those
/// times from `view` to `sent`.
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
