//! What a test stage is made of: acts, each a few transactions of one line or one wait.
//!
//! A stage writes its acts down as a list before it begins; [`Runner`] carries them out and keeps what
//! was read. So the order of a test can be read, printed and replayed, and no stage ever holds the bus.
//! Acts name wired points and know nothing of the device: which transactions they take is the wiring's.

use super::readings::{Readings, Unread};
use crate::rig::image::Image;
use crate::rig::point::{AnalogInput, AnalogOutput, DigitalInput, DigitalOutput, Point};
use std::sync::Arc;
use units::{RigTime, Span, Volt};

/// What follows an awaited event is sent within so long after the last look that had not shown it yet: a poll, a reading,
/// the write. Where a request is lost and asked again, or the line is slow, a ramp is sent later and ends later by as
/// much; one that turns round has gone on meanwhile, and needs as long again to come back.
const PROMPT: Span = Span::ms(13);

/// Digital inputs that are looked at together and kept as one signal: bit n is input n.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Word {
    /// Name of the signal.
    pub name: &'static str,
    /// The inputs; best all of one module, which is then one transaction.
    pub inputs: Vec<DigitalInput>,
}

/// What one act brings in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Read {
    /// Inputs that are looked at together.
    Word(Arc<Word>),
    /// These points.
    Points {
        /// The points that are read.
        asked: Vec<Point>,
        /// Points that are kept beside them as they last were.
        beside: Vec<Point>,
    },
    /// Asks each module with outputs whether it has restarted since the last such read; a restart raises an alarm.
    Restarts,
}

impl Read {
    /// Reads these points and keeps nothing else.
    pub fn points(asked: impl IntoIterator<Item = Point>) -> Self {
        Self::Points {
            asked: asked.into_iter().collect(),
            beside: Vec::new(),
        }
    }

    fn job(&self) -> Job {
        match self {
            Self::Word(word) => Job::Read(word.inputs.iter().copied().map(Point::Input).collect()),
            Self::Points { asked, .. } => Job::Read(asked.clone()),
            Self::Restarts => Job::Restarts,
        }
    }
}

/// One step of a stage.
#[derive(Debug, Clone, PartialEq)]
pub enum Act {
    /// Digital outputs, those of one module written together.
    Set(Vec<(DigitalOutput, bool)>),
    /// Voltages asked of sources, in volts of the supply, written one after the other.
    Level(Vec<(AnalogOutput, Volt)>),
    /// As [`Act::Level`], of sources that begin to ramp and are not waited for.
    Ramp(Vec<(AnalogOutput, Volt)>),
    /// One reading.
    Read(Read),
    /// The converters of these inputs convert them and nothing else; only while a lot is prepared.
    Mask(Vec<AnalogInput>),
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
    /// Reads a word until the point is active, or gives up; which of both is kept.
    Until {
        /// The input that is awaited.
        point: DigitalInput,
        /// Inputs that are kept with the last look.
        word: Arc<Word>,
        /// Longest wait.
        within: Span,
    },
}

/// Work for the lines.
#[derive(Debug, Clone, PartialEq)]
pub enum Job {
    /// See [`Act::Set`].
    Set(Vec<(DigitalOutput, bool)>),
    /// See [`Act::Level`].
    Level(Vec<(AnalogOutput, Volt)>),
    /// Reads these points.
    Read(Vec<Point>),
    /// See [`Read::Restarts`].
    Restarts,
    /// Channel masks of converters; only while a lot is prepared, never during a lot.
    Mask(Vec<AnalogInput>),
}

/// Answer to a [`Job`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JobDone {
    /// When the last reply of the job was complete.
    pub at: RigTime,
    /// Why it failed: line, address, command, how often.
    pub trouble: Option<String>,
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

    /// A runner that begins now and remembers what the one before it marked: a mark outlives its stage.
    pub fn after(acts: Vec<Act>, now: RigTime, before: &Runner) -> Self {
        let mut runner = Self::new(acts, now);
        runner.mark = before.mark;
        runner.since_mark = before.since_mark;
        (runner.marked_from, runner.late) = (before.marked_from, before.late);
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
                return Doing::Trouble(trouble.to_string());
            }
        }
        while let Some(act) = &self.current {
            match act {
                Act::Set(outputs) => return self.ask(Job::Set(outputs.clone())),
                Act::Level(outputs) | Act::Ramp(outputs) => {
                    return self.ask(Job::Level(outputs.clone()));
                }
                Act::Read(read) => return self.ask(read.job()),
                Act::Mask(inputs) => return self.ask(Job::Mask(inputs.clone())),
                Act::Until { point, word, .. } => {
                    let word = word.inputs.iter().copied();
                    let inputs = std::iter::once(*point).chain(word);
                    return self.ask(Job::Read(inputs.map(Point::Input).collect()));
                }
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
            Some(
                Act::Set(_)
                | Act::Level(_)
                | Act::Ramp(_)
                | Act::Read(_)
                | Act::Mask(_)
                | Act::Mark,
            )
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
            Some(Act::Set(_) | Act::Level(_) | Act::Ramp(_) | Act::Read(_) | Act::Mask(_)) => {
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
    fn keep(&mut self, image: &Image, now: RigTime) -> Result<(), Unread> {
        match self.current.clone() {
            Some(Act::Read(read)) => self.readings.take(&read, image, (now, self.since))?,
            Some(Act::Until {
                point,
                word,
                within,
            }) => {
                let stale = || Unread::Stale(word.name);
                let active = image.answered_input(point, now).ok_or_else(stale)?;
                let states = word.states(image, now).ok_or_else(stale)?;
                self.readings.trace.word(word.name, &states, self.since);
                if !active && self.since.since(self.began) < within {
                    self.looked = Some(self.since);
                    return Ok(());
                }
                self.looked.get_or_insert(self.began);
                self.readings.keep_word(&word, &states);
                self.readings.seen.push(active);
            }
            Some(Act::Set(outputs)) => {
                let wiring = image.wiring();
                self.readings.trace.switched(wiring, &outputs, self.since);
            }
            Some(Act::Level(outputs)) => {
                let wiring = image.wiring();
                self.readings.trace.asked(wiring, &outputs, self.since);
            }
            Some(Act::Ramp(outputs)) => {
                let wiring = image.wiring();
                self.readings.trace.asked(wiring, &outputs, self.since);
                let after = self.since.since(self.marked_from);
                self.late = self.late.max(Span(after.0.saturating_sub(PROMPT.0)));
            }
            Some(
                Act::Mask(_)
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
}

impl Word {
    /// What each input is, provided that all were just read.
    pub(super) fn states(&self, image: &Image, now: RigTime) -> Option<Vec<bool>> {
        let inputs = self.inputs.iter();
        inputs.map(|it| image.answered_input(*it, now)).collect()
    }
}

#[cfg(test)]
mod tests;
