//! Record of a test of any kind: results, the replies behind them, the time that each stage took, and why the test
//! ended early.

use super::characteristic::Characteristic;
use super::em_relay::Observed;
use super::reason::Reason;
use super::recipe::Recipe;
use super::ssr::references::Fixture;
use super::thermostat::device::Lesson;
use crate::gauge::repetition::mean;
use crate::gauge::{Judgement, Reading, judge};
use crate::instrument::act::Spent;
use crate::instrument::trace::Trace;
use crate::rig::sample::{CountSample, Origin, Sample};
use std::collections::BTreeMap;
use std::sync::Arc;
use texts::Message;
use units::Span;

/// Sample behind a result. Its line, module, channel and raw text lead back to the bytes on the line.
pub trait Evidence {
    /// Returns where the sample came from.
    fn origin(&self) -> &Origin;
}

impl Evidence for Sample {
    fn origin(&self) -> &Origin {
        &self.origin
    }
}

impl Evidence for CountSample {
    fn origin(&self) -> &Origin {
        &self.origin
    }
}

/// Why a test ends before its last stage.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    /// The part is bad.
    Fail(Reason),
    /// The part cannot be judged.
    Void(Reason),
    /// The rig was in trouble, which voids every result of the part, good or bad.
    Trouble(Reason),
}

impl Stop {
    /// Returns the characteristic whose limit a failure proves exceeded; `None` for a part that is not judged.
    pub fn proven(&self) -> Option<Characteristic> {
        match self {
            Self::Fail(reason) => reason.characteristic(),
            Self::Void(_) | Self::Trouble(_) => None,
        }
    }
}

/// Observations of a test of one kind, from which the kind learns.
#[derive(Debug, Clone, Default)]
pub enum Own {
    /// No observations: the kind learns from results alone, or the part was not tested.
    #[default]
    Nothing,
    /// Ramps and conditions of an electromagnetic relay.
    EmRelay(Observed),
    /// Corrections of its fixture that a test of a solid-state relay has measured or used.
    Ssr(Fixture),
    /// Response of the chamber, lag and switching temperatures that a batch of temperature relays has shown.
    Thermostat(Arc<Lesson>),
}

/// What a test has measured so far. `T` holds the observations of its kind.
#[derive(Debug, Clone, Default)]
pub struct TestRecord<T = Own> {
    readings: Vec<(Characteristic, Reading)>,
    evidence: Vec<(Characteristic, Origin)>,
    stop: Option<Stop>,
    /// Trace of all samples.
    pub trace: Trace,
    /// Time of the test, by what the test spent it on.
    pub spent: Spent,
    /// Rig time of each stage by its key.
    pub stages: BTreeMap<&'static str, Span>,
    /// Characteristics whose limits a test checks without measuring a value: the key of each, and true when the part
    /// keeps its limits.
    pub conforms: Vec<(&'static str, bool)>,
    /// Observations of the kind.
    pub own: T,
}

impl<T> TestRecord<T> {
    /// Returns the record in the form common to all kinds; `own` wraps the observations.
    pub fn of_any_kind(self, own: impl FnOnce(T) -> Own) -> TestRecord {
        TestRecord {
            readings: self.readings,
            evidence: self.evidence,
            stop: self.stop,
            trace: self.trace,
            spent: self.spent,
            stages: self.stages,
            conforms: self.conforms,
            own: own(self.own),
        }
    }

    /// Adds `time` to the total of the stage `what`.
    pub fn took(&mut self, what: &'static str, time: Span) {
        *self.stages.entry(what).or_default() += time;
    }

    /// Adds the times of another test of the part.
    pub fn add_time(&mut self, other: &Self) {
        self.spent.add(other.spent);
        other
            .stages
            .iter()
            .for_each(|(what, time)| self.took(what, *time));
    }

