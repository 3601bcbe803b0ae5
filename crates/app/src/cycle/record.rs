//! What a turn leaves for the record, event by event.

use super::{Cycle, Event};
use machine::station::turn::TurnOutput;
use units::RigTime;

impl Cycle {
    /// Everything that this turn has to tell, in order.
    pub(super) fn record(&mut self, now: RigTime, output: &mut TurnOutput) {
        for judged in output.record.parts.judged.drain(..) {
            self.tell(Event::Judged(Box::new(judged)));
        }
        for left in output.record.parts.left.drain(..) {
            self.tell(Event::Left(left));
        }
        for landed in output.record.parts.landed.drain(..) {
            self.tell(Event::Landed(landed));
        }
        if let Some(checked) = output.record.checked.take() {
            self.tell(Event::Checked(checked, now));
        }
        if let Some(calibration) = output.record.calibrated.take() {
            self.tell(Event::Calibrated(Box::new(calibration)));
        }
        if output.record.lot_began {
            self.tell(Event::LotBegan(now));
        }
        for interrupted in output.record.parts.interrupted.drain(..) {
            self.tell(Event::Interrupted(interrupted));
        }
        for alarm in output.record.alarms.drain(..) {
            self.tell(Event::Alarm(alarm, now));
        }
        if output.record.alarms_changed {
            let standing = self.station.annunciator().listed().to_vec();
            self.tell(Event::Standing(standing, now));
        }
        let inside = self.station.ledger().parts_to_find();
        let moved = std::mem::replace(&mut self.inside, inside) != inside;
        if moved || output.record.ending.is_some() {
            self.tell(Event::Inside(inside, self.station.uses()));
        }
        let state = self.station.outer();
        if std::mem::replace(&mut self.told, state) != state {
            self.tell(Event::State(state));
        }
    }

    /// Sends one event to the history.
    pub(super) fn tell(&self, event: Event) {
        // The receiver ends only with the program.
        let _ = self.links.events.send(event);
    }
}
