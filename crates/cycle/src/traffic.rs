//! Chooses the next transaction of a line: the poll of the emergency-stop contact when it is due, then writes, the
//! heartbeat, the measuring job, the scan.
//!
//! Every line has at most one transaction under way. Every second transaction of the contact's line polls the module
//! with the contact ([`super::scan_schedule`]).

use super::arrival;
use super::open_job::OpenJob;
use super::scan_schedule::{ScanPoll, ScanSchedule};
use bus::{Answer, Request};
use dcon::{Command, Common};
use machine::instrument::act::JobDone;
use machine::instrument::conversion::Converted;
use machine::instrument::query::Delivered;
use machine::rig::point::{DigitalIn, DigitalInput};
use machine::rig::wiring::{LineId, ModuleId, Wiring};
use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use texts::Message;
use tokio::sync::mpsc;
use units::{RigTime, Span};

/// Pause between two polls of inputs that motions need, on a line that the scan of the machine omits; much shorter than
/// the age at which an input counts as unread. No poll comes between the transactions of a measuring job.
const INTERLOCK_PERIOD: Span = Span::ms(100);
/// Largest number of commands that wait for one line; a verification queues far fewer.
const MAX_QUEUE: usize = 2_000;

fn reset_questions(wiring: &Wiring, line: LineId) -> Vec<Command> {
    wiring
        .modules_on(line)
        .map(|id| wiring.module(id))
        .filter(|module| module.model.has_outputs())
        .map(|module| Common::ReadResetStatus.to(module.address))
        .collect()
}

/// Returns the modules of a line, by address, that carry inputs of the machine, beams of bins, or contacts of sockets
/// and inputs of a fixture. On a rig with a feeder the scan omits the inputs of a fixture, which a test reads itself.
fn scanned_modules(wiring: &Wiring, line: LineId) -> BTreeSet<ModuleId> {
    let machine = DigitalIn::ALL.iter().copied().map(DigitalInput::from);
    let scanned = machine.chain(wiring.scanned_inputs());
    let modules = scanned.filter_map(|it| Some(wiring.wired_in(it)?.module));
    on_line(wiring, line, modules)
}

/// Returns the modules of a line with an input that a motion needs.
fn interlocked_modules(wiring: &Wiring, line: LineId) -> BTreeSet<ModuleId> {
    let inputs = wiring.interlocks.iter().map(|it| it.input);
    on_line(wiring, line, inputs.map(|it| wiring.digital_in(it).module))
}

fn on_line(
    wiring: &Wiring,
    line: LineId,
    modules: impl Iterator<Item = ModuleId>,
) -> BTreeSet<ModuleId> {
    let here = |module: &ModuleId| wiring.module(*module).line == line;
    modules.filter(here).collect()
}

/// The two queue ends of one line that the cycle holds.
#[derive(Debug)]
pub struct LineEnds {
    /// Line that the queues belong to.
    pub line: LineId,
    /// Carries requests to the task of the line; holds one.
    pub requests: mpsc::Sender<Request>,
    /// Carries the answers from the task of the line.
    pub answers: mpsc::Receiver<Answer>,
}

/// Purpose of a transaction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Writes outputs.
    Write {
        /// Module that is written.
        module: ModuleId,
        /// True when the measuring job waits for this write.
        job: bool,
    },
    /// Belongs to the measuring job.
    Job,
    /// Polls sensors of the machine.
    Scan,
    /// Verifies a setting at the start of a run.
    Check,
    /// Feeds the host watchdogs of the modules with the broadcast "host OK".
    Heartbeat,
}

struct Slot {
    ends: LineEnds,
    tries: u8,
    busy: Option<Purpose>,
    waiting: Option<Answer>,
    queue: VecDeque<(Command, Purpose)>,
    heartbeat_due: RigTime,
    scan_schedule: ScanSchedule,
    scan_due: RigTime,
    /// Polls of modules with an input that a motion needs and that the scan of the machine omits.
    interlocks: Vec<Command>,
    interlocks_due: RigTime,
    next_interlock: usize,
}

impl Slot {
    /// Returns the next poll of an input that a motion needs; `None` on a line without such an input.
    fn interlock_poll(&mut self) -> Option<Command> {
        let poll = self.interlocks.get(self.next_interlock).copied()?;
        self.next_interlock = (self.next_interlock + 1) % self.interlocks.len();
        Some(poll)
    }
}

