//! Sends rows in the background, in a thread of its own for each database; the rig never waits for a database.

use crate::error::Result;
use crate::sender::Sender;
use crate::session::Pushed;
use crate::status::age_s;
use config::{FleetSettings, FleetTarget};
use history::outbox::Lag;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Pause after the queue is empty.
const PAUSE: Duration = Duration::from_secs(1);
/// Longest pause after a failure; it begins at [`PAUSE`] and doubles.
const LONGEST_PAUSE: Duration = Duration::from_secs(60);
/// Longest time for which the end of the program waits for queued rows.
const LAST_ROWS: Duration = Duration::from_secs(5);

/// State of a database, for page, metrics and alarm: what it lacks, and the last error.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TargetState {
    /// URL of the database, without password.
    pub url: String,
    /// Number of parts that the database lacks.
    pub lag_parts: u64,
    /// Time since the judgement of the oldest part that the database lacks, s; 0 when it lacks none.
    pub lag_s: f64,
    /// Age at which an alarm is due, seconds.
    pub alarm_after_s: u32,
    /// Why the last attempt failed; `None` when it succeeded.
    pub last_error: Option<String>,
    /// Number of parts sent since the program began.
    pub sent_parts: u64,
}

impl TargetState {
    /// Returns true when the database lacks a part for longer than `alarm_after_s`.
    #[must_use]
    pub fn is_late(&self) -> bool {
        self.lag_s > f64::from(self.alarm_after_s)
    }
}

/// Receives the states of all databases after each attempt.
pub type Told = Box<dyn Fn(&[TargetState]) + Send + Sync>;

/// Sends to all databases until this value is dropped; the drop waits at most [`LAST_ROWS`] for queued rows.
pub struct Pusher {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

struct Shared {
    states: Mutex<Vec<TargetState>>,
    told: Told,
    ended: Mutex<usize>,
    changed: Condvar,
    stopping: AtomicBool,
}

impl Shared {
    fn states(&self) -> MutexGuard<'_, Vec<TargetState>> {
        self.states.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::Relaxed)
    }

    /// Waits until `limit` has passed or the program ends.
    fn pause(&self, limit: Duration) {
        let guard = self.ended.lock().unwrap_or_else(PoisonError::into_inner);
        let stopping = |_: &mut usize| !self.is_stopping();
        drop(self.changed.wait_timeout_while(guard, limit, stopping));
    }
}

impl Pusher {
    /// Starts a thread for each database of `fleet`. These threads call `told`.
    #[must_use]
    pub fn start(fleet: &FleetSettings, db: PathBuf, told: Told) -> Self {
        let state = |it: &FleetTarget| TargetState {
            url: it.url.clone(),
            alarm_after_s: it.alarm_after_s,
            ..TargetState::default()
        };
        let shared = Arc::new(Shared {
            states: Mutex::new(fleet.targets.iter().map(state).collect()),
            told,
            ended: Mutex::new(0),
            changed: Condvar::new(),
            stopping: AtomicBool::new(false),
        });
        let start = |place: usize| {
            let sender = Sender::new(fleet.clone(), place, db.clone())?;
            let shared = Arc::clone(&shared);
            let thread = std::thread::Builder::new().name(format!("fleet-{place}"));
            thread.spawn(move || {
                send_until_the_end(&shared, sender);
                *shared.ended.lock().unwrap_or_else(PoisonError::into_inner) += 1;
                shared.changed.notify_all();
            })
        };
        let threads = (0..fleet.targets.len()).filter_map(|place| {
            let started = start(place);
            started
                .inspect_err(|error| tracing::error!(%error, "no thread for sending"))
                .ok()
        });
        let threads = threads.collect();
        Self { shared, threads }
    }
}

impl Drop for Pusher {
    fn drop(&mut self) {
        self.shared.stopping.store(true, Ordering::Relaxed);
        self.shared.changed.notify_all();
        let guard = self
            .shared
            .ended
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        let running = |ended: &mut usize| *ended < self.threads.len();
        // A thread that has not ended by then ends with the program; the program sends its batch again at the next
        // start.
        drop(
            self.shared
                .changed
                .wait_timeout_while(guard, LAST_ROWS, running),
        );
    }
}

fn send_until_the_end(shared: &Shared, mut sender: Sender) {
    let mut pause = PAUSE;
    loop {
        let last = shared.is_stopping();
        let before = Instant::now();
        let give_up = || shared.is_stopping() && before.elapsed() > LAST_ROWS;
        let attempt = catch_unwind(AssertUnwindSafe(|| sender.attempt(give_up)));
        let sent = attempt.unwrap_or_else(|panic| {
            pause = LONGEST_PAUSE;
            Err(sender.fault(panic.as_ref()))
        });
        note(shared, sender.place, sender.lag(), &sent);
        match sent {
            Ok(_) => pause = PAUSE,
            Err(_) => pause = (pause * 2).min(LONGEST_PAUSE),
        }
        if last {
            return;
        }
        shared.pause(pause);
    }
}

/// Notes the end of an attempt with what the database lacks, if known; logs an error whose text is new.
fn note(shared: &Shared, place: usize, lag: Option<Lag>, sent: &Result<Pushed>) {
    let mut states = shared.states();
    let state = &mut states[place];
    let was_late = state.is_late();
    if let Some(lag) = lag {
        (state.lag_parts, state.lag_s) = (lag.parts, age_s(lag));
    }
    if state.is_late() && !was_late {
        let (url, parts, seconds) = (&state.url, state.lag_parts, state.lag_s);
        tracing::warn!("fleet: {url} lacks {parts} parts, the oldest for {seconds:.0} s");
    }
    match sent {
        Ok(pushed) => {
            if state.last_error.take().is_some() {
                tracing::info!(target = state.url, "database reached again");
            }
            state.sent_parts += pushed.parts;
        }
        Err(error) => {
            let text = error.to_string();
            if state.last_error.as_ref() != Some(&text) {
                tracing::warn!("fleet: {text}");
            }
            state.last_error = Some(text);
        }
    }
    (shared.told)(&states);
}
