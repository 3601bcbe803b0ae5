//! Record of a test: results, the replies they came from, where the time went, and why it ended early.

use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::lag::Shown;
use crate::dut::em_relay::threshold::Direction;
use crate::dut::reason::{Code, Reason};
use crate::gauge::Judgement;
use crate::gauge::budget::Reading;
use crate::gauge::repetition::mean;
use crate::instrument::act::Spent;
use crate::instrument::trace::Trace;
use crate::rig::sample::{CountSample, Origin, Sample};
use crate::units::{Celsius, Ohm, Span, Volt};
use std::collections::BTreeMap;

/// What a result was made from: line, module, channel and raw text lead back to the bytes.
pub trait Evidence {
    /// Where it came from.
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
    /// It cannot be judged.
    Void(Reason),
    /// The rig was in trouble: what it has measured of the part so far, good or bad, proves nothing.
    Trouble(Reason),
}

/// A ramp as it was seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// What the part had shown when the coarse ramp was read, its indication among it.
    pub coarse: Shown,
    /// Indicated voltage of the fine ramp.
    pub fine: Option<Volt>,
}

impl Ramp {
    /// A coarse ramp that no fine one has followed.
    pub fn coarse_only(coarse: Shown) -> Self {
        Self { coarse, fine: None }
    }

    /// A fine ramp that no coarse one has placed.
    pub fn fine_only(seen: Volt) -> Self {
        Self {
            coarse: Shown::NOTHING,
            fine: Some(seen),
        }
    }
}

/// What a test has measured so far.
#[derive(Debug, Clone, Default)]
pub struct TestRecord {
    readings: Vec<(Parameter, Reading)>,
    evidence: Vec<(Parameter, Origin)>,
    stop: Option<Stop>,
    /// What was seen, sample by sample.
    pub trace: Trace,
    /// Where the time went.
    pub spent: Spent,
    /// Force contacts of the coil in series, once it was measured.
    pub probe_contact: Option<Ohm>,
    /// Temperature of the magazine track when the test began.
    pub track: Option<Celsius>,
    /// Limits that were proven without a value.
    pub proven: Vec<(Parameter, Judgement)>,
    /// Rig time by what it was spent on.
    pub stages: BTreeMap<&'static str, Span>,
    /// Operate ramps.
    pub operate: Option<Ramp>,
    /// Release ramps.
    pub release: Option<Ramp>,
}

impl TestRecord {
    /// The ramps of a direction.
    pub fn ramp(&self, direction: Direction) -> Option<Ramp> {
        match direction {
            Direction::Rising => self.operate,
            Direction::Falling => self.release,
        }
    }

    /// Keeps the ramps of a direction.
    pub fn keep_ramp(&mut self, direction: Direction, ramp: Ramp) {
        match direction {
            Direction::Rising => self.operate = Some(ramp),
            Direction::Falling => self.release = Some(ramp),
        }
    }

    /// Books the time of a stage.
    pub fn took(&mut self, what: &'static str, time: Span) {
        *self.stages.entry(what).or_default() += time;
    }

    /// Adds one result of a stage with the replies it was made from.
    ///
    /// # Panics
    /// When the result is not in the unit of the parameter.
    pub fn found<'a, S: Evidence + 'a>(
        &mut self,
        parameter: Parameter,
        reading: Reading,
        samples: impl IntoIterator<Item = &'a S>,
    ) {
        let unit = parameter.definition().unit;
        assert_eq!(reading.unit, unit, "{parameter} in another unit");
        self.readings.push((parameter, reading));
        self.evidence.extend(
            samples
                .into_iter()
                .map(|sample| (parameter, sample.origin().clone())),
        );
    }

    /// Takes back the results of a parameter, which a later reading of more closures replaces.
    pub fn forget(&mut self, parameter: Parameter) {
        self.readings.retain(|(known, _)| *known != parameter);
    }

    /// Each result of a parameter, in the order they came.
    pub fn each(&self, parameter: Parameter) -> impl Iterator<Item = &Reading> {
        self.readings
            .iter()
            .filter(move |(known, _)| *known == parameter)
            .map(|(_, reading)| reading)
    }

    /// Result of a parameter: the mean of its repetitions, which lie apart as far as the part scatters.
    pub fn result(&self, parameter: Parameter) -> Option<Reading> {
        let repetitions: Vec<Reading> = self.each(parameter).cloned().collect();
        mean(&repetitions, parameter.definition().spoken_of)
    }

    /// What the part has shown by the end of a coarse ramp.
    pub fn shown(&self, indicated: Volt, direction: Direction) -> Shown {
        let value = |parameter| {
            self.result(parameter)
                .map_or(f64::NAN, |reading| reading.value)
        };
        Shown {
            indicated,
            operate: match direction {
                Direction::Rising => indicated,
                Direction::Falling => self
                    .operate
                    .map_or(Volt(f64::NAN), |ramp| ramp.coarse.indicated),
            },
            operate_ms: value(Parameter::OperateTime),
            release_ms: value(Parameter::ReleaseTime),
            coil_ohm: value(Parameter::CoilResistance),
        }
    }

    /// How often a parameter was measured.
    pub fn attempts(&self, parameter: Parameter) -> usize {
        self.each(parameter).count()
    }

    /// Replies behind a parameter, in the order they came.
    pub fn evidence(&self, parameter: Parameter) -> impl Iterator<Item = &Origin> {
        self.evidence
            .iter()
            .filter(move |(known, _)| *known == parameter)
            .map(|(_, e)| e)
    }

    /// Ends the test early by what a stage has found; the first finding stays.
    pub fn stop(&mut self, found: impl Into<Reason>) {
        let reason = found.into();
        let stop = match reason.code {
            Code::EmRelay(finding) if finding.bin().is_some() => Stop::Fail(reason),
            Code::EmRelay(_)
            | Code::OutsideLimit(_)
            | Code::NotProven(_)
            | Code::NotMeasured(_)
            | Code::Interrupted
            | Code::RigTrouble
            | Code::Unclassified => Stop::Void(reason),
        };
        self.stop.get_or_insert(stop);
    }

    /// Ends the test early because the rig is in trouble, whatever the part has ended it by before.
    pub fn trouble(&mut self, why: String) {
        if !matches!(self.stop, Some(Stop::Trouble(_))) {
            self.stop = Some(Stop::Trouble(Reason::rig_trouble(why)));
        }
    }

    /// True once the test has ended early.
    pub fn stopped(&self) -> bool {
        self.stop.is_some()
    }

    /// Why it ended early.
    pub fn why_stopped(&self) -> Option<&Stop> {
        self.stop.as_ref()
    }
}
