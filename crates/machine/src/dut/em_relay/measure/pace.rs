//! Waiting times of a test for the armature, in multiples of its operate time.
//!
//! A relay that operates late on a step (mass, drag, slow pull) also swings longer after an approach and leaves its
//! rest position later. Every wait for a free armature is therefore a multiple of the operate time at nominal voltage,
//! which the test measures before any ramp. A simulation of two thousand relays confirms the approach: after
//! [`super::OFF`] without drive, none operates early when the approach ends 45 mV before the threshold; at 30 mV, seven
//! heavy ones do.

use super::TestRecord;
use crate::dut::em_relay::Parameter;
use units::{Span, Volt};

/// Operate time assumed for a part without a measured one.
const UNKNOWN_MS: f64 = 5.0;
/// Shortest operate time to which the waits adapt, ms; a shorter one counts as this.
const SHORTEST_MS: f64 = 2.5;
/// Longest operate time to which the waits adapt, ms; a longer one counts as this.
const LONGEST_MS: f64 = 20.0;

/// Operate time of a part, limited to `SHORTEST_MS` and `LONGEST_MS`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pace {
    operate_ms: f64,
}

impl Pace {
    /// Returns the pace of the part under test.
    pub fn of(record: &TestRecord) -> Self {
        let shown = record.result(Parameter::OperateTime);
        let operate_ms = shown.map_or(UNKNOWN_MS, |reading| reading.value);
        Self {
            operate_ms: operate_ms.clamp(SHORTEST_MS, LONGEST_MS),
        }
    }

    fn times(self, operations: f64) -> Span {
        Span::seconds(operations * self.operate_ms * 1e-3)
    }

    /// Returns the wait at the first step of an approach.
    pub fn approaches(self) -> Span {
        self.times(2.5)
    }

    /// Returns the wait from the second, smaller step to the fine ramp. The armature still swings a little afterwards;
    /// the overshoot of reference parts contains the effect.
    pub fn settles(self) -> Span {
        self.times(4.2)
    }

    /// Returns the dwell at a level that may lie above the threshold. The deflection of the armature grows tenfold
    /// every 1.2 operate times, so that the dwell shows a threshold that the level exceeds by less than 1 mV.
    pub fn dwells(self) -> Span {
        self.times(6.3)
    }

    /// Returns the run-up of a ramp of `v_per_s`: the distance that it covers before the interval that it searches.
    /// Without it, an armature just below its threshold would swing after the approach and operate up to 50 mV early.
    pub fn run_up(self, v_per_s: f64) -> Volt {
        Volt(self.times(8.5).as_seconds() * v_per_s)
    }
}
