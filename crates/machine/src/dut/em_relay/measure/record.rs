//! Observations of a relay test in addition to its results: ramps, temperature, probe contact.

use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::overshoot::CoarseResults;
use crate::dut::em_relay::threshold::Direction;
use crate::dut::record;
use crate::gauge::Judgement;
use units::{Celsius, Ohm, Volt};

/// Indications of the ramps of one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// Results of the part at the end of its coarse ramp, including the indication of that ramp.
    pub coarse: CoarseResults,
    /// Indicated voltage of the fine ramp; `None` before it.
    pub fine: Option<Volt>,
}

impl Ramp {
    /// Returns the ramps of a direction that has only a coarse indication.
    pub fn coarse_only(coarse: CoarseResults) -> Self {
        Self { coarse, fine: None }
    }

    /// Returns the ramps of a direction that has only a fine indication.
    pub fn fine_only(seen: Volt) -> Self {
        Self {
            coarse: CoarseResults::NONE,
            fine: Some(seen),
        }
    }
}

/// Observations that only a relay test makes.
#[derive(Debug, Clone, Default)]
pub struct Observed {
    /// Resistance of the coil's two force contacts; `None` until measured.
    pub probe_contact: Option<Ohm>,
    /// Temperature of the magazine track when the test began.
    pub track: Option<Celsius>,
    /// Resistance of each NC closure, milliohms.
    pub nc_mohm: Vec<f64>,
    /// Judgements of limits that were proven without a measured value.
    pub proven: Vec<(Parameter, Judgement)>,
    /// Operate ramps.
    pub operate: Option<Ramp>,
    /// Release ramps.
    pub release: Option<Ramp>,
}

/// Record of the test of a relay.
pub type TestRecord = record::TestRecord<Observed>;

impl TestRecord {
    /// Returns the ramps of a direction.
    pub fn ramp(&self, direction: Direction) -> Option<Ramp> {
        match direction {
            Direction::Rising => self.own.operate,
            Direction::Falling => self.own.release,
        }
    }

    /// Stores the ramps of a direction.
    pub fn keep_ramp(&mut self, direction: Direction, ramp: Ramp) {
        match direction {
            Direction::Rising => self.own.operate = Some(ramp),
            Direction::Falling => self.own.release = Some(ramp),
        }
    }

    /// Returns the results of the part when a coarse ramp ends at `indicated`.
    pub fn coarse_results(&self, indicated: Volt, direction: Direction) -> CoarseResults {
        let value = |parameter| {
            self.result(parameter)
                .map_or(f64::NAN, |reading| reading.value)
        };
        CoarseResults {
            indicated,
            operate: match direction {
                Direction::Rising => indicated,
                Direction::Falling => self
                    .own
                    .operate
                    .map_or(Volt(f64::NAN), |ramp| ramp.coarse.indicated),
            },
            operate_ms: value(Parameter::OperateTime),
            release_ms: value(Parameter::ReleaseTime),
            coil_ohm: value(Parameter::CoilResistance),
        }
    }
}