/// Queues and open transactions of all lines.
pub struct Traffic {
    slots: Vec<Slot>,
    /// Measuring lines: those that carry points of a fixture.
    measuring: Vec<LineId>,
    heartbeat: Span,
    scan_period: Span,
    job: Option<OpenJob>,
    beam: Option<Command>,
    /// True while an actuator is not where it should be, perhaps because a module restarted: the scan then first reads
    /// the reset status of the modules.
    restart_check: bool,
    beam_line: LineId,
    scanning: bool,
    check_tries: u8,
    /// True once safe writes are queued; they precede even the poll of the emergency-stop contact.
    making_safe: bool,
    ticket: u64,
    now: RigTime,
}

impl Traffic {
    /// Creates the traffic of the lines, with empty queues and every heartbeat due.
    pub fn new(wiring: &Arc<Wiring>, lines: Vec<LineEnds>) -> Self {
        let estop = wiring.emergency_stop_module();
        let estop_line = wiring.module(estop).line;
        let slots = lines
            .into_iter()
            .map(|ends| {
                let scanned = scanned_modules(wiring, ends.line);
                let mut scan: Vec<ModuleId> = scanned.iter().copied().collect();
                scan.retain(|module| *module != estop);
                let interlocks = interlocked_modules(wiring, ends.line);
                let apart = interlocks.difference(&scanned).filter(|it| **it != estop);
                Slot {
                    interlocks: apart.map(|it| wiring.poll(*it)).collect(),
                    interlocks_due: RigTime(0),
                    next_interlock: 0,
                    tries: wiring.tries_on(ends.line),
                    busy: None,
                    waiting: None,
                    queue: VecDeque::new(),
                    heartbeat_due: RigTime(0),
                    scan_schedule: ScanSchedule::new(
                        (ends.line == estop_line).then(|| wiring.poll(estop)),
                        scan.into_iter().map(|m| wiring.poll(m)).collect(),
                        reset_questions(wiring, ends.line),
                    ),
                    scan_due: RigTime(0),
                    ends,
                }
            })
            .collect();
        Self {
            slots,
            measuring: wiring.measuring_lines(),
            heartbeat: Span::seconds(wiring.bus.heartbeat_ms / 1e3),
            scan_period: Span::seconds(wiring.bus.scan_period_ms / 1e3),
            job: None,
            beam: None,
            restart_check: false,
            beam_line: estop_line,
            scanning: false,
            check_tries: wiring.bus.tries,
            making_safe: false,
            ticket: 0,
            now: RigTime(0),
        }
    }

    /// Returns the measuring lines: those that carry points of a fixture.
    pub fn measuring_lines(&self) -> &[LineId] {
        &self.measuring
    }

    /// Returns, for every module with outputs on a measuring line, the command that reads its reset status.
    pub fn measuring_resets(&self) -> Vec<(LineId, Command)> {
        let slots = self.slots.iter();
        let measuring = slots.filter(|slot| self.measuring.contains(&slot.ends.line));
        let resets = |slot: &Slot| {
            let line = slot.ends.line;
            let resets = slot.scan_schedule.resets.clone();
            resets.into_iter().map(move |command| (line, command))
        };
        measuring.flat_map(resets).collect()
    }

    /// Returns how many times this line tries a command.
    pub fn tries(&self, line: LineId) -> u8 {
        self.slots
            .iter()
            .find(|slot| slot.ends.line == line)
            .map_or(1, |slot| slot.tries)
    }

    /// Sets the time at which this turn began.
    pub fn note_time(&mut self, now: RigTime) {
        self.now = now;
    }

    /// Starts the scan of the machine's sensors, on all lines.
    pub fn start_scan(&mut self) {
        self.scanning = true;
    }

    /// Stops the scan; from then on only queued commands and heartbeats go out.
    pub fn only_writes(&mut self) {
        self.scanning = false;
    }

    /// Appends a command to a line's queue.
    pub fn queue(&mut self, line: LineId, command: Command, purpose: Purpose) {
        if matches!(purpose, Purpose::Job | Purpose::Write { job: true, .. })
            && let Some(job) = &mut self.job
        {
            job.part_begun();
        }
        if let Some(slot) = self.slots.iter_mut().find(|slot| slot.ends.line == line) {
            slot.queue.push_back((command, purpose));
            assert!(slot.queue.len() <= MAX_QUEUE, "a queue grows without end");
        }
    }

