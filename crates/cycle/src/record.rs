//! Sends the events of a turn to the history.

use super::{Cycle, Event};
use machine::station::turn::TurnOutput;
use units::RigTime;

impl Cycle {
    /// Sends all events of this turn, in order of occurrence.
    pub(super) fn record(&mut self, now: RigTime, output: &mut TurnOutput) {
        for judged in output.record.parts.judged.drain(..) {
            self.send(Event::Judged(Box::new(judged)));
        }
        if let Some(ended) = output.record.parts.batch.take() {
            self.send(Event::BatchEnded(ended));
        }
        for left in output.record.parts.left.drain(..) {
            self.send(Event::Left(left));
        }
        for landed in output.record.parts.landed.drain(..) {
            self.send(Event::Landed(landed));
        }
        if let Some(checked) = output.record.checked.take() {
            self.send(Event::Checked(checked, now));
        }
        if let Some(calibration) = output.record.calibrated.take() {
            self.send(Event::Calibrated(Box::new(calibration)));
        }
        if let Some(found) = output.record.parts.found.take() {
            self.send(Event::Found(found));
        }
        for broken in output.record.broken.drain(..) {
            self.send(Event::PromiseBroken(broken));
        }
        if let Some(prompt) = output.record.prompted.take() {
            self.send(Event::Prompted(Box::new(prompt)));
        }
        if output.record.lot_began {
            self.send(Event::LotBegan(now));
        }
        for interrupted in output.record.parts.interrupted.drain(..) {
            self.send(Event::Interrupted(interrupted));
        }
        for alarm in output.record.alarms.drain(..) {
            self.send(Event::Alarm(alarm, now));
        }
        if output.record.alarms_changed {
            let listed = self.station.annunciator().listed().to_vec();
            self.send(Event::ListedAlarms(listed, now));
        }
        let inside = self.station.ledger().parts_to_find();
        let moved = std::mem::replace(&mut self.inside, inside) != inside;
        if moved || output.record.ending.is_some() {
            self.send(Event::Inside(inside, self.station.uses()));
        }
        let state = self.station.outer();
        if std::mem::replace(&mut self.published_state, state) != state {
            self.send(Event::State(state));
        }
    }

    /// Sends one event to the history.
    pub(super) fn send(&self, event: Event) {
        // The receiver outlives the run.
        let _ = self.links.events.send(event);
    }
}
