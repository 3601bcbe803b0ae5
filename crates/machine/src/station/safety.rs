//! Checks of every turn in any state, and reactions to alarms.

use super::Station;
use super::catalogue::{self, AlarmCode, ClearedBy, Reaction};
use super::line::Handling;
use super::orders::Refused;
use super::packml::{self, Command, On, State};
use super::trouble::Alarm;
use super::turn::{Ending, HistoryState, Inputs, TurnOutput};
use crate::dut::Reason;
use crate::dut::verdict::Verdict;
use crate::handling::ledger::Part;
use crate::handling::mechanism::SENSOR_AGE;
use crate::handling::output::{Interrupted, Judged};
use crate::handling::trouble::Trouble;
use crate::handling::{Move, Place};
use crate::rig::bin::Bin;
use crate::rig::image::Image;
use crate::rig::point::DigitalIn;
use texts::Message;
use units::{RigTime, Span};

/// Time after the start within which every safety input must have a sample.
pub(super) const FIRST_SCAN: Span = Span::ms(3000);
/// Time for which a beam must be dark for its bin to count as full; a falling part darkens it for 11 ms.
const FULL: Span = Span::ms(500);

/// Safety inputs of a rig with a feeder, each with the alarm for its open contact.
const FEEDER_INPUTS: [(DigitalIn, AlarmCode); 3] = [
    (DigitalIn::EmergencyStopOk, AlarmCode::EmergencyStop),
    (DigitalIn::DoorClosed, AlarmCode::DoorOpen),
    (DigitalIn::AirOk, AlarmCode::AirLost),
];
/// Safety inputs of a rig with a rack, which has no compressed air, each with its alarm.
const RACK_INPUTS: [(DigitalIn, AlarmCode); 2] = [
    (DigitalIn::EmergencyStopOk, AlarmCode::EmergencyStop),
    (DigitalIn::DoorClosed, AlarmCode::DoorOpen),
];
/// Longest time from the closing of the emergency-stop chain to full air pressure.
const PRESSURE_RETURNS: Span = Span::ms(2000);

impl Station {
    /// Checks sensors, motions, lines and the falling part.
    pub(super) fn look(
        &mut self,
        now: RigTime,
        inputs: &Inputs,
        stuck: Vec<Alarm>,
        output: &mut TurnOutput,
    ) {
        self.line.serials.readings(&inputs.readings);
        let found = self.watch_mechanism(now, inputs.image, output);
        let mut there = self.safety(now, inputs);
        there.extend(stuck);
        there.extend(self.full_bins(now, inputs.image));
        there.extend(self.still_starved(now, inputs.image));
        there.extend(inputs.history.alarm().cloned());
        there.extend(inputs.reader.clone());
        there.extend(inputs.fleet.iter().cloned());
        self.alarms.annunciator.sensed(&there);
        let trouble = &mut output.notes.trouble;
        if !packml::is_aborted(self.machine.state) {
            trouble.extend(found.into_iter().map(Alarm::from));
        }
        trouble.extend(inputs.bus.iter().cloned());
        trouble.extend(there);
        trouble.extend(self.worn());
        let reference = &mut self.lot.reference_left;
        if let Some((feeder, _, mut turn)) = self.line.at(now, inputs, output, reference, false) {
            feeder.confirm(&mut turn);
        }
        output.notes.take_over();
        for landed in &output.record.parts.landed {
            let serial = landed.part.serial.as_ref();
            self.line.serials.landed(serial, landed.bin);
        }
        let own = self.line.feeder();
        if own.is_some_and(|own| !own.dark.is_empty()) {
            self.alarms.timeouts.wait_for_bin();
        }
        if inputs.history == HistoryState::Waiting {
            self.alarms.timeouts.forget();
        }
        let feeder = self.line.feeder().map(|own| &own.feeder);
        let late = self
            .alarms
            .timeouts
            .look(now, self.machine.state, self.machine.mode, feeder);
        output.notes.trouble.extend(late);
    }

    /// Checks end sensors and motions of a feeder; returns the troubles.
    fn watch_mechanism(
        &mut self,
        now: RigTime,
        image: &Image,
        output: &mut TurnOutput,
    ) -> Vec<Trouble> {
        let Some(own) = self.line.feeder_mut() else {
            return Vec::new();
        };
        let mut found = own.mechanism.update(now, image);
        output.rig.motions.extend(found.motions);
        output.rig.awaited.extend(own.mechanism.awaited(now));
        output.rig.restart_check = own.mechanism.needs_restart_check(now);
        self.still_in_nest(now, image, &mut found.trouble);
        found.trouble
    }

    /// Reports a part as stuck in the nest, instead of dropped, if the gripper lost it before the handover.
    fn still_in_nest(&self, now: RigTime, image: &Image, found: &mut [Trouble]) {
        let there = !self.line.ledger.holds(Place::Gripper)
            && image.input(DigitalIn::NestPresent, now, SENSOR_AGE) == Some(true);
        let dropped = found.iter_mut().filter(|one| **one == Trouble::Dropped);
        for one in dropped.filter(|_| there) {
            *one = Trouble::Stuck;
        }
    }

