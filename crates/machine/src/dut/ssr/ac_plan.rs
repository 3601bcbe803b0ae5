//! Levels, scales and times of the test of an AC part.
//!
//! The line is the source in series with the output and 2.3 kohm, 1 ohm of it the shunt. The loop is the source in
//! series with the output and 4.7 ohm, 10 mohm of it the shunt.

use super::parameter::Parameter;
use super::recipe::{Output, SsrRecipe};
use crate::dut::recipe::Limits;
use scpi::Accuracy;
use std::f64::consts::SQRT_2;

/// Load of the line, shunt included, ohm.
pub const LINE_OHM: f64 = 2300.0;
/// Shunt of the line, ohm.
pub const LINE_SHUNT_OHM: f64 = 1.0;
/// Load of the loop, shunt included, ohm.
pub const LOOP_OHM: f64 = 4.7;
/// Shunt of the loop, ohm.
pub const LOOP_SHUNT_OHM: f64 = 0.01;
/// Errors of both shunts, half width, as a share.
pub const SHUNT_ERROR: f64 = 0.001;
/// Ratio of the output voltage to that of the divided channel.
pub const DIVIDER: f64 = 100.0;
/// Voltage at which the clamped channel is cut off, V.
pub const CLAMP_V: f64 = 10.0;
/// Highest voltage of the loop, rms, V.
pub const MOST_LOOP_V: f64 = 30.0;
/// Vertical divisions from the middle of the screen to the greatest value.
const HALF_SCREEN: f64 = 3.5;
/// Source voltage that calibrates the clamped channel, as a share of the range of the drop.
const REFERENCE: f64 = 0.8;
/// Ratio of the end of a scale to the limit that it must show.
const ROOM: f64 = 1.2;
/// Drop that chooses the scales when the recipe does not limit the drop, V peak.
const USUAL_DROP_V: f64 = 2.0;
/// Leakage that chooses the scales when the recipe does not limit the leakage, A rms.
const USUAL_LEAKAGE_A: f64 = 5e-3;
/// Least scale of the shunt channel, V per division.
const LEAST_SCALE_V: f64 = 0.5e-3;
/// Periods of the mains in the record of a leakage.
const LEAKAGE_PERIODS: f64 = 3.0;
/// Samples of the record of a leakage; more would only take longer to read, since their noise is small against the
/// other errors.
const LEAKAGE_POINTS: f64 = 4e3;
/// Periods for which a record shows whether an output blocks.
const BLOCKS_PERIODS: f64 = 1.5;
/// Periods for which a record shows whether an output conducts: one, with room for a line that is slow.
const CONDUCTS_PERIODS: f64 = 1.05;
/// Time of the conducting output in the loop, s, for the drift from 10 ms to 200 ms.
pub const LOOP_S: f64 = 0.212;
/// Half periods of the mains from the start of a pulse to that of the next, without the step of the phase.
const BETWEEN_HALVES: f64 = 3.0;
/// Length of a pulse, half periods of the mains.
const PULSE_HALVES: f64 = 1.5;
/// Share of a record before its trigger.
pub const BEFORE: f64 = 0.02;
/// Samples in half a period of the record of a staircase: the level at a zero is known to a hundredth of its time.
const PER_HALF: f64 = 200.0;

/// Plan of an output that switches an AC load.
#[derive(Debug, Clone, PartialEq)]
pub struct AcPlan {
    /// True when the output turns on at the zero of the mains.
    pub zero_cross: bool,
    /// Voltage of the line, rms, V.
    pub mains_v: f64,
    /// Frequency, Hz.
    pub mains_hz: f64,
    /// Current of the conducting output, rms, A.
    pub rated_a: f64,
    /// Number of pulses in the train, each at another phase of the mains.
    pub phases: f64,
    /// Largest current of an output that counts as blocked, rms, A: the limit of the leakage, or the usual leakage
    /// without one.
    pub blocked_a: f64,
    /// Largest voltage of an output that counts as conducting, V.
    pub on_v: f64,
    /// Scale of the shunt channel for leakages, V per division.
    pub leakage_scale_v: f64,
    /// Scale of the clamped channel for the drop, V per division.
    pub drop_scale_v: f64,
    /// Errors of the channels of the digitizer.
    pub digitizer: Accuracy,
    /// Errors of the source of the mains.
    pub source: Accuracy,
}

