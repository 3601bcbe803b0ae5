//! The stream of events of a run, and the trait of its receivers.

use super::progress::{LotProgress, PartUnderWay};
use super::summary::Summary;
use cycle::Event;
use machine::dut::Calibration;
use machine::dut::experiment::Found;
use machine::handling::output::Landed;
use std::path::PathBuf;
use std::sync::OnceLock;
use tokio::sync::mpsc;

/// Event of a run, in order of occurrence.
#[derive(Debug)]
pub enum LotEvent {
    /// The run begins; the rig has received no request yet.
    Begun,
    /// An event of the control cycle.
    Cycle(Event),
    /// The record of a judged part is complete: the part has landed in a bin, or the run is over and the part will
    /// never land (`None`).
    PartDone(Box<PartUnderWay>, Option<Landed>),
    /// These files hold the traffic of every line and instrument before an alarm.
    TracesKept(Vec<PathBuf>),
    /// The run is over.
    Ended(Box<Summary>),
}

/// Receiver of the events of a run, such as the page, the terminal or the player of a script.
pub trait Subscriber {
    /// Receives an event, which `lot` already takes into account.
    fn receive(&mut self, event: &LotEvent, lot: &LotProgress<'_>);
}

/// Ignores every event.
impl Subscriber for () {
    fn receive(&mut self, _: &LotEvent, _: &LotProgress<'_>) {}
}

/// Passes every event to both subscribers, first to the left one.
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

/// Keeps the first calibration that a run reports.
impl Subscriber for OnceLock<Calibration> {
    fn receive(&mut self, event: &LotEvent, _: &LotProgress<'_>) {
        if let LotEvent::Cycle(Event::Calibrated(calibration)) = event {
            self.get_or_init(|| (**calibration).clone());
        }
    }
}

/// Keeps the findings of an experiment.
impl Subscriber for OnceLock<Found> {
    fn receive(&mut self, event: &LotEvent, _: &LotProgress<'_>) {
        if let LotEvent::Cycle(Event::Found(found)) = event {
            self.get_or_init(|| found.clone());
        }
    }
}

/// Passes the events of the cycle on to another task.
impl Subscriber for mpsc::UnboundedSender<Event> {
    fn receive(&mut self, event: &LotEvent, _: &LotProgress<'_>) {
        if let LotEvent::Cycle(event) = event {
            // Sending fails only after the receiver is gone, which then needs no events.
            let _ = self.send(event.clone());
        }
    }
}
