//! Chooses the next program of each instrument: safe first, then the preparation, then the queries of the measuring
//! job.
//!
//! Every instrument has at most one program under way. A safe program, which makes the instrument safe, ends the one
//! under way; any other waits. A safe program goes out when the outputs of the modules are confirmed, at the latest
//! [`SAFE_AFTER`] after it became due.

use super::arrival;
use bus::instrument::{ProgramAnswer, ProgramRequest, Start};
use machine::instrument::query::Instrument;
use machine::rig::wiring::Wiring;
use scpi::Program;
use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use tokio::sync::mpsc;
use units::{RigTime, Span};

/// Longest time by which the outputs of the modules precede the safe programs of the instruments.
const SAFE_AFTER: Span = Span::ms(500);
/// Largest number of queries that wait for one instrument; a job has far fewer.
const MAX_QUEUE: usize = 1_000;
/// Tries of a safe program.
const SAFE_TRIES: u8 = 2;

/// The two queue ends of one instrument that the cycle holds.
#[derive(Debug)]
pub struct InstrumentEnds {
    /// Instrument that the queues belong to.
    pub instrument: Instrument,
    /// Carries requests to the task of the instrument; holds one.
    pub requests: mpsc::Sender<ProgramRequest>,
    /// Carries the answers from the task of the instrument.
    pub answers: mpsc::Receiver<ProgramAnswer>,
}

/// Part of an open program: one query of the measuring job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Part {
    /// Position in the job.
    pub at: usize,
    /// Name of the program.
    pub name: &'static str,
    /// Number of its values.
    pub values: usize,
}

/// The queries of the measuring job for one instrument, ready to run: joined to one program, because the link proves
/// the replies of each program.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OpenQuery {
    /// The queries in their order, at least one.
    pub parts: Vec<Part>,
    /// The commands of all queries.
    pub program: Program,
}

impl OpenQuery {
    /// Makes the program of one query.
    pub fn new(at: usize, name: &'static str, program: Program) -> Self {
        let values = program.values();
        Self {
            parts: vec![Part { at, name, values }],
            program,
        }
    }

    /// Appends a later query of the same instrument.
    pub fn append(&mut self, mut other: Self) {
        self.parts.append(&mut other.parts);
        self.program.append(other.program);
    }
}

/// Query whose values are on their way to the measuring job.
#[derive(Debug, Clone, Copy)]
pub(super) struct Deliverer {
    /// Instrument that has run the program.
    pub instrument: Instrument,
    /// Position in the job.
    pub at: usize,
    /// Name of the program.
    pub program: &'static str,
    /// Time at which the program ended.
    pub ended_at: RigTime,
}

/// Purpose of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Opens, identifies and sets up the instrument.
    Prepare,
    /// Queries of the measuring job.
    Query,
    /// Makes the instrument safe.
    Safe,
    /// A query whose job has been dropped.
    Dropped,
}

/// Whether an instrument is safe, or what it still has to run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Safety {
    /// No program has run since the instrument was made safe or set up.
    Safe,
    /// A program may have left the output of the instrument on.
    MayBeOn,
    /// The safe program is due since this time, with this number of tries left.
    Due(RigTime, u8),
}

struct Slot {
    ends: InstrumentEnds,
    safe_program: Program,
    /// True when the preparation is due.
    prepare: bool,
    is_ready: bool,
    queue: VecDeque<OpenQuery>,
    safety: Safety,
    busy: Option<(u64, Purpose)>,
    /// Queries of the program under way.
    parts: Vec<Part>,
    waiting: Option<ProgramAnswer>,
    /// Consecutive failures of each program that has failed.
    failures: BTreeMap<&'static str, u8>,
}

/// Queues and open programs of all instruments.
pub(super) struct Instruments {
    slots: Vec<Slot>,
    ticket: u64,
}