    /// Adds the counter of a beam to the scan, or removes it.
    pub fn watch_beam(&mut self, command: Option<Command>) {
        self.beam = command;
    }

    /// Turns the restart check on or off. When it turns on, the scan first reads the reset status of every scanned
    /// module, so that the answers arrive before the debounce time of a sensor ends.
    pub fn check_restarts(&mut self, restart_check: bool) {
        if restart_check && !self.restart_check {
            for slot in &mut self.slots {
                slot.scan_schedule.require_resets();
            }
        }
        self.restart_check = restart_check;
    }

    /// Makes the scan poll the modules of these inputs most often and without rest; without any, it rests between polls.
    pub fn await_inputs(&mut self, inputs: &[DigitalIn], wiring: &Wiring) {
        for slot in &mut self.slots {
            let modules = inputs.iter().map(|it| wiring.digital_in(*it).module);
            let own = modules.filter(|it| wiring.module(*it).line == slot.ends.line);
            slot.scan_schedule.hurry(own.map(|it| wiring.poll(it)));
        }
    }

    /// Makes the measuring job wait until the lost write to this module is repeated.
    pub fn rewrite_for_job(&mut self, module: ModuleId) {
        if let Some(job) = &mut self.job {
            job.rewrites(module);
        }
    }

    /// Returns true if the measuring job waits for this module's write to be repeated; the wait is over with this call.
    pub fn is_rewrite_for_job(&mut self, module: ModuleId) -> bool {
        self.job.as_mut().is_some_and(|job| job.waits_for(module))
    }

    /// Begins a measuring job; panics while another one is open.
    pub fn begin_job(&mut self) {
        assert!(self.job.is_none(), "two measuring jobs at once");
        self.job = Some(OpenJob::default());
    }

    /// Drops the measuring job and all queued commands; returns the modules whose queued writes it dropped. Safe writes
    /// replace them.
    pub fn drop_all(&mut self) -> Vec<ModuleId> {
        self.job = None;
        self.making_safe = true;
        let slots = self.slots.iter_mut();
        let queued = slots.flat_map(|slot| std::mem::take(&mut slot.queue));
        let written = queued.filter_map(|(_, purpose)| match purpose {
            Purpose::Write { module, .. } => Some(module),
            Purpose::Job | Purpose::Scan | Purpose::Check | Purpose::Heartbeat => None,
        });
        written.collect()
    }

    /// Makes the measuring job fail for this reason.
    pub fn fail_job(&mut self, trouble: Message) {
        if let Some(job) = &mut self.job {
            job.fail(trouble);
        }
    }

    /// Makes the measuring job wait for one more query of an instrument.
    pub fn query_begun(&mut self) {
        if let Some(job) = &mut self.job {
            job.query_begun();
        }
    }

    /// Closes a query of the measuring job; after the last part, returns the result of the job.
    pub fn query_done(
        &mut self,
        position: usize,
        at: RigTime,
        result: Result<Delivered, Message>,
    ) -> Option<JobDone> {
        let done = self.job.as_mut()?.query_done(position, at, result)?;
        self.job = None;
        Some(done)
    }

    /// Makes the measuring job wait for a conversion.
    pub fn conversion_begun(&mut self) {
        if let Some(job) = &mut self.job {
            job.part_begun();
        }
    }

    /// Closes the conversion of the measuring job; returns the result of the job.
    pub fn conversion_done(&mut self, at: RigTime, converted: Converted) -> Option<JobDone> {
        let done = self.job.as_mut()?.conversion_done(at, converted)?;
        self.job = None;
        Some(done)
    }

    /// Returns the result of the measuring job if it needed no transaction, else `None`.
    pub fn job_if_empty(&mut self, now: RigTime) -> Option<JobDone> {
        let done = self.job.as_mut()?.if_empty(now)?;
        self.job = None;
        Some(done)
    }

    /// Closes one transaction of the measuring job; returns the result of the job after the last one, else `None`.
    pub fn job_part_done(&mut self, at: RigTime, trouble: Option<Message>) -> Option<JobDone> {
        let done = self.job.as_mut()?.part_done(at, trouble)?;
        self.job = None;
        Some(done)
    }

