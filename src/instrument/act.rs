//! What a test stage is made of: acts, each one transaction on the measuring line or one wait.
//!
//! A stage writes its acts down as a list before it begins; [`Runner`] carries them out and keeps what
//! was read. So the order of a test can be read, printed and replayed, and no stage ever holds the bus.

use super::trace::Trace;
use crate::rig::image::Image;
use crate::rig::point::{AnalogIn, AnalogOut, Counter, DigitalIn, DigitalOut, Temperature};
use crate::rig::sample::{CountSample, Sample};
use crate::units::{RigTime, Span, Volt};

/// What follows an awaited event is sent within so long after the last look that had not shown it yet: a poll, a reading,
/// the write. Where a request is lost and asked again, or the line is slow, a ramp is sent later and ends later by as
/// much; one that turns round has gone on meanwhile, and needs as long again to come back.
const PROMPT: Span = Span::ms(13);

/// What one transaction (or one pair, for the gates) brings in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Read {
    /// All inputs of the interface board.
    Board,
    /// The enabled channels of the coil converter, one scan.
    Coil,
    /// One channel of it, in little more than half the time.
    Current(AnalogIn),
    /// The contact drop.
    Drop,
    /// Both gate counters.
    Gates,
    /// Gate counter 0 alone: all that a ramp needs. Kept beside what counter 1 last was.
    Gate,
    /// Temperature of the magazine track, which the part has.
    Track,
    /// Whether a module with outputs has restarted since it was asked last; one that has is an alarm.
    Resets,
}

/// One step of a stage.
#[derive(Debug, Clone, PartialEq)]
pub enum Act {
    /// Outputs of the interface board, written together.
    Board(Vec<(DigitalOut, bool)>),
    /// Voltages asked of the supply outputs, in volts of the coil, written one after the other.
    Supply(Vec<(AnalogOut, Volt)>),
    /// One reading.
    Read(Read),
    /// Channel mask of the coil converter; only while a lot is prepared.
    CoilMask(u8),
    /// Remembers this instant for [`Act::WaitSinceMark`].
    Mark,
    /// Waits until so much time has passed since the mark.
    WaitSinceMark(Span),
    /// Waits as [`Act::WaitSinceMark`] does, for a ramp that was sent behind the mark: longer if that was late.
    RampSinceMark(Span),
    /// Waits so long after the previous act was answered.
    Wait(Span),
    /// Waits as [`Act::WaitSinceMark`] does, for a conversion that began after the mark.
    ConvertSinceMark(Span),
    /// Reads the board until the point is active, or gives up; which of both is kept.
    Until {
        /// Point of the interface board.
        point: DigitalIn,
        /// Longest wait.
        within: Span,
    },
}

impl Act {
    /// The supply begins to ramp and is not waited for.
    fn is_ramp(&self) -> bool {
        let ramps = |output: &AnalogOut| *output != AnalogOut::SupplyLevel;
        matches!(self, Self::Supply(outputs) if outputs.iter().any(|(output, _)| ramps(output)))
    }
}

/// Work for the measuring line.
#[derive(Debug, Clone, PartialEq)]
pub enum Job {
    /// See [`Act::Board`].
    Board(Vec<(DigitalOut, bool)>),
    /// See [`Act::Supply`].
    Supply(Vec<(AnalogOut, Volt)>),
    /// See [`Read`].
    Read(Read),
    /// Channel mask of the coil converter; only while a lot is prepared, never during a lot.
    CoilMask(u8),
}

/// Answer to a [`Job`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JobDone {
    /// When the last reply of the job was complete.
    pub at: RigTime,
    /// Why it failed: line, address, command, how often.
    pub trouble: Option<String>,
}

