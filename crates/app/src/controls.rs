//! Controls that the page, signals and scripts share with a run: flags, orders, view. They outlive the run.

use super::traces::Traces;
use machine::view::{LineTraffic, View};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::watch;

/// Controls of a run, shared with a page; copies are the same controls.
#[derive(Debug, Clone)]
pub struct Controls {
    /// Ends the lot after the parts inside.
    pub stop: Arc<AtomicBool>,
    /// Ends it at once.
    pub abort: Arc<AtomicBool>,
    /// A person is at a screen: alarms and stops do not end the run.
    pub attended: bool,
    /// What screens see.
    pub view: watch::Sender<View>,
    /// Traffic of the run under way; none before its lines are open.
    traces: Arc<Mutex<Option<Traces>>>,
}

impl Controls {
    /// Nothing ordered, nothing seen.
    pub fn new(attended: bool) -> Self {
        Self {
            stop: Arc::new(AtomicBool::new(false)),
            abort: Arc::new(AtomicBool::new(false)),
            attended,
            view: watch::channel(View::default()).0,
            traces: Arc::default(),
        }
    }

    /// From now on Ctrl-C stops, and once more aborts. Inside of a runtime.
    pub fn heed_signals(&self) {
        let flags = [Arc::clone(&self.stop), Arc::clone(&self.abort)];
        tokio::spawn(interruptions(flags));
    }

    /// A stop or an abort was ordered.
    pub fn is_stopping(&self) -> bool {
        let flags = [&self.stop, &self.abort];
        flags.iter().any(|flag| flag.load(Ordering::Acquire))
    }

    pub(super) fn show_traffic(&self, traces: &Traces) {
        let mut held = self.traces.lock().unwrap_or_else(PoisonError::into_inner);
        *held = Some(traces.clone());
    }

    /// Gives the last messages of every line, at most as many as asked for.
    pub fn traffic(&self) -> impl Fn(usize) -> Vec<LineTraffic> + use<> {
        let traces = Arc::clone(&self.traces);
        move |last| {
            let held = traces.lock().unwrap_or_else(PoisonError::into_inner);
            let traces = held.as_ref();
            traces.map_or_else(Vec::new, |traces| traces.messages(last))
        }
    }
}

/// Ctrl-C, or the signal that a service manager ends a program with: the first one finishes the parts inside, the
/// second does not wait for them. One that comes while the one before is logged is not lost.
async fn interruptions(flags: [Arc<AtomicBool>; 2]) -> std::io::Result<()> {
    use tokio::signal::unix::{SignalKind, signal};
    let mut pressed = signal(SignalKind::interrupt())?;
    let mut terminate = signal(SignalKind::terminate())?;
    let said = [
        "stopping when the parts inside are finished; once more stops at once",
        "stopping at once, outputs safe",
    ];
    for (flag, said) in flags.into_iter().zip(said) {
        tokio::select! {
            _ = pressed.recv() => {}
            _ = terminate.recv() => {}
        }
        flag.store(true, Ordering::Release);
        tracing::warn!("{said}");
    }
    Ok(())
}
