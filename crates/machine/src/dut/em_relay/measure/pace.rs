//! Waiting times of a test for an armature, in multiples of its operate time.
//!
//! What makes a relay late on a step (mass, drag, a pull that grows slowly) makes it swing longer after an approach and
//! leave its rest later at a level, so every wait for a free armature is a multiple of the operate time at nominal voltage
//! that the part has shown before any ramp. Of two thousand drawn relays (five states, dropped [`super::OFF`] before) none
//! goes over early when the approach ends 45 mV before its threshold, and seven do at 30 mV, heavy ones; the run-up ends in
//! between at the near end of an interval and further away everywhere else.

use super::TestRecord;
use crate::dut::em_relay::Parameter;
use units::{Span, Volt};

/// Operate time of a part that has not shown one.
const UNKNOWN_MS: f64 = 5.0;
/// No wait is shorter or longer than for these times.
const SHORTEST_MS: f64 = 2.5;
const LONGEST_MS: f64 = 20.0;

/// Operate time of a part, within reason.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pace {
    operate_ms: f64,
}

impl Pace {
    /// Of the part under test.
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

    /// At the first step of an approach.
    pub fn approaches(self) -> Span {
        self.times(2.5)
    }

    /// From there to where a fine ramp begins: a smaller step, and what is left of its swing reference parts show as well.
    pub fn settles(self) -> Span {
        self.times(4.2)
    }

    /// At a level that an armature from rest may pass: growth at the fold takes 1.2 operate times per decade, so that this
    /// tells less than 1 mV.
    pub fn dwells(self) -> Span {
        self.times(6.3)
    }

    /// Way of a ramp of `v_per_s` before the interval that it searches. An armature just below its threshold floats,
    /// swings after the approach, and goes over up to 50 mV early if it is brought too near.
    pub fn run_up(self, v_per_s: f64) -> Volt {
        Volt(self.times(8.5).as_seconds() * v_per_s)
    }
}
