//! The stream of events of a run, and the trait of its receivers.

use super::progress::{LotProgress, PartUnderWay};
use super::summary::Summary;
use crate::cycle::Event;
use machine::dut::Calibration;
use machine::handling::output::Landed;
use std::path::PathBuf;
use std::sync::OnceLock;
use tokio::sync::mpsc;

/// Event of a run, in order of occurrence.
#[derive(Debug)]
pub enum LotEvent {
    /// The run begins; the rig has received nothing yet.
    Begun,
    /// An event of the control cycle.
    Cycle(Event),
    /// A judged part is done: it has landed, or the run is over and it never will.
    PartDone(Box<PartUnderWay>, Option<Landed>),
    /// These files hold the last traffic of every line before an alarm.
    TracesKept(Vec<PathBuf>),
    /// The run is over.
    Ended(Box<Summary>),
}

/// Receives the events of a run: a page, a terminal, a script.
pub trait Subscriber {
    /// Receives an event that `lot` already includes.
    fn receive(&mut self, event: &LotEvent, lot: &LotProgress<'_>);
}

/// Ignores every event.
impl Subscriber for () {
    fn receive(&mut self, _: &LotEvent, _: &LotProgress<'_>) {}
}

/// Passes every event to both, the first one first.
impl<A: Subscriber, B: Subscriber> Subscriber for (A, B) {
    fn receive(&mut self, event: &LotEvent, lot: &LotProgress<'_>) {
        self.0.receive(event, lot);
        self.1.receive(event, lot);
    }
}

impl<S: Subscriber + ?Sized> Subscriber for &mut S {
    fn receive(&mut self, event: &LotEvent, lot: &LotProgress<'_>) {
        (**self).receive(event, lot);
    }
}

/// Keeps the first calibration of a run.
impl Subscriber for OnceLock<Calibration> {
    fn receive(&mut self, event: &LotEvent, _: &LotProgress<'_>) {
        if let LotEvent::Cycle(Event::Calibrated(calibration)) = event {
            self.get_or_init(|| (**calibration).clone());
        }
    }
}

/// Passes the events of the cycle on to another task.
impl Subscriber for mpsc::UnboundedSender<Event> {
    fn receive(&mut self, event: &LotEvent, _: &LotProgress<'_>) {
        if let LotEvent::Cycle(event) = event {
            // A closed receiver needs no events.
            let _ = self.send(event.clone());
        }
    }
}
