//! The test of a resistor: switches the drive on at a fixed level, reads one channel, switches the drive off.
//!
//! R = V / I. V is the commanded level, I the reading of the fine channel; both have the makers' accuracies. R contains
//! the probe contacts, and its budget has a term for them. A result inside the guard band is repeated `slow_repeats`
//! times and averaged.

use super::accuracy::ChannelAccuracy;
use super::points::Points;
use super::recipe::ResistorRecipe;
use super::{Finding, Parameter};
use crate::dut::device::{DeviceUnderTest, Rig, TestOrder};
use crate::dut::procedure::{Progress, TestProcedure};
use crate::dut::record::{Stop, TestRecord};
use crate::dut::{Characteristic, Kind, Procedure, Recipe};
use crate::gauge::{Judgement, Reading};
use crate::instrument::act::{Act, JobDone, Read, Runner, RunnerState, Word};
use crate::instrument::readings::Readings;
use crate::rig::image::Image;
use crate::rig::point::{MissingPoint, Point};
use crate::rig::sample::{Quality, Sample};
use crate::rig::supply::{RangeMismatch, RangeSelector, SWITCHING_TIMEOUT, SupplyRange, code_of};
use std::sync::Arc;
use units::{RigTime, Span, Unit, Volt};

/// Settling time of current and amplifier after the drive is off.
const OFF: Span = Span::ms(5);
/// Signal name of the inputs that read the range back.
const RANGE: &str = "supply_range";

/// A resistor recipe on a rig.
#[derive(Debug, Clone)]
pub struct Device {
    recipe: Arc<Recipe>,
    resistor: Arc<ResistorRecipe>,
    points: Points,
    channel: ChannelAccuracy,
    /// Number of enabled channels of the converter that reads the current.
    channels: u32,
    /// Range of the supply and the points that select it; `None` on a rig with one range.
    range: Option<(RangeSelector, SupplyRange)>,
}

impl Device {
    /// Resolves the points of the recipe on a rig.
    ///
    /// # Errors
    /// Fails with the first point that the rig lacks.
    pub fn new(
        recipe: Arc<Recipe>,
        resistor: &ResistorRecipe,
        rig: &Rig,
    ) -> Result<Self, MissingPoint> {
        let points = Points::resolve(rig.wiring)?;
        let range = rig.wiring.supply_range.clone();
        assert!(range.is_some(), "a resistor on a supply without a range");
        let terminal = rig.wiring.analog_in(points.current);
        let mask = rig.wiring.module(terminal.module).mask.unwrap_or(u8::MAX);
        Ok(Self {
            recipe,
            resistor: Arc::new(resistor.clone()),
            points,
            channel: ChannelAccuracy {
                accuracy: *rig.accuracy,
                volt_per_ampere: terminal.gain,
            },
            channels: mask.count_ones(),
            range: rig.wiring.range_selector().zip(range),
        })
    }

    /// Returns the acts that select the supply range while all sources are at zero. If the range is not read back in
    /// time, the runner skips the remaining acts.
    fn range_acts(&self) -> Vec<Act> {
        let range = self.range.iter();
        let acts = range.flat_map(|(selector, range)| {
            let inputs = selector.inputs.to_vec();
            let word = Word {
                name: RANGE,
                inputs,
            };
            [
                Act::Set(selector.select(range.code).to_vec()),
                Act::Agree {
                    expected: selector.expects(range.code).to_vec(),
                    word: Arc::new(word),
                    within: SWITCHING_TIMEOUT,
                },
            ]
        });
        acts.collect()
    }

    /// Returns how the range that was read back differs from the selected one; `None` when both agree, or when no range
    /// was read.
    fn mismatch(&self, readings: &Readings) -> Option<RangeMismatch> {
        let (selector, range) = self.range.as_ref()?;
        let [low, high] = selector.inputs.map(|it| readings.states(it).last());
        selector.mismatch(range, code_of([low?, high?]))
    }

    fn acts(&self) -> Vec<Act> {
        let test = &self.resistor.test;
        let one_round = 1.03 / self.channel.accuracy.conversions_per_s * f64::from(self.channels);
        let fresh = Span::seconds(one_round + 1.03 / self.channel.accuracy.conversions_per_s);
        let mut acts = vec![
            Act::Level(vec![(self.points.level, Volt(test.level_v))]),
            Act::Set(vec![(self.points.drive, true)]),
            Act::Wait(Span::ms(test.settles_ms.into())),
        ];
        for _ in 0..test.readings {
            acts.extend([
                Act::Mark,
                Act::ConvertSinceMark(fresh),
                Act::Read(Read::points([Point::Analog(self.points.current)])),
            ]);
        }
        acts
    }

    fn acts_off(&self) -> Vec<Act> {
        vec![
            Act::Set(vec![(self.points.drive, false)]),
            Act::Level(vec![(self.points.level, Volt(0.0))]),
            Act::Wait(OFF),
            Act::Read(Read::Restarts),
        ]
    }

