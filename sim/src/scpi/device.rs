//! An instrument seen from its interface: message queue, common commands, execution times, output queue.

use std::collections::VecDeque;

use super::instrument::{Instrument, Moment, Outcome};
use super::message::{Unit, units};
use super::status::{Failure, OPC, Status};
use crate::fault::instrument::{InstrumentFault as Fault, InstrumentFaults};

/// Time that a common command takes, microseconds.
const COMMON_US: u64 = 300;

/// Depth of the error queue.
const DEPTH: usize = 20;

/// One instrument behind its interface.
pub struct Device {
    /// Name in the file of instruments.
    pub name: String,
    /// Status registers and error queue.
    pub status: Status,
    /// Replies, terminators included, each with the instant at which it is complete, microseconds.
    pub outbox: VecDeque<(u64, Vec<u8>)>,
    instrument: Box<dyn Instrument>,
    messages: VecDeque<Message>,
    /// Reply to the present message so far.
    reply: Option<Vec<u8>>,
    /// True when the last reply was an indefinite one (`*IDN?`): no query may follow in this message.
    indefinite: bool,
    /// Query, or `*WAI`, that waits for the end of the measurement.
    waiting: Option<Unit>,
    /// True from `*OPC` until the measurement ends.
    complete: bool,
    free_us: u64,
    /// Instant of a power cycle that is still to happen.
    cycle_us: Option<u64>,
    /// True while the front panel has control.
    local: bool,
}

struct Message {
    at_us: u64,
    units: VecDeque<Result<Unit, Failure>>,
}

impl Device {
    /// Creates an instrument in its state at power-on.
    pub fn new(name: String, instrument: Box<dyn Instrument>) -> Self {
        Self {
            name,
            status: Status::new(DEPTH),
            outbox: VecDeque::new(),
            instrument,
            messages: VecDeque::new(),
            reply: None,
            indefinite: false,
            waiting: None,
            complete: false,
            free_us: 0,
            cycle_us: None,
            local: false,
        }
    }

    /// Returns from the front panel to remote control.
    pub fn release_panel(&mut self) {
        self.local = false;
    }

    /// Queues a message; it runs after all earlier ones.
    pub fn receive(&mut self, message: &[u8], at_us: u64, faults: &mut InstrumentFaults) {
        let mut strikes = |fault| faults.strikes(fault, &self.name, at_us).is_some();
        if strikes(Fault::ErrorsOverflow) {
            self.status.overflow();
        }
        self.local |= strikes(Fault::Local);
        if strikes(Fault::PowerCycle) {
            self.clear();
            self.cycle_us = Some(at_us);
            return;
        }
        let units: VecDeque<_> = units(message).into();
        if !units.is_empty() {
            self.messages.push_back(Message { at_us, units });
        }
    }

    /// Discards messages and replies, as a device clear does.
    pub fn clear(&mut self) {
        self.messages.clear();
        self.outbox.clear();
        self.reply = None;
        self.waiting = None;
        self.complete = false;
    }

    /// Checks whether a message or a waiting query is still in progress.
    pub fn is_busy(&self) -> bool {
        self.waiting.is_some() || !self.messages.is_empty()
    }

    /// Returns the next instant at which something happens inside the instrument.
    pub fn next_us(&self) -> Option<u64> {
        if self.cycle_us.is_some() {
            return self.cycle_us;
        }
        let job = self.instrument.next_us();
        [job, self.beside_us(job)].into_iter().flatten().min()
    }

    /// Returns the next instant at which something other than the job happens; `job` is the instant of the job's next
    /// step.
    fn beside_us(&self, job: Option<u64>) -> Option<u64> {
        let unit = match (&self.waiting, self.messages.front()) {
            (Some(_), _) => job.is_none().then_some(self.free_us),
            (None, Some(message)) => Some(self.free_us.max(message.at_us)),
            (None, None) => (self.complete && job.is_none()).then_some(self.free_us),
        };
        let watch = self.instrument.watch_us();
        [unit, watch].into_iter().flatten().min()
    }