    /// Returns an alarm for each safety input that is open, and one for the first unread input once all have been read
    /// before or the time for the first scan is over.
    fn safety(&mut self, now: RigTime, inputs: &Inputs) -> Vec<Alarm> {
        let image = inputs.image;
        let late = now.since(self.machine.began.unwrap_or(now)) > FIRST_SCAN;
        let (mut alarms, mut unread) = (Vec::new(), Vec::new());
        let door_may_open = self.line.batch().is_some_and(|it| !it.needs_closed_door());
        for (point, code) in self.safety_inputs().iter().copied() {
            let seen = match point {
                DigitalIn::EmergencyStopOk => image.emergency_stop_ok(now),
                other => image.input(other, now, SENSOR_AGE),
            };
            if point == DigitalIn::EmergencyStopOk && seen == Some(false) {
                self.alarms.chain_open = Some(now);
            }
            match seen {
                Some(true) => {}
                Some(false) if point == DigitalIn::AirOk && self.is_vented(now) => {}
                Some(false) if point == DigitalIn::DoorClosed && door_may_open => {}
                Some(false) => alarms.push(code.into()),
                None => unread.push(point),
            }
        }
        let others: &[DigitalIn] = match self.line.handling {
            Handling::Feeder(_) => &[
                DigitalIn::SortZUp,
                DigitalIn::NestPresent,
                DigitalIn::GripperPart,
            ],
            Handling::Batch(_) => &[DigitalIn::DoorLocked],
        };
        let all = unread.is_empty()
            && others
                .iter()
                .all(|point| image.input(*point, now, SENSOR_AGE).is_some());
        if let Some(point) = unread.first()
            && (late || self.alarms.sensed)
        {
            alarms.push(match inputs.host_late {
                Some(late) => {
                    let missed = Message::new("detail", "input").with("input", point);
                    Alarm::host_late(&missed, late)
                }
                None => Alarm::stale(*point),
            });
        }
        self.alarms.sensed |= all;
        alarms
    }

    /// Returns true when the emergency stop explains low air pressure: its chain is open, or has just closed while no
    /// actuator has to move.
    fn is_vented(&self, now: RigTime) -> bool {
        let rests = packml::is_aborted(self.machine.state)
            || matches!(self.machine.state, State::Stopped | State::Complete);
        let since = self.alarms.chain_open.map(|at| now.since(at));
        since == Some(Span(0)) || rests && since.is_some_and(|since| since <= PRESSURE_RETURNS)
    }

    fn full_bins(&mut self, now: RigTime, image: &Image) -> Vec<Alarm> {
        let mut alarms = Vec::new();
        let Some(own) = self.line.feeder_mut() else {
            return alarms;
        };
        for (bin, beam) in own.feeder.beams() {
            let dark = image.input(beam, now, SENSOR_AGE) == Some(true);
            let since = own.dark.iter().find(|(known, _)| *known == beam);
            match (dark, since.map(|(_, since)| *since)) {
                (true, None) => own.dark.push((beam, now)),
                (true, Some(since)) if now.since(since) >= FULL => {
                    alarms.push(Alarm::bin_full(bin));
                }
                (true, Some(_)) | (false, None) => {}
                (false, Some(_)) => own.dark.retain(|(known, _)| *known != beam),
            }
        }
        alarms
    }

    fn still_starved(&self, now: RigTime, image: &Image) -> Option<Alarm> {
        let listed = self.alarms.annunciator.listed().iter();
        let starved = listed
            .filter(|one| one.is_active())
            .any(|one| one.alarm.code == AlarmCode::MagazineEmpty);
        let parts = [DigitalIn::TrackLevel, DigitalIn::PocketPresent]
            .iter()
            .any(|point| image.input(*point, now, SENSOR_AGE) == Some(true));
        (starved && !parts).then(|| AlarmCode::MagazineEmpty.into())
    }

    /// Reacts to a motion that the guard refused: homing first tries another motion, any other state raises an alarm.
    pub fn refused(
        &mut self,
        movement: Move,
        refusal: &Message,
        now: RigTime,
        output: &mut TurnOutput,
    ) {
        if self.machine.state == State::Resetting
            && let Some(own) = self.line.feeder_mut()
            && own.recovery.refused(movement)
        {
            return;
        }
        output.notes.trouble.push(Alarm::refused(movement, refusal));
        self.raise_all(now, output);
        self.show(now, output);
    }

    /// Lists the alarms of this turn and reacts to them; adds the new ones to `output`.
    pub(super) fn raise_all(&mut self, now: RigTime, output: &mut TurnOutput) {
        for alarm in std::mem::take(&mut output.notes.trouble) {
            self.raise(alarm.clone(), now, output);
            self.react(&alarm, now, output);
        }
    }