/// Inputs of the interface board at one instant; `None` is never read as open or closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoardInputs {
    /// Coil A, coil B, COM, NO, NC: force to sense below 5 ohm.
    pub kelvin: [bool; 5],
    /// Normally open contact is made.
    pub no_closed: bool,
    /// Normally closed contact is made.
    pub nc_closed: bool,
    /// The contact source cannot drive its current.
    pub compliance: bool,
    /// Probes are up, by the hard-wired chain.
    pub probe_chain: bool,
}

impl BoardInputs {
    /// From the image, provided every bit was read at or after `since`.
    fn take(image: &Image, now: RigTime) -> Option<Self> {
        let get = |point| image.answered_input(point, now);
        Some(Self {
            kelvin: [
                get(DigitalIn::KelvinCoilA)?,
                get(DigitalIn::KelvinCoilB)?,
                get(DigitalIn::KelvinCom)?,
                get(DigitalIn::KelvinNo)?,
                get(DigitalIn::KelvinNc)?,
            ],
            no_closed: get(DigitalIn::NoClosed)?,
            nc_closed: get(DigitalIn::NcClosed)?,
            compliance: get(DigitalIn::SourceCompliance)?,
            probe_chain: get(DigitalIn::ProbeChain)?,
        })
    }
}

/// One scan of the coil converter; a channel that is masked out is `None`.
#[derive(Debug, Clone)]
pub struct CoilScan {
    /// Coil voltage, up to 6 V.
    pub voltage_fine: Option<Sample>,
    /// Coil current, up to 16 mA.
    pub current_fine: Option<Sample>,
    /// Coil current, up to 50 mA.
    pub current_wide: Option<Sample>,
    /// The 5 V reference.
    pub reference: Option<Sample>,
}

/// Everything a stage has read, in order, by kind.
#[derive(Debug, Clone, Default)]
pub struct Readings {
    /// Board inputs.
    pub boards: Vec<BoardInputs>,
    /// Scans of the coil converter.
    pub coil: Vec<CoilScan>,
    /// Coil currents read by themselves.
    pub currents: Vec<Sample>,
    /// Contact drops.
    pub drops: Vec<Sample>,
    /// Gate counters 0 and 1.
    pub gates: Vec<[CountSample; 2]>,
    /// Outcomes of [`Act::Until`].
    pub seen: Vec<bool>,
    /// Track temperatures.
    pub track: Vec<Sample>,
    /// All of it sample by sample, and what was asked of the outputs.
    pub trace: Trace,
}

/// What the runner asks of its surroundings.
#[derive(Debug, Clone, PartialEq)]
pub enum Doing {
    /// Start this job; answer with [`JobDone`].
    Job(Job),
    /// A job is under way.
    Busy,
    /// Nothing to do before this instant.
    Wait(RigTime),
    /// All acts are done.
    Done,
    /// A job failed; the stage cannot be judged.
    Trouble(String),
}

/// Where the time of a test goes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Spent {
    /// Transactions.
    pub bus: Span,
    /// Waiting for coil, armature, source and bounce to settle.
    pub settling: Span,
    /// Waiting for conversions.
    pub conversion: Span,
    /// Waiting for contact events, on ramps and timed operations.
    pub ramp: Span,
    /// The same acts on a bus that takes no time: settling, conversions and events alone.
    pub bound: Span,
}

impl Spent {
    /// Adds the time of another stage.
    pub fn add(&mut self, other: Spent) {
        self.bus += other.bus;
        self.settling += other.settling;
        self.conversion += other.conversion;
        self.ramp += other.ramp;
        self.bound += other.bound;
    }
}

/// Carries out the acts of one stage.
#[derive(Debug)]
pub struct Runner {
    acts: std::vec::IntoIter<Act>,
    current: Option<Act>,
    pending: bool,
    began: RigTime,
    since: RigTime,
    mark: RigTime,
    /// How long ago the mark would be on a bus that takes no time.
    since_mark: Span,
    /// Of the point that is waited for, or was: the last look that did not show it.
    looked: Option<RigTime>,
    /// From when on what was marked may have happened.
    marked_from: RigTime,
    /// By how much a ramp behind the mark was sent late.
    late: Span,
    spent: Spent,
    /// What was read so far.
    pub readings: Readings,
}

