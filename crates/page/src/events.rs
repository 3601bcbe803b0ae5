//! The view as server-sent events.
//!
//! | event | data | when |
//! |---|---|---|
//! | `view` | the whole view | at once on connecting, then on change, at most 20 times a second |
//! | `beat` | `{"alive":true}` | each second; `false` once nobody makes views any more |
//!
//! A screen that heard nothing for three seconds, or hears `"alive":false`, shows old values and must
//! say so. A slow screen skips views, it never gets a stale one after a newer one. The stream ends
//! when the program does.

use super::over;
use super::router::Desk;
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
/// Time between two beats.
const BEAT: Duration = Duration::from_secs(1);
/// How long a browser waits before it connects again.
const RETRY: Duration = Duration::from_secs(1);

/// `GET /api/events`.
pub(super) async fn events(
    State(desk): State<Desk>,
) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    let feed = Feed::new(&desk);
    Sse::new(stream::unfold(feed, |mut feed| async move {
        let event = feed.next().await?;
        Some((Ok(event), feed))
    }))
}

/// One screen's place in the stream.
struct Feed {
    view: watch::Receiver<View>,
    over: Pin<Box<dyn Future<Output = ()> + Send>>,
    /// The first view has gone out.
    greeted: bool,
    next_view: Instant,
    next_beat: Instant,
    _counted: Counted,
}

/// What comes next.
enum Turn {
    View,
    Beat,
    Over,
}

impl Feed {
    fn new(desk: &Desk) -> Self {
        Self {
            view: desk.shared.view.clone(),
            over: Box::pin(over(desk.ended.clone())),
            greeted: false,
            next_view: Instant::now(),
            next_beat: Instant::now() + BEAT,
            _counted: Counted::new(&desk.screens),
        }
    }

    async fn next(&mut self) -> Option<Event> {
        match self.turn().await {
            Turn::View => {
                let first = !self.greeted;
                self.greeted = true;
                self.next_view = Instant::now() + PACE;
                let text = serde_json::to_string(&*self.view.borrow_and_update());
                let event = Event::default().event("view").data(text.ok()?);
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

    /// A beat that is due goes before a view, so that a busy rig does not silence it.
    async fn turn(&mut self) -> Turn {
        if !self.greeted {
            return Turn::View;
        }
        let (view, next_view) = (&mut self.view, self.next_view);
        tokio::select! {
            biased;
            () = &mut self.over => Turn::Over,
            () = sleep_until(self.next_beat) => Turn::Beat,
            () = changed(view, next_view) => Turn::View,
        }
    }
}

/// Resolves at a view not sent yet, no sooner than `after`; never when none will come.
async fn changed(view: &mut watch::Receiver<View>, after: Instant) {
    sleep_until(after).await;
    if view.changed().await.is_err() {
        std::future::pending::<()>().await;
    }
}

/// Counts a stream as long as it lives.
struct Counted(Arc<AtomicUsize>);

impl Counted {
    fn new(screens: &Arc<AtomicUsize>) -> Self {
        screens.fetch_add(1, Ordering::Relaxed);
        Self(Arc::clone(screens))
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}