    /// Returns an instant before which no further reply leaves; `None` when no message or query is pending.
    pub fn reply_us(&self) -> Option<u64> {
        match (&self.waiting, self.instrument.end_us()) {
            (Some(_), Some(end_us)) => Some(end_us),
            (Some(_), None) => self.next_us(),
            (None, _) => {
                let front = self.messages.front()?;
                Some(self.free_us.max(front.at_us))
            }
        }
    }

    /// Carries out what is due at `at`: a power cycle, steps of the measurement, or the next unit of a message. No
    /// other instrument acts before `end_us`. Leaves `at` at the last instant that it has carried out.
    pub fn tick(&mut self, at: &mut Moment<'_>, end_us: u64, faults: &mut InstrumentFaults) {
        let t_us = at.now_us;
        if self.cycle_us.take().is_some() {
            self.status = Status::new(DEPTH);
            self.local = false;
            self.free_us = t_us + self.instrument.reset(at);
            return;
        }
        if self.instrument.watch_us().is_some_and(|next| next <= t_us) {
            let failure = self.instrument.watch(at);
            failure.into_iter().for_each(|it| self.status.push(it));
            return;
        }
        let job = self.instrument.next_us();
        if job.is_some_and(|next| next <= t_us) {
            let alone_us = self.beside_us(job).unwrap_or(u64::MAX);
            self.instrument.run(at, end_us.min(alone_us));
            return;
        }
        if self.complete && self.instrument.next_us().is_none() {
            self.complete = false;
            self.status.event |= OPC;
        }
        if let Some(unit) = self.waiting.take() {
            let fetched = match unit.nodes[0].as_str() {
                "*OPC" => Ok(Outcome::Text("1".into(), 0)),
                "*WAI" => Ok(Outcome::Done(0)),
                _ => self.instrument.fetch(&unit),
            };
            self.conclude(&unit, fetched, t_us, faults);
        } else if self.messages.front().is_some_and(|it| it.at_us <= t_us)
            && let Some(unit) = self
                .messages
                .front_mut()
                .and_then(|it| it.units.pop_front())
        {
            match unit {
                Ok(unit) => {
                    let outcome = self.run(&unit, at);
                    self.conclude(&unit, outcome, t_us, faults);
                }
                Err(failure) => self.fail(failure),
            }
        }
        self.finish(t_us);
    }

    fn run(&mut self, unit: &Unit, at: &mut Moment<'_>) -> Result<Outcome, Failure> {
        if let Some(outcome) = self.common(unit, at)? {
            return Ok(outcome);
        }
        if self.local && !unit.query {
            return Err(Failure::LOCAL);
        }
        self.instrument.execute(unit, at)
    }

    /// Executes the commands that every instrument has.
    fn common(&mut self, unit: &Unit, at: &mut Moment<'_>) -> Result<Option<Outcome>, Failure> {
        let status = &mut self.status;
        let header = unit.nodes.join(":");
        let text = |number: String| Outcome::Text(number, COMMON_US);
        let mask = || unit.number(0, 0.0, 255.0, 0.0).map(|it| it.round() as u8);
        let outcome = match (header.as_str(), unit.query) {
            ("*IDN", true) => text(self.instrument.body().identity.clone()),
            ("*OPC", true) | ("*WAI", false) => Outcome::AfterJob,
            ("*OPC", false) => {
                self.complete = true;
                Outcome::Done(COMMON_US)
            }
            ("*CLS", false) => {
                status.clear();
                self.complete = false;
                Outcome::Done(COMMON_US)
            }
            ("*RST", false) => {
                self.complete = false;
                Outcome::Done(self.instrument.reset(at))
            }
            ("*ESE", false) => {
                status.event_enable = mask()?;
                Outcome::Done(COMMON_US)
            }
            ("*SRE", false) => {
                status.service_enable = mask()? & !(1 << 6);
                Outcome::Done(COMMON_US)
            }
            ("*ESE", true) => text(status.event_enable.to_string()),
            ("*SRE", true) => text(status.service_enable.to_string()),
            ("*ESR", true) => text(std::mem::take(&mut status.event).to_string()),
            ("*STB", true) => text(status.byte(!self.outbox.is_empty()).to_string()),
            ("*TST", true) => text("0".into()),
            (header, _) if !header.starts_with('*') => return Ok(self.system(unit)),
            (_, _) => match header.as_str() {
                "*TRG" | "*LANG" => return Ok(None),
                _ => return Err(Failure::UNDEFINED_HEADER),
            },
        };
        Ok(Some(outcome))
    }