impl Instruments {
    /// Takes over the queues, one pair for each instrument of the wiring, in its order.
    pub fn new(wiring: &Arc<Wiring>, ends: Vec<InstrumentEnds>) -> Self {
        let wired: Vec<Instrument> = wiring.instrument_ids().collect();
        let given: Vec<Instrument> = ends.iter().map(|it| it.instrument).collect();
        assert_eq!(given, wired, "each instrument has its task");
        let slot = |ends: InstrumentEnds| Slot {
            safe_program: wiring.instrument(ends.instrument).profile.safe(),
            ends,
            prepare: false,
            is_ready: false,
            queue: VecDeque::new(),
            safety: Safety::Safe,
            busy: None,
            parts: Vec::new(),
            waiting: None,
            failures: BTreeMap::new(),
        };
        Self {
            slots: ends.into_iter().map(slot).collect(),
            ticket: 0,
        }
    }

    /// Makes the preparation of every instrument due.
    pub fn prepare_all(&mut self) {
        for slot in &mut self.slots {
            (slot.prepare, slot.is_ready) = (true, false);
        }
    }

    /// Notes the end of a preparation; after a failure `again` makes it due once more.
    pub fn prepared(&mut self, instrument: Instrument, is_ready: bool, again: bool) {
        let slot = &mut self.slots[instrument.index()];
        (slot.is_ready, slot.prepare) = (is_ready, again);
    }

    /// Drops preparations that have not ended, but no safe program; returns the instruments that are not ready.
    pub fn end_preparation(&mut self) -> Vec<Instrument> {
        let slots = self.slots.iter_mut().filter(|slot| !slot.is_ready);
        let unready = slots.map(|slot| {
            slot.prepare = false;
            if let Some((_, purpose @ Purpose::Prepare)) = &mut slot.busy {
                *purpose = Purpose::Dropped;
            }
            slot.ends.instrument
        });
        unready.collect()
    }

    /// Appends queries of the measuring job.
    pub fn queue(&mut self, instrument: Instrument, query: OpenQuery) {
        let queue = &mut self.slots[instrument.index()].queue;
        queue.push_back(query);
        assert!(queue.len() <= MAX_QUEUE, "a queue grows without end");
    }

    /// Removes the queries that wait for an instrument, because one before them failed; returns their positions.
    pub fn drop_queue(&mut self, instrument: Instrument) -> Vec<usize> {
        let queue = std::mem::take(&mut self.slots[instrument.index()].queue);
        let parts = queue.into_iter().flat_map(|it| it.parts);
        parts.map(|it| it.at).collect()
    }

    /// Returns the queries of the program that has ended.
    pub fn take_parts(&mut self, instrument: Instrument) -> Vec<Part> {
        std::mem::take(&mut self.slots[instrument.index()].parts)
    }

    /// Counts a failed query; returns the number of consecutive failures of this program.
    pub fn failed(&mut self, instrument: Instrument, program: &'static str) -> u8 {
        let failures = &mut self.slots[instrument.index()].failures;
        let times = failures.entry(program).or_default();
        *times = times.saturating_add(1);
        *times
    }

    /// Resets the count of a program after a query that succeeded.
    pub fn succeeded(&mut self, instrument: Instrument, program: &str) {
        self.slots[instrument.index()].failures.remove(program);
    }

    /// Drops every query, and makes the safe program due on each instrument whose output may be on.
    pub fn make_safe(&mut self, now: RigTime) {
        for slot in &mut self.slots {
            slot.queue.clear();
            if let Some((_, purpose @ Purpose::Query)) = &mut slot.busy {
                *purpose = Purpose::Dropped;
            }
            let is_under_way = matches!(slot.busy, Some((_, Purpose::Safe)));
            if slot.safety == Safety::MayBeOn && !is_under_way {
                slot.safety = Safety::Due(now, SAFE_TRIES);
            }
        }
    }

    /// Notes the end of a safe program; returns true when the instrument may still be on and no try is left.
    pub fn made_safe(&mut self, instrument: Instrument, is_safe: bool, now: RigTime) -> bool {
        let safety = &mut self.slots[instrument.index()].safety;
        let left = match *safety {
            Safety::Due(_, tries) => tries.saturating_sub(1),
            Safety::Safe | Safety::MayBeOn => 0,
        };
        assert!(
            matches!(*safety, Safety::Due(..)),
            "the end of a safe program that was not due"
        );
        *safety = match (is_safe, left) {
            (true, _) => Safety::Safe,
            (false, 0) => Safety::MayBeOn,
            (false, left) => Safety::Due(now, left),
        };
        *safety == Safety::MayBeOn
    }

