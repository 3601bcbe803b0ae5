//! Controls that page, signals and scripts share with a run, and that outlive the run: stop flags and the view.

use super::stop_signals::StopSignals;
use super::traces::Traces;
use anyhow::Context;
use machine::station::trouble::Alarm;
use machine::view::{LineTraffic, View};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::watch;

/// Controls of a run; clones share the same flags and view.
#[derive(Debug, Clone)]
pub struct Controls {
    /// Ends the lot once the parts inside the rig are finished.
    pub stop: Arc<AtomicBool>,
    /// Ends the lot at once; parts stay inside the rig.
    pub abort: Arc<AtomicBool>,
    /// True when a person is at a screen: alarms and stops then do not end the run.
    pub attended: bool,
    /// Sends the view to the screens.
    pub view: watch::Sender<View>,
    /// Sends the active alarms about the databases of the fleet to the cycle.
    pub fleet: watch::Sender<Vec<Alarm>>,
    /// Traffic of the current run; `None` before its lines are open.
    traces: Arc<Mutex<Option<Traces>>>,
}

impl Controls {
    /// Creates controls without a stop, an abort or traffic, and with an empty view.
    pub fn new(attended: bool) -> Self {
        Self {
            stop: Arc::new(AtomicBool::new(false)),
            abort: Arc::new(AtomicBool::new(false)),
            attended,
            view: watch::channel(View::default()).0,
            fleet: watch::channel(Vec::new()).0,
            traces: Arc::default(),
        }
    }

    /// Makes Ctrl-C or SIGTERM stop the lot, a second signal abort the lot, and a third one end the program, until the
    /// caller drops the returned handle.
    ///
    /// # Errors
    /// Fails when the operating system refuses the handlers or the thread.
    pub fn stop_on_signals(&self) -> anyhow::Result<StopSignals> {
        let flags = [Arc::clone(&self.stop), Arc::clone(&self.abort)];
        StopSignals::listen(flags).context("catching Ctrl-C")
    }

    /// Returns true once a person or a signal has ordered a stop or an abort.
    pub fn is_stopping(&self) -> bool {
        let flags = [&self.stop, &self.abort];
        flags.iter().any(|flag| flag.load(Ordering::Acquire))
    }

    pub(super) fn show_traffic(&self, traces: &Traces) {
        let mut held = self.traces.lock().unwrap_or_else(PoisonError::into_inner);
        *held = Some(traces.clone());
    }

    /// Returns a function that, given a number n, returns the last n messages of every line, or fewer.
    pub fn traffic(&self) -> impl Fn(usize) -> Vec<LineTraffic> + use<> {
        let traces = Arc::clone(&self.traces);
        move |last| {
            let held = traces.lock().unwrap_or_else(PoisonError::into_inner);
            let traces = held.as_ref();
            traces.map_or_else(Vec::new, |traces| traces.messages(last))
        }
    }
}

/// Ctrl-C and SIGTERM, which end every command in the same way.
#[derive(Debug)]
pub struct Interrupts {
    pressed: Signal,
    terminated: Signal,
}

impl Interrupts {
    /// Starts to listen; a signal that arrives before [`Self::next`] is not lost. Panics outside a runtime.
    ///
    /// # Errors
    /// Fails when the operating system refuses the handlers.
    pub fn listen() -> std::io::Result<Self> {
        Ok(Self {
            pressed: signal(SignalKind::interrupt())?,
            terminated: signal(SignalKind::terminate())?,
        })
    }

    /// Waits for the next of the two signals.
    pub async fn next(&mut self) {
        tokio::select! {
            _ = self.pressed.recv() => {}
            _ = self.terminated.recv() => {}
        }
    }
}