    /// Executes the commands of `SYSTem` that every instrument has.
    fn system(&mut self, unit: &Unit) -> Option<Outcome> {
        let has = |pattern| unit.matches(pattern).is_some();
        let text = |text: String| Some(Outcome::Text(text, COMMON_US));
        match unit.query {
            true if has("SYSTem:ERRor[:NEXT]") => {
                let Failure(number, what) = self.status.next_error();
                text(format!("{number},\"{what}\""))
            }
            true if has("SYSTem:ERRor:COUNt") => text(self.status.errors().to_string()),
            true if has("SYSTem:VERSion") => text("1999.0".into()),
            false if has("SYSTem:CLEar") => {
                self.status.clear();
                Some(Outcome::Done(COMMON_US))
            }
            false if has("SYSTem:REMote") || has("SYSTem:RWLock") => {
                self.local = false;
                Some(Outcome::Done(COMMON_US))
            }
            false if has("SYSTem:LOCal") => {
                self.local = true;
                Some(Outcome::Done(COMMON_US))
            }
            true | false => None,
        }
    }

    fn conclude(
        &mut self,
        unit: &Unit,
        outcome: Result<Outcome, Failure>,
        t_us: u64,
        faults: &mut InstrumentFaults,
    ) {
        let latency_us = match unit.query {
            true => self.instrument.body().latency_us(),
            false => 0,
        };
        let (bytes, busy_us) = match outcome {
            Ok(Outcome::Done(busy_us)) => (None, busy_us),
            Ok(Outcome::Text(text, busy_us)) => {
                (Some(self.altered(unit, text, t_us, faults)), busy_us)
            }
            Ok(Outcome::Block(bytes, busy_us)) => (Some(bytes), busy_us),
            Ok(Outcome::AfterJob) => {
                self.waiting = Some(unit.clone());
                self.free_us = self.free_us.max(t_us);
                return;
            }
            Err(failure) => return self.fail(failure),
        };
        self.free_us = t_us + busy_us + latency_us;
        if let Some(bytes) = bytes {
            if std::mem::replace(&mut self.indefinite, unit.nodes[0] == "*IDN") {
                self.status.push(Failure::UNTERMINATED_INDEFINITE);
                return;
            }
            match &mut self.reply {
                Some(reply) => {
                    reply.push(b';');
                    reply.extend(bytes);
                }
                None => self.reply = Some(bytes),
            }
        }
        self.finish(t_us);
    }

    /// Returns the reply, altered when a fault strikes its content.
    fn altered(
        &self,
        unit: &Unit,
        text: String,
        t_us: u64,
        faults: &mut InstrumentFaults,
    ) -> Vec<u8> {
        let mut strikes = |fault| faults.strikes(fault, &self.name, t_us).is_some();
        let measured = ["READ", "FETC", "MEAS", "TRAC"];
        let measured = measured.iter().any(|word| unit.nodes[0].starts_with(word));
        match unit.nodes[0] == "*IDN" {
            true if strikes(Fault::WrongIdentity) => b"RELAYRIG,OTHER,0,0".to_vec(),
            false if measured && strikes(Fault::OverRange) => b"+9.9000000E+37".to_vec(),
            false if measured && strikes(Fault::NotANumber) => b"+9.9100000E+37".to_vec(),
            true | false => text.into_bytes(),
        }
    }

    /// Queues an error; a command error also discards the rest of the message.
    fn fail(&mut self, failure: Failure) {
        self.status.push(failure);
        if (-199..=-100).contains(&failure.0)
            && let Some(message) = self.messages.front_mut()
        {
            message.units.clear();
        }
    }

    /// Ends the present message after its last unit, and sends its reply.
    fn finish(&mut self, t_us: u64) {
        let ended = self.messages.front().is_some_and(|it| it.units.is_empty());
        if self.waiting.is_some() || !ended {
            return;
        }
        self.messages.pop_front();
        self.indefinite = false;
        if let Some(mut reply) = self.reply.take() {
            reply.push(b'\n');
            self.outbox.push_back((self.free_us.max(t_us), reply));
        }
    }
}
