//! Who may use a line next: writes first, then the heartbeat, the measuring job, and the scan.
//!
//! Every line has one transaction under way at most. The module with the emergency-stop contact is
//! every second transaction of its line's scan ([`super::scan_schedule`]).

use super::scan_schedule::{Next, ScanSchedule};
use super::underway::JobUnderway;
use bus::{Answer, Request};
use dcon::{Command, Common};
use machine::instrument::act::JobDone;
use machine::rig::point::{DigitalIn, DigitalInput};
use machine::rig::wiring::{LineId, ModuleId, Wiring};
use std::collections::{BTreeSet, VecDeque};
use std::future::poll_fn;
use std::sync::Arc;
use std::task::Poll;
use tokio::sync::mpsc;
use units::{RigTime, Span};

/// More commands than this wait on no line: every question of a verification, several times over.
const DEEPEST: usize = 2_000;

fn reset_questions(wiring: &Wiring, line: LineId) -> Vec<Command> {
    wiring
        .modules_on(line)
        .map(|id| wiring.module(id))
        .filter(|module| module.model.has_outputs())
        .map(|module| Common::ReadResetStatus.to(module.address))
        .collect()
}

/// Modules of a line that carry inputs of the machine or beams, by address; those of a fixture are read by its acts.
fn scanned_modules(wiring: &Wiring, line: LineId) -> Vec<ModuleId> {
    let machine = DigitalIn::ALL.iter().copied().map(DigitalInput::from);
    let beams = wiring.axis.bins().map(|bin| wiring.axis.beam(bin));
    let modules = machine.chain(beams).map(|it| wiring.digital_in(it).module);
    let modules: BTreeSet<ModuleId> = modules.collect();
    let here = |module: &ModuleId| wiring.module(*module).line == line;
    modules.into_iter().filter(here).collect()
}

/// The cycle's ends of a line's queues.
#[derive(Debug)]
pub struct LineEnds {
    /// Which line.
    pub line: LineId,
    /// To the line's task, one deep.
    pub requests: mpsc::Sender<Request>,
    /// From it.
    pub answers: mpsc::Receiver<Answer>,
}

/// What a transaction is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Output write; `job`: the measuring job waits for it.
    Write {
        /// Module written.
        module: ModuleId,
        /// The measuring job waits for it.
        job: bool,
    },
    /// Part of a measuring job.
    Job,
    /// Motion scan.
    Scan,
    /// Verification at the start.
    Check,
    /// Host OK.
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
}

/// All lines.
pub struct Traffic {
    slots: Vec<Slot>,
    /// Lines with points of a fixture.
    measuring: Vec<LineId>,
    heartbeat: Span,
    scan_period: Span,
    job: Option<JobUnderway>,
    beam: Option<Command>,
    /// An actuator is not where it should be: the scan asks first which modules have restarted.
    restart_check: bool,
    beam_line: LineId,
    scanning: bool,
    check_tries: u8,
    /// Safe writes are queued: they go before the contact.
    making_safe: bool,
    ticket: u64,
    now: RigTime,
}

