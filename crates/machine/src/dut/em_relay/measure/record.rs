//! What only the test of a relay sees beside its results: ramps, temperature, contact of the probes.

use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::overshoot::Shown;
use crate::dut::em_relay::threshold::Direction;
use crate::dut::record;
use crate::gauge::Judgement;
use units::{Celsius, Ohm, Volt};

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

/// What a test of a relay sees and no other kind has.
#[derive(Debug, Clone, Default)]
pub struct Observed {
    /// Force contacts of the coil in series, once it was measured.
    pub probe_contact: Option<Ohm>,
    /// Temperature of the magazine track when the test began.
    pub track: Option<Celsius>,
    /// Limits that were proven without a value.
    pub proven: Vec<(Parameter, Judgement)>,
    /// Operate ramps.
    pub operate: Option<Ramp>,
    /// Release ramps.
    pub release: Option<Ramp>,
}

/// Record of the test of a relay.
pub type TestRecord = record::TestRecord<Observed>;

impl TestRecord {
    /// The ramps of a direction.
    pub fn ramp(&self, direction: Direction) -> Option<Ramp> {
        match direction {
            Direction::Rising => self.own.operate,
            Direction::Falling => self.own.release,
        }
    }

    /// Keeps the ramps of a direction.
    pub fn keep_ramp(&mut self, direction: Direction, ramp: Ramp) {
        match direction {
            Direction::Rising => self.own.operate = Some(ramp),
            Direction::Falling => self.own.release = Some(ramp),
        }
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
