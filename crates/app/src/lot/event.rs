//! The stream of events of a run, and who hears it.

use super::progress::{LotProgress, PartUnderWay};
use super::summary::Summary;
use crate::cycle::Event;
use machine::dut::Calibration;
use machine::handling::output::Landed;
use std::path::PathBuf;
use std::sync::OnceLock;
use tokio::sync::mpsc;

/// What happens in a run, in order.
#[derive(Debug)]
pub enum LotEvent {
    /// The run begins; nothing was sent to the rig yet.
    Begun,
    /// The cycle tells this.
    Cycle(Event),
    /// Nothing more happens to a judged part: it has landed, or the run is over and it never will.
    PartDone(Box<PartUnderWay>, Option<Landed>),
    /// The last traffic of every line before an alarm is in these files.
    TracesKept(Vec<PathBuf>),
    /// The run is over.
    Ended(Box<Summary>),
}

/// Receives the events of a run: a page, a terminal, a script.
pub trait Subscriber {
    /// Hears an event that `lot` has already taken in.
    fn hear(&mut self, event: &LotEvent, lot: &LotProgress<'_>);
}

/// Ignores every event.
impl Subscriber for () {
    fn hear(&mut self, _: &LotEvent, _: &LotProgress<'_>) {}
}

/// Both hear every event, the first one first.
impl<A: Subscriber, B: Subscriber> Subscriber for (A, B) {
    fn hear(&mut self, event: &LotEvent, lot: &LotProgress<'_>) {
        self.0.hear(event, lot);
        self.1.hear(event, lot);
    }
}

impl<S: Subscriber + ?Sized> Subscriber for &mut S {
    fn hear(&mut self, event: &LotEvent, lot: &LotProgress<'_>) {
        (**self).hear(event, lot);
    }
}

/// Keeps the first calibration of a run.
impl Subscriber for OnceLock<Calibration> {
    fn hear(&mut self, event: &LotEvent, _: &LotProgress<'_>) {
        if let LotEvent::Cycle(Event::Calibrated(calibration)) = event {
            self.get_or_init(|| (**calibration).clone());
        }
    }
}

/// Passes the events of the cycle on to another task.
impl Subscriber for mpsc::UnboundedSender<Event> {
    fn hear(&mut self, event: &LotEvent, _: &LotProgress<'_>) {
        if let LotEvent::Cycle(event) = event {
            // One who has gone misses nothing.
            let _ = self.send(event.clone());
        }
    }
}