impl Traffic {
    /// Nothing under way, every heartbeat due.
    pub fn new(wiring: &Arc<Wiring>, lines: Vec<LineEnds>) -> Self {
        let estop = wiring.emergency_stop_module();
        let estop_line = wiring.module(estop).line;
        let slots = lines
            .into_iter()
            .map(|ends| {
                let mut scan = scanned_modules(wiring, ends.line);
                scan.retain(|module| *module != estop);
                Slot {
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

    /// Lines with points of a fixture.
    pub fn measuring_lines(&self) -> &[LineId] {
        &self.measuring
    }

    /// Reset status of every module with outputs on the measuring lines.
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

    /// How often a command of this line is tried.
    pub fn tries(&self, line: LineId) -> u8 {
        self.slots
            .iter()
            .find(|slot| slot.ends.line == line)
            .map_or(1, |slot| slot.tries)
    }

    /// The time of this turn.
    pub fn note_time(&mut self, now: RigTime) {
        self.now = now;
    }

    /// From now on the motion sensors are scanned.
    pub fn start_scan(&mut self) {
        self.scanning = true;
    }

    /// From now on nothing but writes and heartbeats.
    pub fn only_writes(&mut self) {
        self.scanning = false;
    }

    /// Puts a command at the end of a line's queue.
    pub fn queue(&mut self, line: LineId, command: Command, purpose: Purpose) {
        if matches!(purpose, Purpose::Job | Purpose::Write { job: true, .. })
            && let Some(job) = &mut self.job
        {
            job.part_begun();
        }
        if let Some(slot) = self.slots.iter_mut().find(|slot| slot.ends.line == line) {
            slot.queue.push_back((command, purpose));
            assert!(slot.queue.len() <= DEEPEST, "a queue grows without end");
        }
    }

    /// Event counter to read with the scan, or none.
    pub fn watch_beam(&mut self, command: Option<Command>) {
        self.beam = command;
    }

    /// Turns the restart check on or off. When it turns on, the scan asks every scanned module at once whether it has
    /// restarted, so that the answers arrive before the debounce time of a sensor ends.
    pub fn check_restarts(&mut self, restart_check: bool) {
        if restart_check && !self.restart_check {
            for slot in &mut self.slots {
                slot.scan_schedule.ask_for_resets();
            }
        }
        self.restart_check = restart_check;
    }

    /// A lost write of the job will be written again; the job waits for it.
    pub fn rewrite_for_job(&mut self, module: ModuleId) {
        if let Some(job) = &mut self.job {
            job.rewrites(module);
        }
    }

    /// True once for a module whose lost write the job waits for.
    pub fn is_rewrite_for_job(&mut self, module: ModuleId) -> bool {
        self.job.as_mut().is_some_and(|job| job.waits_for(module))
    }

    /// A new measuring job.
    pub fn begin_job(&mut self) {
        assert!(self.job.is_none(), "two measuring jobs at once");
        self.job = Some(JobUnderway::default());
    }

    /// Forgets the job and everything that was queued, writes too: safe ones come in their place, and before any poll.
    /// Gives the module of each write that was forgotten.
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

    /// A job that needed no transaction is done at once.
    pub fn job_if_empty(&mut self, now: RigTime) -> Option<JobDone> {
        let done = self.job.as_ref()?.if_empty(now)?;
        self.job = None;
        Some(done)
    }

    /// One transaction of the job is over; the answer of the job when it was the last.
    pub fn job_part_done(&mut self, at: RigTime, trouble: Option<String>) -> Option<JobDone> {
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
                Purpose::Write { .. } | Purpose::Job | Purpose::Scan | Purpose::Heartbeat => {
                    slot.tries
                }
            };
            let request = Request {
                ticket: self.ticket,
                command,
                tries,
            };
            // The queue is one deep and the slot idle, so there is room; a closed queue means the line's task ended.
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
            slot.scan_schedule.something_else();
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
        if !self.scanning || slot.scan_due > now {
            return None;
        }
        let beam = self.beam.filter(|_| slot.ends.line == self.beam_line);
        match slot.scan_schedule.next(beam)? {
            Next::Priority(command) => Some((command, Purpose::Scan)),
            Next::Other(command) => {
                slot.scan_due = now + self.scan_period;
                Some((command, Purpose::Scan))
            }
        }
    }

    /// The next answer that has come in.
    pub fn next_answer(&mut self) -> Option<(LineId, Purpose, Answer)> {
        for slot in &mut self.slots {
            let Some(answer) = slot
                .waiting
                .take()
                .or_else(|| slot.ends.answers.try_recv().ok())
            else {
                continue;
            };
            assert!(slot.busy.is_some(), "an answer that nobody asked for");
            let purpose = slot.busy.take().unwrap_or(Purpose::Check);
            return Some((slot.ends.line, purpose, answer));
        }
        None
    }

    /// Resolves when an answer has come in on any line.
    pub async fn answer(&mut self) {
        let slots = &mut self.slots;
        poll_fn(|context| {
            for slot in slots.iter_mut().filter(|slot| slot.busy.is_some()) {
                if slot.waiting.is_some() {
                    return Poll::Ready(());
                }
                if let Poll::Ready(Some(answer)) = slot.ends.answers.poll_recv(context) {
                    slot.waiting = Some(answer);
                    return Poll::Ready(());
                }
            }
            Poll::Pending
        })
        .await;
    }

    /// When an idle line has something to do without being asked.
    pub fn next_due(&self, now: RigTime) -> Option<RigTime> {
        self.slots
            .iter()
            .filter(|slot| slot.busy.is_none())
            .flat_map(|slot| {
                [
                    Some(slot.heartbeat_due),
                    self.scanning.then_some(slot.scan_due),
                ]
            })
            .flatten()
            .filter(|due| *due > now)
            .min()
    }

    /// Nothing queued, nothing under way.
    pub fn is_quiet(&self) -> bool {
        self.slots
            .iter()
            .all(|slot| slot.busy.is_none() && slot.queue.is_empty())
    }
}