impl Runner {
    /// A runner that begins now.
    pub fn new(acts: Vec<Act>, now: RigTime) -> Self {
        let mut acts = acts.into_iter();
        let current = acts.next();
        Self {
            acts,
            current,
            pending: false,
            began: now,
            since: now,
            mark: now,
            since_mark: Span(0),
            looked: None,
            marked_from: now,
            late: Span(0),
            spent: Spent::default(),
            readings: Readings::default(),
        }
    }

    /// True when nothing is left to do.
    pub fn is_done(&self) -> bool {
        self.current.is_none() && !self.pending
    }

    /// A runner that begins now and remembers what the one before it marked and counted: a mark outlives
    /// its stage, and counters that stand still need not be read twice.
    pub fn after(
        acts: Vec<Act>,
        now: RigTime,
        before: &Runner,
        gates: Option<[CountSample; 2]>,
    ) -> Self {
        let mut runner = Self::new(acts, now);
        runner.mark = before.mark;
        runner.since_mark = before.since_mark;
        (runner.marked_from, runner.late) = (before.marked_from, before.late);
        runner.readings.gates.extend(gates);
        runner
    }

    /// Goes on as far as it can. `done` answers the job asked for before, once.
    pub fn step(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> Doing {
        if self.pending {
            let Some(done) = done else { return Doing::Busy };
            if let Some(trouble) = &done.trouble {
                return Doing::Trouble(trouble.clone());
            }
            self.pending = false;
            self.since = done.at;
            if let Err(trouble) = self.keep(image, now) {
                return Doing::Trouble(trouble);
            }
        }
        while let Some(act) = &self.current {
            match act {
                Act::Board(outputs) => return self.ask(Job::Board(outputs.clone())),
                Act::Supply(outputs) => return self.ask(Job::Supply(outputs.clone())),
                Act::Read(read) => return self.ask(Job::Read(*read)),
                Act::CoilMask(mask) => return self.ask(Job::CoilMask(*mask)),
                Act::Until { .. } => return self.ask(Job::Read(Read::Board)),
                Act::Mark => {
                    self.mark = self.since;
                    self.marked_from = self.looked.take().unwrap_or(self.since);
                    self.late = Span(0);
                    self.next();
                }
                Act::Wait(span) => {
                    let until = self.since + *span;
                    if now < until {
                        return Doing::Wait(until);
                    }
                    self.since = until;
                    self.next();
                }
                Act::WaitSinceMark(span)
                | Act::RampSinceMark(span)
                | Act::ConvertSinceMark(span) => {
                    let ramps = matches!(act, Act::RampSinceMark(_));
                    let longer = if ramps {
                        self.late + self.late
                    } else {
                        Span(0)
                    };
                    let until = self.mark + *span + longer;
                    if now < until {
                        return Doing::Wait(until);
                    }
                    self.since = self.since.max(until);
                    self.next();
                }
            }
        }
        Doing::Done
    }

    fn ask(&mut self, job: Job) -> Doing {
        self.pending = true;
        Doing::Job(job)
    }

    /// Where the time went so far.
    pub fn spent(&self) -> Spent {
        self.spent
    }

    fn next(&mut self) {
        let took = self.since.since(self.began);
        let least = match &self.current {
            Some(Act::Wait(span)) => *span,
            Some(
                Act::WaitSinceMark(span) | Act::RampSinceMark(span) | Act::ConvertSinceMark(span),
            ) => Span(span.0.saturating_sub(self.since_mark.0)),
            Some(Act::Until { .. }) => took,
            Some(Act::Board(_) | Act::Supply(_) | Act::Read(_) | Act::CoilMask(_) | Act::Mark)
            | None => Span(0),
        };
        self.spent.bound += least;
        self.since_mark = match &self.current {
            Some(Act::Mark) => Span(0),
            Some(_) | None => self.since_mark + least,
        };
        if !matches!(&self.current, Some(Act::Until { .. } | Act::Mark)) {
            self.looked = None;
        }
        match &self.current {
            Some(Act::Board(_) | Act::Supply(_) | Act::Read(_) | Act::CoilMask(_)) => {
                self.spent.bus += took
            }
            Some(Act::Wait(_) | Act::WaitSinceMark(_) | Act::RampSinceMark(_)) => {
                self.spent.settling += took
            }
            Some(Act::ConvertSinceMark(_)) => self.spent.conversion += took,
            Some(Act::Until { .. }) => self.spent.ramp += took,
            Some(Act::Mark) | None => {}
        }
        self.current = self.acts.next();
        self.began = self.since;
    }

    /// Takes in what the finished job brought, and moves on unless a condition is still awaited.
    fn keep(&mut self, image: &Image, now: RigTime) -> Result<(), String> {
        match self.current.clone() {
            Some(Act::Read(read)) => self.take(read, image, now)?,
            Some(Act::Until { point, within }) => {
                let active = image
                    .answered_input(point, now)
                    .ok_or("a board input is stale")?;
                let inputs = BoardInputs::take(image, now).ok_or("a board input is stale")?;
                self.readings.trace.board(&inputs, self.since);
                if !active && self.since.since(self.began) < within {
                    self.looked = Some(self.since);
                    return Ok(());
                }
                self.looked.get_or_insert(self.began);
                self.readings.boards.push(inputs);
                self.readings.seen.push(active);
            }
            Some(act @ (Act::Board(_) | Act::Supply(_))) => {
                self.readings.trace.asked(&act, self.since);
                if act.is_ramp() {
                    let after = self.since.since(self.marked_from);
                    self.late = self.late.max(Span(after.0.saturating_sub(PROMPT.0)));
                }
            }
            Some(
                Act::CoilMask(_)
                | Act::Mark
                | Act::Wait(_)
                | Act::WaitSinceMark(_)
                | Act::RampSinceMark(_)
                | Act::ConvertSinceMark(_),
            )
            | None => {}
        }
        self.next();
        Ok(())
    }

    fn take(&mut self, read: Read, image: &Image, now: RigTime) -> Result<(), String> {
        let missing = || format!("{read:?} was answered without a value");
        match read {
            Read::Board => {
                let inputs = BoardInputs::take(image, now).ok_or_else(missing)?;
                self.readings.trace.board(&inputs, self.since);
                self.readings.boards.push(inputs);
            }
            Read::Coil => {
                let scan = CoilScan {
                    voltage_fine: image.analog(AnalogIn::CoilVoltageFine).cloned(),
                    current_fine: image.analog(AnalogIn::CoilCurrentFine).cloned(),
                    current_wide: image.analog(AnalogIn::CoilCurrent).cloned(),
                    reference: image.analog(AnalogIn::ReferenceVoltage).cloned(),
                };
                self.readings.trace.scan(&scan);
                self.readings.coil.push(scan);
            }
            Read::Current(channel) => {
                let current = image.analog(channel).ok_or_else(missing)?;
                self.readings.trace.input(channel, current);
                self.readings.currents.push(current.clone());
            }
            Read::Drop => {
                let drop = image.analog(AnalogIn::ContactDrop).ok_or_else(missing)?;
                self.readings.trace.input(AnalogIn::ContactDrop, drop);
                self.readings.drops.push(drop.clone());
            }
            Read::Gates | Read::Gate => {
                let gate = |counter| image.counter(counter).cloned().ok_or_else(missing);
                let gates = [gate(Counter::Gate0)?, gate(Counter::Gate1)?];
                self.readings.trace.gates(&gates);
                self.readings.gates.push(gates);
            }
            Read::Resets => {}
            Read::Track => {
                let sample = image.temperature(Temperature::Track).cloned();
                self.readings.track.push(sample.ok_or_else(missing)?);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