    /// Adds one result of a stage, with the replies that it comes from.
    ///
    /// # Panics
    /// Panics when the result is not in the unit of its characteristic.
    pub fn found<'a, S: Evidence + 'a>(
        &mut self,
        of: impl Into<Characteristic>,
        reading: Reading,
        samples: impl IntoIterator<Item = &'a S>,
    ) {
        let of = of.into();
        assert_eq!(reading.unit, of.unit(), "{of} in another unit");
        self.readings.push((of, reading));
        let origins = samples.into_iter().map(|sample| sample.origin().clone());
        self.evidence.extend(origins.map(|origin| (of, origin)));
    }

    /// Removes the results of a characteristic, because a later reading replaces them.
    pub fn forget(&mut self, of: impl Into<Characteristic>) {
        let of = of.into();
        self.readings.retain(|(known, _)| *known != of);
    }

    /// Returns each result of a characteristic, in the order of measurement.
    pub fn each(&self, of: impl Into<Characteristic>) -> impl Iterator<Item = &Reading> {
        let of = of.into();
        let own = self.readings.iter().filter(move |(known, _)| *known == of);
        own.map(|(_, reading)| reading)
    }

    /// Returns the result of a characteristic: the mean of its repetitions, whose scatter enters the uncertainty;
    /// `None` if it was not measured.
    pub fn result(&self, of: impl Into<Characteristic>) -> Option<Reading> {
        let of = of.into();
        let repetitions: Vec<Reading> = self.each(of).cloned().collect();
        mean(&repetitions, of.definition().mean_of)
    }

    /// Judges each result of these characteristics against its limit; leaves out those that were not measured.
    pub fn judged<C: Into<Characteristic> + Copy>(
        &self,
        recipe: &Recipe,
        all: impl IntoIterator<Item = C>,
    ) -> Vec<(C, Judgement)> {
        let one = |of: C| {
            let limit = recipe.limits.of(of);
            let judgement = judge(&self.result(of)?, &limit, recipe.decision.rule);
            Some((of, judgement))
        };
        all.into_iter().filter_map(one).collect()
    }

    /// Returns the result of a characteristic if its value and uncertainty are finite.
    pub fn usable(&self, of: impl Into<Characteristic>) -> Option<Reading> {
        self.result(of).filter(Reading::is_usable)
    }

    /// Returns how often a characteristic was measured.
    pub fn attempts(&self, of: impl Into<Characteristic>) -> usize {
        self.each(of).count()
    }

    /// Returns the origin of each reply behind a characteristic, in the order of the replies.
    pub fn evidence(&self, of: impl Into<Characteristic>) -> impl Iterator<Item = &Origin> {
        let of = of.into();
        let own = self.evidence.iter().filter(move |(known, _)| *known == of);
        own.map(|(_, origin)| origin)
    }

    /// Ends the test early because of what a stage has found; keeps a finding that has ended it before.
    pub fn stop(&mut self, found: impl Into<Reason>) {
        let reason = found.into();
        let stop = match reason.is_failure() {
            true => Stop::Fail(reason),
            false => Stop::Void(reason),
        };
        self.stop.get_or_insert(stop);
    }

    /// Ends the test early because the rig is in trouble; replaces any finding that has ended it before.
    pub fn trouble(&mut self, why: Message) {
        if !matches!(self.stop, Some(Stop::Trouble(_))) {
            self.stop = Some(Stop::Trouble(Reason::rig_trouble(why)));
        }
    }

    /// Returns true once the test has ended early.
    pub fn stopped(&self) -> bool {
        self.stop.is_some()
    }

    /// Returns the failure that has ended the test early; `None` without one.
    pub fn why_failed(&self) -> Option<&Reason> {
        match &self.stop {
            Some(Stop::Fail(reason)) => Some(reason),
            Some(Stop::Void(_) | Stop::Trouble(_)) | None => None,
        }
    }

    /// Takes the failure that has ended the test early off the record, so that the test can go on.
    pub fn take_failure(&mut self) -> Option<Reason> {
        let failure = self.why_failed().cloned();
        if failure.is_some() {
            self.stop = None;
        }
        failure
    }

    /// Returns why the test ended early; `None` if it did not.
    pub fn why_stopped(&self) -> Option<&Stop> {
        self.stop.as_ref()
    }
}