    /// Yields the instruments whose output may be on.
    pub fn may_be_on(&self) -> impl Iterator<Item = Instrument> {
        let slots = self.slots.iter();
        let on = slots.filter(|slot| slot.safety != Safety::Safe);
        on.map(|slot| slot.ends.instrument)
    }

    /// Starts the next program of each instrument. `settled`: every output of the modules is confirmed.
    pub fn dispatch(&mut self, now: RigTime, settled: bool) {
        for slot in &mut self.slots {
            let is_safe_due = match slot.safety {
                Safety::Due(since, _) => settled || now >= since + SAFE_AFTER,
                Safety::Safe | Safety::MayBeOn => false,
            };
            let is_making_safe = matches!(slot.busy, Some((_, Purpose::Safe)));
            let next = if is_safe_due && !is_making_safe {
                Some((Purpose::Safe, slot.safe_program.clone()))
            } else if slot.busy.is_some() || matches!(slot.safety, Safety::Due(..)) {
                None
            } else if slot.prepare {
                Some((Purpose::Prepare, Program::default()))
            } else {
                let query = slot.queue.front();
                query.map(|it| (Purpose::Query, it.program.clone()))
            };
            let Some((purpose, program)) = next else {
                continue;
            };
            self.ticket += 1;
            let start = match purpose {
                Purpose::Safe => Start::Safe,
                Purpose::Prepare | Purpose::Query | Purpose::Dropped => Start::SetUp,
            };
            let request = ProgramRequest {
                ticket: self.ticket,
                program,
                start,
            };
            // There is room, because the task takes a request even while a program runs; a closed queue means that the
            // task has ended.
            if slot.ends.requests.try_send(request).is_err() {
                continue;
            }
            slot.busy = Some((self.ticket, purpose));
            match purpose {
                Purpose::Prepare => slot.prepare = false,
                Purpose::Query => {
                    slot.parts = slot.queue.pop_front().map_or_else(Vec::new, |it| it.parts);
                    slot.safety = Safety::MayBeOn;
                }
                Purpose::Safe | Purpose::Dropped => {}
            }
        }
    }

    /// Returns the next answer that has arrived; drops the answer of a program that a later request has ended.
    pub fn next_answer(&mut self) -> Option<(Instrument, Purpose, ProgramAnswer)> {
        for slot in &mut self.slots {
            while let Some(answer) = arrival::next((&mut slot.ends.answers, &mut slot.waiting)) {
                if let Some((_, purpose)) = slot.busy.take_if(|it| it.0 == answer.ticket) {
                    return Some((slot.ends.instrument, purpose, answer));
                }
            }
        }
        None
    }

    /// Resolves when an answer has arrived from any instrument.
    pub async fn answer(&mut self) {
        arrival::any(&mut self.slots, |slot| {
            let is_busy = slot.busy.is_some();
            is_busy.then_some((&mut slot.ends.answers, &mut slot.waiting))
        })
        .await;
    }

    /// Returns the first instant at which a safe program no longer waits for the outputs of the modules.
    pub fn next_due(&self, now: RigTime) -> Option<RigTime> {
        let due = self.slots.iter().filter_map(|slot| match slot.safety {
            Safety::Due(since, _) => Some(since + SAFE_AFTER),
            Safety::Safe | Safety::MayBeOn => None,
        });
        due.filter(|due| *due > now).min()
    }

    /// Returns true when nothing is due or under way.
    pub fn is_quiet(&self) -> bool {
        let is_quiet = |slot: &Slot| {
            let is_due = matches!(slot.safety, Safety::Due(..));
            slot.busy.is_none() && slot.queue.is_empty() && !slot.prepare && !is_due
        };
        self.slots.iter().all(is_quiet)
    }
}