/// Circuit through which the source feeds the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Circuit {
    /// The line, with the voltage of the mains.
    Line,
    /// The loop, with the rated current.
    Loop,
}

impl Circuit {
    /// Returns the load, shunt included, ohm.
    pub const fn ohm(self) -> f64 {
        match self {
            Self::Line => LINE_OHM,
            Self::Loop => LOOP_OHM,
        }
    }

    /// Returns the shunt, ohm.
    pub const fn shunt_ohm(self) -> f64 {
        match self {
            Self::Line => LINE_SHUNT_OHM,
            Self::Loop => LOOP_SHUNT_OHM,
        }
    }
}

/// Scales and length of one record of the digitizer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scales {
    /// Divided channel, V per division.
    pub divided_v: f64,
    /// Clamped channel, V per division.
    pub clamped_v: f64,
    /// Shunt channel, V per division.
    pub shunt_v: f64,
    /// Length of the record, s.
    pub record_s: f64,
    /// Number of samples.
    pub points: f64,
    /// Circuit that feeds the output.
    pub circuit: Circuit,
}

impl AcPlan {
    /// Derives scales and levels from the recipe and its limits.
    pub fn new(ssr: &SsrRecipe, limits: &Limits, digitizer: Accuracy, source: Accuracy) -> Self {
        let part = &ssr.part;
        let high = |parameter| limits.of(parameter).high;
        let leak_ua = high(Parameter::LeakageHot).or(high(Parameter::LeakageCold));
        let leak_a = leak_ua.map_or(USUAL_LEAKAGE_A, |ua| ua / 1e6);
        let drop_v = high(Parameter::Drop).unwrap_or(USUAL_DROP_V);
        let leak_v = ROOM * leak_a * SQRT_2 * LINE_SHUNT_OHM;
        Self {
            zero_cross: part.output == Output::AcZeroCross,
            mains_v: part.mains_v,
            mains_hz: part.mains_hz,
            rated_a: part.rated_a,
            phases: f64::from(ssr.test.phases),
            blocked_a: leak_a,
            on_v: (2.0 * drop_v).min(0.6 * CLAMP_V),
            leakage_scale_v: (leak_v / HALF_SCREEN).max(LEAST_SCALE_V),
            drop_scale_v: ROOM * drop_v / HALF_SCREEN,
            digitizer,
            source,
        }
    }

    /// Returns half a period of the mains, s.
    pub fn half_s(&self) -> f64 {
        0.5 / self.mains_hz
    }

    /// Returns the peak of the line, V.
    pub fn peak_v(&self) -> f64 {
        SQRT_2 * self.mains_v
    }

    /// Returns the nominal peak of the source in a circuit, V.
    pub fn circuit_peak_v(&self, circuit: Circuit) -> f64 {
        match circuit {
            Circuit::Line => self.peak_v(),
            Circuit::Loop => SQRT_2 * self.loop_v(),
        }
    }

    /// Returns the rise of the nominal voltage of the line at its zero, V/s.
    pub fn slope(&self) -> f64 {
        std::f64::consts::TAU * self.mains_hz * self.peak_v()
    }

    /// Returns the voltage of the source that shows the gain of the clamped channel, V.
    pub fn reference_v(&self) -> f64 {
        REFERENCE * HALF_SCREEN * self.drop_scale_v
    }

    /// Returns the voltage of the source at which the loop carries the rated current, rms, V; 1 V of it allows for the
    /// drop.
    pub fn loop_v(&self) -> f64 {
        self.rated_a * LOOP_OHM + 1.0
    }