    /// Starts the next transaction on every idle line.
    pub fn dispatch(&mut self, now: RigTime) {
        let writes = |slot: &Slot| {
            slot.queue
                .iter()
                .any(|(_, it)| matches!(it, Purpose::Write { .. }))
        };
        self.making_safe &= self.slots.iter().any(writes);
        for index in 0..self.slots.len() {
            if self.slots[index].busy.is_some() {
                continue;
            }
            let Some((command, purpose)) = self.choose(index, now) else {
                continue;
            };
            self.ticket += 1;
            let slot = &mut self.slots[index];
            let tries = match purpose {
                Purpose::Check => self.check_tries,
                // The next poll is the repetition; several tries would hold up the heartbeat of the line.
                Purpose::Scan if slot.interlocks.contains(&command) => 1,
                Purpose::Write { .. } | Purpose::Job | Purpose::Scan | Purpose::Heartbeat => {
                    slot.tries
                }
            };
            let request = Request {
                ticket: self.ticket,
                command,
                tries,
            };
            // The queue holds one request and no transaction is under way, so there is room; a closed queue means that
            // the line's task has ended.
            if slot.ends.requests.try_send(request).is_ok() {
                slot.busy = Some(purpose);
            }
        }
    }

    fn choose(&mut self, index: usize, now: RigTime) -> Option<(Command, Purpose)> {
        let slot = &mut self.slots[index];
        let waits = slot.heartbeat_due <= now || !slot.queue.is_empty();
        if waits
            && self.scanning
            && !self.making_safe
            && let Some(poll) = slot.scan_schedule.contact()
        {
            return Some((poll, Purpose::Scan));
        }
        if waits {
            slot.scan_schedule.note_other();
        }
        let write = slot
            .queue
            .iter()
            .position(|(_, purpose)| matches!(purpose, Purpose::Write { .. }));
        if let Some(next) = write.and_then(|at| slot.queue.remove(at)) {
            return Some(next);
        }
        if slot.heartbeat_due <= now {
            slot.heartbeat_due = now + self.heartbeat;
            return Some((Command::HostOk, Purpose::Heartbeat));
        }
        if let Some(next) = slot.queue.pop_front() {
            return Some(next);
        }
        if !self.scanning {
            return None;
        }
        if self.job.is_none()
            && slot.interlocks_due <= now
            && let Some(poll) = slot.interlock_poll()
        {
            slot.interlocks_due = now + INTERLOCK_PERIOD;
            return Some((poll, Purpose::Scan));
        }
        if slot.scan_due > now {
            return None;
        }
        let beam = self.beam.filter(|_| slot.ends.line == self.beam_line);
        match slot.scan_schedule.next(beam, now)? {
            ScanPoll::Priority(command) => Some((command, Purpose::Scan)),
            ScanPoll::Other(command) => {
                slot.scan_due = match slot.scan_schedule.hurries() {
                    true => now,
                    false => now + self.scan_period,
                };
                Some((command, Purpose::Scan))
            }
        }
    }

    /// Returns the next answer that has arrived; `None` if there is none.
    pub fn next_answer(&mut self) -> Option<(LineId, Purpose, Answer)> {
        for slot in &mut self.slots {
            let Some(answer) = arrival::next((&mut slot.ends.answers, &mut slot.waiting)) else {
                continue;
            };
            assert!(slot.busy.is_some(), "an answer without a request");
            let purpose = slot.busy.take().unwrap_or(Purpose::Check);
            return Some((slot.ends.line, purpose, answer));
        }
        None
    }

    /// Resolves when an answer has arrived on any line.
    pub async fn answer(&mut self) {
        arrival::any(&mut self.slots, |slot| {
            let is_busy = slot.busy.is_some();
            is_busy.then_some((&mut slot.ends.answers, &mut slot.waiting))
        })
        .await;
    }

    /// Returns the first instant after `now` at which a heartbeat or a scan is due on an idle line.
    pub fn next_due(&self, now: RigTime) -> Option<RigTime> {
        self.slots
            .iter()
            .filter(|slot| slot.busy.is_none())
            .flat_map(|slot| {
                [
                    Some(slot.heartbeat_due),
                    self.scanning.then_some(slot.scan_due),
                    (self.scanning && !slot.interlocks.is_empty()).then_some(slot.interlocks_due),
                ]
            })
            .flatten()
            .filter(|due| *due > now)
            .min()
    }

    /// Returns true when nothing is queued or under way.
    pub fn is_quiet(&self) -> bool {
        self.slots
            .iter()
            .all(|slot| slot.busy.is_none() && slot.queue.is_empty())
    }
}