    /// Returns the resistance from the current samples of one measurement, or the finding that these show.
    fn resistance(&self, samples: &[Sample]) -> Result<Reading, Finding> {
        let mut sum = 0.0;
        for sample in samples {
            sum += match sample.quality {
                Quality::Good if sample.value.is_finite() => sample.value,
                Quality::OverRange => return Err(Finding::Short),
                Quality::Good | Quality::UnderRange | Quality::Blank => {
                    return Err(Finding::CurrentNotReadable);
                }
            };
        }
        let ampere = sum / samples.len() as f64;
        if !ampere.is_finite() {
            return Err(Finding::CurrentNotReadable);
        }
        if ampere < self.channel.no_current_ampere() {
            return Err(Finding::Open);
        }
        let ohm = self.resistor.test.level_v / ampere;
        Ok(Reading {
            value: ohm,
            unit: Unit::Ohm,
            budget: self.channel.budget(&self.resistor, ohm),
        })
    }
}

impl DeviceUnderTest for Device {
    fn begin(&self, order: &TestOrder, now: RigTime) -> Procedure {
        Procedure::Resistor(Box::new(Test {
            runner: Runner::new([self.range_acts(), self.acts()].concat(), now),
            device: self.clone(),
            range_mismatch: None,
            stage: Stage::Measure,
            thorough: order.thorough,
            number: order.number,
            repeats_left: self.recipe.decision.slow_repeats,
            record: TestRecord::default(),
            began: now,
        }))
    }
}

/// Stages of the test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Drive on, current read.
    Measure,
    /// Drive off.
    Off,
}

impl Stage {
    /// Every stage.
    pub const ALL: [Self; 2] = [Self::Measure, Self::Off];

    /// Returns the name in views.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Measure => "Resistance",
            Self::Off => "Off",
        }
    }
}

/// A test under way.
#[derive(Debug)]
pub struct Test {
    device: Device,
    runner: Runner,
    stage: Stage,
    thorough: bool,
    number: u8,
    repeats_left: u32,
    began: RigTime,
    record: TestRecord,
    range_mismatch: Option<RangeMismatch>,
}

impl Test {
    fn book(&mut self, now: RigTime) {
        let name = match self.stage {
            Stage::Measure => "resistance",
            Stage::Off => "off",
        };
        self.record.spent.add(self.runner.spent());
        self.record.took(name, now.since(self.began));
        self.record
            .trace
            .append(std::mem::take(&mut self.runner.readings.trace));
        self.began = now;
    }

    /// Adds the result of one measurement; another measurement follows when [`Self::needs_repeat`] holds.
    fn conclude(&mut self, readings: &Readings, now: RigTime) {
        let samples: Vec<Sample> = readings
            .analog(self.device.points.current)
            .cloned()
            .collect();
        if let Some(mismatch) = self.device.mismatch(readings) {
            let finding = Finding::OtherSupplyRange.with(mismatch.to_string());
            self.record.stop(finding);
            self.range_mismatch = Some(mismatch);
        }
        if !self.record.stopped() {
            match self.device.resistance(&samples) {
                Ok(reading) => self.record.found(Parameter::Resistance, reading, &samples),
                Err(finding) => self.record.stop(finding),
            }
        }
        let again = !self.record.stopped() && self.repeats_left > 0 && self.needs_repeat();
        let acts = if again {
            self.repeats_left -= 1;
            self.device.acts()
        } else {
            self.stage = Stage::Off;
            self.device.acts_off()
        };
        self.runner = Runner::new(acts, now);
    }

    /// Returns true when a repetition is due: in a thorough test after every result, in any other test after a result
    /// inside the guard band. Once begun, the repetitions continue to the last.
    fn needs_repeat(&self) -> bool {
        let repeating = self.record.attempts(Parameter::Resistance) > 1;
        let conditional = |(_, judgement): &(Characteristic, Judgement)| match judgement {
            Judgement::Conditional(_) => true,
            Judgement::Pass | Judgement::Fail(_) | Judgement::Void => false,
        };
        self.thorough || repeating || self.judgements().iter().any(conditional)
    }
}

impl TestProcedure for Test {
    fn step(&mut self, now: RigTime, done: Option<&JobDone>, image: &Image) -> Progress {
        let mut done = done;
        loop {
            match self.runner.step(now, done.take(), image) {
                RunnerState::Done => {}
                RunnerState::Trouble(why) => self.record.trouble(why),
                waiting @ (RunnerState::Job(_) | RunnerState::Busy | RunnerState::Wait(_)) => {
                    return Progress::Running(waiting);
                }
            }
            self.book(now);
            let readings = std::mem::take(&mut self.runner.readings);
            match self.stage {
                Stage::Off => return Progress::Judged,
                Stage::Measure => self.conclude(&readings, now),
            }
        }
    }

    fn kind(&self) -> Kind {
        Kind::Resistor
    }

    fn range_mismatch(&self) -> Option<&RangeMismatch> {
        self.range_mismatch.as_ref()
    }

    fn number(&self) -> u8 {
        self.number
    }

    fn stage(&self) -> &'static str {
        self.stage.name()
    }

    fn why_stopped(&self) -> Option<&Stop> {
        self.record.why_stopped()
    }

    fn judgements(&self) -> Vec<(Characteristic, Judgement)> {
        let all = Kind::Resistor.characteristics();
        self.record.judged(&self.device.recipe, all)
    }

    fn record(&self) -> TestRecord {
        self.record.clone()
    }

    fn take_record(&mut self) -> TestRecord {
        std::mem::take(&mut self.record)
    }
}

#[cfg(test)]
mod tests;
