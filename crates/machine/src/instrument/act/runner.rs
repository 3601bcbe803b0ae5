//! The runner carries out the acts of a stage in order, keeps their readings, and accounts for the time.

use super::{Act, Job, JobDone, Read, Word};
use crate::instrument::readings::{Readings, Unread};
use crate::rig::image::Image;
use crate::rig::point::{AnalogOutput, Point};
use crate::rig::sample::Quality;
use std::sync::Arc;
use texts::Message;
use units::{RigTime, Span, Volt};

/// Longest normal time from the last poll before an awaited event to the end of the write that reacts to the event: one
/// poll, one reading, one write. A retry or a slow line delays this write, and with it the end of the ramp that the
/// write starts. A ramp that reverses has run on during the delay, and needs as long again to return.
const PROMPT: Span = Span::ms(13);

/// State of a runner after a step.
#[derive(Debug, Clone, PartialEq)]
pub enum RunnerState {
    /// The caller must start this job and report it with [`JobDone`].
    Job(Job),
    /// A job is under way.
    Busy,
    /// No act is due before this time.
    Wait(RigTime),
    /// All acts are done.
    Done,
    /// A job failed; the stage cannot produce a result.
    Trouble(Message),
}

/// Time of a test, by what it was spent on.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Spent {
    /// Time of transactions.
    pub bus: Span,
    /// Time for coil, armature, source and bounce to settle.
    pub settling: Span,
    /// Time for conversions.
    pub conversion: Span,
    /// Time spent waiting for contact events, on ramps and in timed operations.
    pub ramp: Span,
    /// Time that the test would take if the bus had no delay: settling, conversions and events alone.
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
    /// Time since the mark if the bus had no delay.
    since_mark: Span,
    /// Time of the last poll that found the awaited point inactive.
    looked: Option<RigTime>,
    /// Earliest time at which the marked event may have happened.
    marked_from: RigTime,
    /// By how much the ramp that began after the mark started late.
    late: Span,
    spent: Spent,
    /// Readings so far.
    pub readings: Readings,
}

impl Runner {
    /// Makes a runner that begins now.
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

    /// Returns true when no act is left.
    pub fn is_done(&self) -> bool {
        self.current.is_none() && !self.pending
    }

    /// Makes a runner that begins now with the mark of the runner `before`, because a mark remains valid across stages.
    pub fn after(acts: Vec<Act>, now: RigTime, before: &Runner) -> Self {
        let mut runner = Self::new(acts, now);
        runner.mark = before.mark;
        runner.since_mark = before.since_mark;
        (runner.marked_from, runner.late) = (before.marked_from, before.late);
        runner
    }

    /// Advances as far as possible. `done` is the outcome of the job that an earlier step requested; the caller passes
    /// it once.
    pub fn step(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> RunnerState {
        if self.pending {
            let Some(done) = done else {
                return RunnerState::Busy;
            };
            if let Some(trouble) = &done.trouble {
                return RunnerState::Trouble(trouble.clone());
            }
            self.pending = false;
            self.since = done.at;
            if let Err(trouble) = self.keep(done, image, now) {
                return RunnerState::Trouble(Message::detail("unread", trouble));
            }
        }
        while let Some(act) = &self.current {
            match act {
                Act::Set(outputs) => return self.request(Job::Set(outputs.clone())),
                Act::Level(outputs) | Act::Ramp(outputs) => {
                    return self.request(Job::Level(outputs.clone()));
                }
                Act::Read(read) => return self.request(read.job()),
                Act::Query(queries) => return self.request(Job::Query(queries.clone())),
                Act::Convert(conversion) => {
                    let waveforms = self.readings.waveforms();
                    return self.request(Job::Convert(conversion.clone(), waveforms));
                }
                Act::Mask(inputs) => return self.request(Job::Mask(inputs.clone())),
                Act::Until { point, word, .. } => {
                    let word = word.inputs.iter().copied();
                    let inputs = std::iter::once(*point).chain(word);
                    return self.request(Job::Read(inputs.map(Point::Input).collect()));
                }
                Act::Below { point, .. } => {
                    return self.request(Job::Read(vec![Point::Analog(*point)]));
                }
                Act::Agree { word, .. } => {
                    let read = Read::Word(Arc::clone(word));
                    return self.request(read.job());
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
                        return RunnerState::Wait(until);
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
                        return RunnerState::Wait(until);
                    }
                    self.since = self.since.max(until);
                    self.next();
                }
            }
        }
        RunnerState::Done
    }

    fn request(&mut self, job: Job) -> RunnerState {
        self.pending = true;
        RunnerState::Job(job)
    }