    /// Lists an alarm; adds it to `output` if it is new.
    pub(super) fn raise(&mut self, alarm: Alarm, now: RigTime, output: &mut TurnOutput) {
        if self.alarms.annunciator.raise(&alarm, now) {
            output.record.alarms.push(alarm);
        }
    }

    /// Shows state and alarms on the stack light; notes in `output` whether the list of alarms has changed.
    pub(super) fn show(&mut self, now: RigTime, output: &mut TurnOutput) {
        let listed = self.alarms.annunciator.listed();
        let stack = self
            .alarms
            .lamps
            .show(now, self.machine.state, listed, output.rig.safe);
        // A rack has lamps of its own, which the batch switches.
        let has_stack = self.line.feeder().is_some();
        let stack = stack.into_iter().filter(|_| has_stack);
        output.rig.outputs.extend(stack);
        output.record.alarms_changed |= self.alarms.annunciator.take_changed();
    }

    fn react(&mut self, alarm: &Alarm, now: RigTime, output: &mut TurnOutput) {
        let (entry, name) = (alarm.code.entry(), alarm.code.name());
        if catalogue::NEEDS_CALIBRATION.contains(&alarm.code)
            && !packml::is_aborted(self.machine.state)
        {
            self.recalibrate();
        }
        match entry.reaction {
            Reaction::Abort => {
                let parked = matches!(self.machine.state, State::Stopped | State::Complete);
                if !(parked && entry.cleared_by == ClearedBy::Sensor) {
                    self.abort(&name, now, output);
                }
            }
            Reaction::Hold if !self.plan.attended => self.abort(&name, now, output),
            Reaction::Hold => self.rest(Command::Hold, now, output),
            Reaction::Suspend => {
                if self.machine.state == State::Execute {
                    self.machine.suspended_by_order = false;
                }
                self.rest(Command::Suspend, now, output);
            }
            Reaction::Nothing => {}
        }
    }

    fn rest(&mut self, command: Command, now: RigTime, output: &mut TurnOutput) {
        if packml::next(self.machine.state, On::Command(command)).is_some() {
            self.enter(command, now, output);
        }
    }

    /// Makes the outputs safe at once and interrupts the parts inside; ends an unattended run.
    pub(super) fn abort(&mut self, why: &str, now: RigTime, output: &mut TurnOutput) {
        if packml::is_aborted(self.machine.state) || self.machine.ended {
            return;
        }
        self.make_safe(why, now, output);
        self.enter(Command::Abort, now, output);
        if !self.plan.attended {
            self.end(Ending::Alarm, now, output);
        }
    }

    /// Makes the outputs safe and forgets every position.
    pub(super) fn make_safe(&mut self, why: &str, now: RigTime, output: &mut TurnOutput) {
        output.rig.motions.clear();
        if let Some(jog) = output.rig.jog.take() {
            output.answers[jog.answer] = Err(Refused::NotArrived);
        }
        output.rig.job = None;
        output.rig.safe = true;
        self.interrupt(why, now, output);
        self.line.cut_off(now);
    }

    /// Interrupts the parts in nest, gripper and untested sockets; they go to retest, and the row of a judged part says
    /// so.
    fn interrupt(&mut self, why: &str, now: RigTime, output: &mut TurnOutput) {
        let parts = &mut output.record.parts;
        for part in self.line.ledger.held_mut() {
            if part.interrupted.is_some() && part.bin == Some(Bin::RETEST) {
                continue;
            }
            let why = part.interrupt(why);
            let ordinal = part.ordinal;
            if part.bin.replace(Bin::RETEST).is_some() {
                parts.interrupted.push(Interrupted { ordinal, why });
                continue;
            }
            let mut judged = Judged::untested(part.clone(), Reason::interrupted(&why), now);
            if let Handling::Feeder(own) = &self.line.handling
                && let Some(test) = own.feeder.test()
            {
                judged.record = test.record();
                judged.judgements = test.judgements();
            }
            assert!(
                matches!(judged.verdict, Verdict::Void(_)),
                "an interrupted part has a verdict"
            );
            parts.judged.push(judged);
        }
        let to_retest = |part: &mut Part| part.bin == Some(Bin::RETEST);
        let all = self.line.ledger.held_mut().all(to_retest);
        assert!(all, "an interrupted part goes elsewhere");
    }
}

impl Station {
    /// Returns the safety inputs that this rig has, each with the alarm for its open contact.
    fn safety_inputs(&self) -> &'static [(DigitalIn, AlarmCode)] {
        match self.line.handling {
            Handling::Feeder(_) => &FEEDER_INPUTS,
            Handling::Batch(_) => &RACK_INPUTS,
        }
    }

    /// Returns true when every safety input has a sample later than `since`.
    pub(super) fn safety_was_read(&self, image: &Image, since: RigTime) -> bool {
        let read =
            |(point, _): &(DigitalIn, _)| image.input_at(*point).is_some_and(|at| at > since);
        self.safety_inputs().iter().all(read)
    }
}