    /// Returns the current limit of the source for a level and a load, rms, A: twice the current of the load, 1 to 12
    /// A.
    pub fn limit_a(&self, level_v: f64, ohm: f64) -> f64 {
        (2.0 * level_v / ohm).clamp(1.0, 12.0)
    }

    /// Returns the time from one pulse of the train to the next, s: each pulse meets another phase of the mains.
    pub fn period_s(&self) -> f64 {
        (BETWEEN_HALVES + 1.0 / self.phases) * self.half_s()
    }

    /// Returns the length of a pulse, s.
    pub fn pulse_s(&self) -> f64 {
        PULSE_HALVES * self.half_s()
    }

    /// Returns the offset error of a channel at a scale (V per division), half width, V at the channel.
    pub fn offset_v(&self, scale_v: f64) -> f64 {
        const DIVISIONS: f64 = 4.0;
        self.digitizer.offset / self.digitizer.full_scale * DIVISIONS * scale_v
    }

    /// Returns the scales of a record of the leakage.
    pub fn leakage(&self) -> Scales {
        Scales {
            shunt_v: self.leakage_scale_v,
            ..self.line(2.0 * LEAKAGE_PERIODS * self.half_s(), LEAKAGE_POINTS)
        }
    }

    /// Returns the scale of the shunt channel for the reference resistor on the line, V per division.
    pub fn reference_shunt_v(&self) -> f64 {
        self.line(0.0, 0.0).shunt_v
    }

    /// Returns the scales of a record that only shows whether the output blocks from `off_s` after its trigger onwards.
    pub fn blocks(&self, off_s: f64) -> Scales {
        Scales {
            shunt_v: self.leakage_scale_v,
            ..self.line(self.after(off_s, BLOCKS_PERIODS), 1e3)
        }
    }

    /// Returns the scales of a record that shows whether the output conducts from `on_s` after its trigger onwards.
    pub fn conducts(&self, on_s: f64) -> Scales {
        self.line(self.after(on_s, CONDUCTS_PERIODS), 1e3)
    }

    /// Returns the length of a record that still has this number of periods at `wait_s` after its trigger, s.
    fn after(&self, wait_s: f64, periods: f64) -> f64 {
        (wait_s + 2.0 * periods * self.half_s()) / (1.0 - BEFORE)
    }

    /// Returns the scales of the record of a train of pulses.
    pub fn train(&self) -> Scales {
        let points = if self.phases > 12.0 { 1e5 } else { 2e4 };
        self.line(self.phases * self.period_s() / (1.0 - BEFORE), points)
    }

    /// Returns the scales of the record of the loop.
    pub fn looped(&self) -> Scales {
        let peak_a = SQRT_2 * self.rated_a;
        Scales {
            divided_v: MOST_LOOP_V * SQRT_2 / DIVIDER / HALF_SCREEN,
            clamped_v: self.drop_scale_v,
            shunt_v: ROOM * peak_a * LOOP_SHUNT_OHM / HALF_SCREEN,
            record_s: LOOP_S.max(0.2 + 1.1 * self.half_s()) / (1.0 - BEFORE),
            points: 6e3,
            circuit: Circuit::Loop,
        }
    }

    /// Returns the scales of the record of a staircase of the control voltage that takes `takes_s`.
    pub fn staircase(&self, takes_s: f64) -> Scales {
        let record_s = takes_s / (1.0 - BEFORE);
        let points = (PER_HALF * record_s / self.half_s()).ceil();
        self.line(record_s, points.max(1e3))
    }

    /// Returns the scales of a record on the line, of this length and number of samples, for an output that may block
    /// or conduct.
    pub fn line(&self, record_s: f64, points: f64) -> Scales {
        let load_a = self.peak_v() / LINE_OHM;
        Scales {
            divided_v: ROOM * self.peak_v() / DIVIDER / HALF_SCREEN,
            clamped_v: CLAMP_V / HALF_SCREEN,
            shunt_v: ROOM * load_a * LINE_SHUNT_OHM / HALF_SCREEN,
            record_s,
            points,
            circuit: Circuit::Line,
        }
    }
}