    /// Returns the time spent so far.
    pub fn spent(&self) -> Spent {
        self.spent
    }

    fn next(&mut self) {
        let took = self.since.since(self.began);
        let rest = |span: &Span| Span(span.0.saturating_sub(self.since_mark.0));
        let spent = &mut self.spent;
        let least = match &self.current {
            Some(Act::Wait(span)) => {
                spent.settling += took;
                *span
            }
            Some(Act::WaitSinceMark(span) | Act::RampSinceMark(span)) => {
                spent.settling += took;
                rest(span)
            }
            Some(Act::ConvertSinceMark(span)) => {
                spent.conversion += took;
                rest(span)
            }
            Some(Act::Until { .. }) => {
                spent.ramp += took;
                took
            }
            Some(Act::Below { .. }) => {
                spent.conversion += took;
                // The converter keeps its pace, whatever the delay of the bus since the mark.
                rest(&self.since.since(self.mark))
            }
            Some(
                Act::Set(_)
                | Act::Level(_)
                | Act::Ramp(_)
                | Act::Read(_)
                | Act::Agree { .. }
                | Act::Query(_)
                | Act::Convert(_)
                | Act::Mask(_),
            ) => {
                spent.bus += took;
                Span(0)
            }
            Some(Act::Mark) | None => Span(0),
        };
        spent.bound += least;
        self.since_mark = match &self.current {
            Some(Act::Mark) => Span(0),
            Some(_) | None => self.since_mark + least,
        };
        if !matches!(&self.current, Some(Act::Until { .. } | Act::Mark)) {
            self.looked = None;
        }
        self.current = self.acts.next();
        self.began = self.since;
    }

    /// Stores the readings of the finished job, and moves to the next act unless the present one still awaits a
    /// condition.
    fn keep(&mut self, done: &JobDone, image: &Image, now: RigTime) -> Result<(), Unread> {
        match self.current.clone() {
            Some(Act::Read(read)) => self.readings.take(&read, image, (now, self.since))?,
            Some(Act::Until {
                point,
                word,
                within,
            }) => {
                let active = image.answered_input(point, now);
                let active = active.ok_or(Unread::Stale(word.name))?;
                let states = self.poll(&word, image, now)?;
                if !active && self.since.since(self.began) < within {
                    self.looked = Some(self.since);
                    return Ok(());
                }
                self.looked.get_or_insert(self.began);
                self.readings.keep_word(&word, &states);
                self.readings.seen.push(active);
            }
            Some(Act::Below {
                point,
                amount,
                within,
            }) => {
                let (below, last) = image.analog(point).map_or((false, true), |sample| {
                    let below = sample.quality == Quality::Good && sample.value.abs() < amount;
                    (below, sample.origin.at >= self.mark + within)
                });
                if !below && !last {
                    return Ok(());
                }
                let read = Read::points([Point::Analog(point)]);
                self.readings.take(&read, image, (now, self.since))?;
            }
            Some(Act::Agree {
                expected,
                word,
                within,
            }) => {
                let states = self.poll(&word, image, now)?;
                let mut each = expected.iter();
                let wrong = each.find(|(it, on)| image.answered_input(*it, now) != Some(*on));
                if wrong.is_some() && self.since.since(self.began) < within {
                    return Ok(());
                }
                self.readings.keep_word(&word, &states);
                if let Some((input, _)) = wrong {
                    self.readings.disagreed = Some(*input);
                    self.acts = Vec::new().into_iter();
                }
            }
            Some(Act::Set(outputs)) => {
                let wiring = image.wiring();
                self.readings.trace.switched(wiring, &outputs, self.since);
            }
            Some(Act::Query(queries)) => {
                let at = self.since;
                self.readings.keep_delivered(&queries, &done.delivered, at);
            }
            Some(Act::Convert(_)) => self.readings.converted.extend(done.converted.clone()),
            Some(Act::Level(outputs)) => self.commanded(&outputs, image),
            Some(Act::Ramp(outputs)) => {
                self.commanded(&outputs, image);
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

    /// Reads a word and adds it to the trace.
    fn poll(&mut self, word: &Word, image: &Image, now: RigTime) -> Result<Vec<bool>, Unread> {
        let states = word.states(image, now).ok_or(Unread::Stale(word.name))?;
        self.readings.trace.word(word.name, &states, self.since);
        Ok(states)
    }

    fn commanded(&mut self, outputs: &[(AnalogOutput, Volt)], image: &Image) {
        let trace = &mut self.readings.trace;
        trace.commanded(image.wiring(), outputs, self.since);
    }
}
