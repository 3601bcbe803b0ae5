//! The readings of a stage, by point, in order of arrival.

use super::act::{Read, Word};
use super::conversion::Converted;
use super::query::{Delivered, Instrument, Query, Waveform};
use super::trace::Trace;
use crate::rig::image::Image;
use crate::rig::point::{AnalogInput, DigitalInput, GatedCounter, Point, Thermometer};
use crate::rig::sample::{AnalogPoint, CountPoint, CountSample, Sample};
use std::sync::Arc;
use thiserror::Error;
use units::RigTime;

/// All readings of a stage.
#[derive(Debug, Clone, Default)]
pub struct Readings {
    states: Vec<(DigitalInput, bool)>,
    samples: Vec<Sample>,
    counts: Vec<CountSample>,
    delivered: Vec<(Instrument, Delivered)>,
    /// Results of conversions, in their order.
    pub converted: Vec<Converted>,
    /// Outcomes of [`Act::Until`](super::act::Act::Until): true when the point became active.
    pub seen: Vec<bool>,
    /// An input that has missed its state at an [`Act::Agree`](super::act::Act::Agree), which ended the acts.
    pub disagreed: Option<DigitalInput>,
    /// All samples, and the values commanded to outputs and sources.
    pub trace: Trace,
}

/// Reason why a finished job gives no reading.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub(super) enum Unread {
    /// A point has no value.
    #[error("{0} was answered without a value")]
    Missing(String),
    /// An input of this word was last read too long ago.
    #[error("a {0} input is stale")]
    Stale(&'static str),
}

impl Readings {
    /// Yields the states of a digital input.
    pub fn states(&self, point: DigitalInput) -> impl Iterator<Item = bool> {
        let here = self.states.iter().filter(move |(it, _)| *it == point);
        here.map(|(_, state)| *state)
    }

    /// Yields the samples of an analog input.
    pub fn analog(&self, point: AnalogInput) -> impl Iterator<Item = &Sample> {
        self.samples_of(AnalogPoint::Input(point))
    }

    /// Yields the samples of a thermometer.
    pub fn temperatures(&self, point: Thermometer) -> impl Iterator<Item = &Sample> {
        self.samples_of(AnalogPoint::Temperature(point))
    }

    /// Yields the counts of a gated counter.
    pub fn counts(&self, point: GatedCounter) -> impl Iterator<Item = &CountSample> {
        let here = move |it: &&CountSample| it.point == CountPoint::Gate(point);
        self.counts.iter().filter(here)
    }

    /// Yields what the programs of an instrument have delivered, in order of arrival.
    pub fn delivered(&self, instrument: Instrument) -> impl Iterator<Item = &Delivered> {
        let here = self.delivered.iter();
        let here = here.filter(move |(of, _)| *of == instrument);
        here.map(|(_, delivered)| delivered)
    }

    /// Returns all waveforms, in order of arrival.
    pub(super) fn waveforms(&self) -> Vec<Arc<Waveform>> {
        let all = self.delivered.iter();
        all.filter_map(|(_, it)| it.waveform.clone()).collect()
    }

    fn samples_of(&self, point: AnalogPoint) -> impl Iterator<Item = &Sample> {
        self.samples.iter().filter(move |it| it.point == point)
    }

    /// Stores the values of a finished job. `at`: the current time, then the time of the job's last reply.
    ///
    /// # Errors
    /// Fails with the name of a point or word that has no value.
    pub(super) fn take(
        &mut self,
        read: &Read,
        image: &Image,
        at: (RigTime, RigTime),
    ) -> Result<(), Unread> {
        match read {
            Read::Word(word) => {
                let states = word.states(image, at.0).ok_or_else(|| missing(word.name))?;
                self.trace.word(word.name, &states, at.1);
                self.keep_word(word, &states);
            }
            Read::Points { read, retained } => {
                for point in read.iter().chain(retained) {
                    self.take_point(*point, image, at.0)?;
                }
            }
            Read::Restarts => {}
        }
        Ok(())
    }

    pub(super) fn keep_word(&mut self, word: &Word, states: &[bool]) {
        assert_eq!(word.inputs.len(), states.len(), "a state for each input");
        let states = states.iter().copied();
        self.states.extend(word.inputs.iter().copied().zip(states));
    }

    /// Stores what each query of a job has delivered; `at` is the time at which the last one ended.
    pub(super) fn keep_delivered(
        &mut self,
        queries: &[Query],
        delivered: &[Delivered],
        at: RigTime,
    ) {
        assert_eq!(queries.len(), delivered.len(), "a delivery for each query");
        for (query, delivered) in queries.iter().zip(delivered) {
            self.trace.delivered(query, delivered, at);
            self.delivered.push((query.instrument, delivered.clone()));
        }
    }

    fn take_point(&mut self, point: Point, image: &Image, now: RigTime) -> Result<(), Unread> {
        let wiring = image.wiring();
        match point {
            Point::Input(input) => {
                let state = image.answered_input(input, now);
                let state = state.ok_or_else(|| missing(wiring.input_name(input)))?;
                self.states.push((input, state));
            }
            Point::Analog(input) => {
                let quantity = wiring.quantity(input);
                let sample = image.analog(input).ok_or_else(|| missing(quantity.name))?;
                self.trace.input(quantity, sample);
                self.samples.push(sample.clone());
            }
            Point::Temperature(point) => {
                let sample = image.temperature(point).cloned();
                let name = wiring.thermometer_name(point);
                self.samples.push(sample.ok_or_else(|| missing(name))?);
            }
            Point::Count(counter) => {
                let name = wiring.counter_name(counter);
                let count = image.counter(counter).ok_or_else(|| missing(name))?;
                self.trace.count(name, count);
                self.counts.push(count.clone());
            }
        }
        Ok(())
    }
}

fn missing(name: &str) -> Unread {
    Unread::Missing(name.to_owned())
}
