//! Tells systemd the state of the service: ready, alive, state in words, stopping.
//!
//! A new view proves that the service is alive: a running cycle publishes one at least once a second, and so does the
//! wait for a history that cannot be written. When the cycle hangs, no view follows and systemd restarts the program.
//!
//! - `READY=1` follows the first view of a cycle: page and lines are open by then.
//! - `WATCHDOG=1` follows a view, at most four times within `WatchdogSec`.
//! - `STATUS=` is the state in words, when it changes.
//! - `STOPPING=1` follows the first signal.
//!
//! Without `NOTIFY_SOCKET` the program sends no message.

use crate::controls::Controls;
use machine::view::View;
use sd_notify::NotifyState;
use std::time::{Duration, Instant};

/// Number of pings within `WatchdogSec`, after which systemd considers a silent service dead.
const PINGS: u32 = 4;

/// State of the service as systemd knows it.
#[derive(Debug, Default)]
struct Notifier {
    is_ready: bool,
    is_stopping: bool,
    status: String,
    pinged: Option<Instant>,
    /// Longest time between two pings; `None` without a watchdog.
    every: Option<Duration>,
}

/// Tells systemd about every view of the rig until the program ends.
pub(super) async fn notify_systemd(controls: Controls) {
    let mut views = controls.view.subscribe();
    let mut notifier = Notifier {
        every: sd_notify::watchdog_enabled().map(|limit| limit / PINGS),
        ..Notifier::default()
    };
    while views.changed().await.is_ok() {
        let messages = {
            let view = views.borrow_and_update();
            notifier.messages(&view, controls.is_stopping(), Instant::now())
        };
        send(&messages);
    }
}

fn send(messages: &[NotifyState]) {
    if messages.is_empty() {
        return;
    }
    if let Err(error) = sd_notify::notify(messages) {
        tracing::warn!("systemd cannot be notified: {error}");
    }
}

impl Notifier {
    /// Returns the messages that follow a view at `now`.
    fn messages(&mut self, view: &View, is_stopping: bool, now: Instant) -> Vec<NotifyState<'_>> {
        let mut messages = Vec::new();
        // Only a cycle sets `at_us`, so a cycle is running.
        if view.at_us > 0 && !std::mem::replace(&mut self.is_ready, true) {
            messages.push(NotifyState::Ready);
        }
        if is_stopping && !std::mem::replace(&mut self.is_stopping, true) {
            messages.push(NotifyState::Stopping);
        }
        if self.is_ping_due(now) {
            self.pinged = Some(now);
            messages.push(NotifyState::Watchdog);
        }
        let status = status(view, is_stopping);
        if status != self.status {
            self.status = status;
            messages.push(NotifyState::Status(&self.status));
        }
        messages
    }

    fn is_ping_due(&self, now: Instant) -> bool {
        let waited = |every| {
            let since = self.pinged.map(|pinged| now.duration_since(pinged));
            since.is_none_or(|since| since >= every)
        };
        self.is_ready && self.every.is_some_and(waited)
    }
}

/// Returns the state in words, for `systemctl status`.
fn status(view: &View, is_stopping: bool) -> String {
    let mut words = vec![match (view.under_way, view.count) {
        (false, _) => "between lots".to_owned(),
        (true, Some(count)) => format!("lot {}, {} of {count} judged", view.lot, view.judged),
        (true, None) => format!("lot {}, {} judged", view.lot, view.judged),
    }];
    words.push(view.machine.state.to_lowercase());
    words.extend(view.alarms.first().map(|it| format!("alarm {}", it.code)));
    words.extend(is_stopping.then(|| "stopping".to_owned()));
    words.retain(|word| !word.is_empty());
    words.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use machine::view::AlarmLine;

    fn view(at_us: i64) -> View {
        let mut view = View {
            at_us,
            ..View::default()
        };
        view.machine.state = "Stopped".into();
        view
    }

    fn notifier() -> Notifier {
        Notifier {
            every: Some(Duration::from_secs(5)),
            ..Notifier::default()
        }
    }

    /// Returns the messages as systemd receives them.
    fn sent(notifier: &mut Notifier, view: &View, is_stopping: bool, now: Instant) -> Vec<String> {
        let messages = notifier.messages(view, is_stopping, now);
        messages.iter().map(ToString::to_string).collect()
    }

    #[test]
    fn ready_waits_for_the_first_view_of_a_cycle() {
        let (mut notifier, now) = (notifier(), Instant::now());
        let text = ["STATUS=between lots; stopped"];
        assert_eq!(sent(&mut notifier, &view(0), false, now), text);
        let ready = ["READY=1", "WATCHDOG=1"];
        assert_eq!(sent(&mut notifier, &view(1), false, now), ready);
    }

    #[test]
    fn a_ping_follows_a_view_once_it_is_due() {
        let (mut notifier, start) = (notifier(), Instant::now());
        notifier.messages(&view(1), false, start);
        let at = |seconds| start + Duration::from_secs(seconds);
        let mut ping = |at_us, at| sent(&mut notifier, &view(at_us), false, at);
        assert!(ping(2, at(4)).is_empty());
        assert_eq!(ping(3, at(5)), ["WATCHDOG=1"]);
        assert!(ping(4, at(6)).is_empty());
    }

    #[test]
    fn without_a_watchdog_no_ping_is_sent() {
        let mut notifier = Notifier::default();
        let messages = sent(&mut notifier, &view(1), false, Instant::now());
        assert_eq!(messages, ["READY=1", "STATUS=between lots; stopped"]);
    }

    #[test]
    fn stopping_is_sent_once() {
        let (mut notifier, now) = (notifier(), Instant::now());
        notifier.messages(&view(1), false, now);
        let stopping = ["STOPPING=1", "STATUS=between lots; stopped; stopping"];
        assert_eq!(sent(&mut notifier, &view(2), true, now), stopping);
        assert!(sent(&mut notifier, &view(3), true, now).is_empty());
    }

    #[test]
    fn the_status_names_lot_and_first_alarm() {
        let alarm = AlarmLine {
            code: "door_open".into(),
            ..AlarmLine::default()
        };
        let mut view = View {
            lot: "A".into(),
            under_way: true,
            judged: 3,
            count: Some(20),
            alarms: vec![alarm],
            ..View::default()
        };
        view.machine.state = "Execute".into();
        let expected = "lot A, 3 of 20 judged; execute; alarm door_open";
        assert_eq!(status(&view, false), expected);
    }
}
