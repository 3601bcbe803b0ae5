//! Levels, ranges and times of a test, as they follow from the recipe and from the accuracies of the instruments.

use super::accuracy::applied_u;
use super::parameter::Parameter;
use super::points::{Device, Points};
use super::recipe::{Method, SsrRecipe};
use crate::dut::recipe::Limits;
use crate::gauge::Rule;
use crate::gauge::budget::COVERAGE_FACTOR;
use crate::rig::wiring::Wiring;
use scpi::{Accuracy, Quantity, range};
use units::Span;

/// Voltage of the source behind [`LOAD_OHM`], V.
pub const LOAD_V: f64 = 8.0;
/// Resistor between the source and the output, ohm.
pub const LOAD_OHM: f64 = 1000.0;
/// Resistance of the pulse source, ohm.
pub const PULSE_OHM: f64 = 50.0;
/// Largest current with which the resistance is measured, A.
const MOST_A: f64 = 1.0;
/// Room above a limit that a range must have.
const ROOM: f64 = 1.2;
/// Time constants after which an output has settled where no limit says more.
const SETTLED: f64 = 10.0;
/// Currents and drop for which ranges are chosen where the recipe has no limit: A, A, V.
const USUAL_INPUT_A: f64 = 0.008;
const USUAL_SMALL_A: f64 = 80e-6;
const USUAL_DROP_V: f64 = 1.5;
/// One period of the mains, s.
pub const PERIOD_S: f64 = 0.02;

/// Range of a source of voltage that measures its current; the limit of the current is the end of the meter's range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurrentRange {
    /// Errors of the voltage.
    pub source: Accuracy,
    /// Errors of the current.
    pub meter: Accuracy,
    /// Averaging time of one reading, periods of the mains.
    pub periods: f64,
}

impl CurrentRange {
    /// Returns true when the current is at its limit, so that the voltage is below the commanded one.
    pub fn is_limited(&self, ampere: f64) -> bool {
        ampere.abs() >= 0.98 * self.meter.full_scale
    }
}

/// Ranges of the measurement of the resistance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DropRange {
    /// Errors of the current.
    pub source: Accuracy,
    /// Errors of the voltage; its end is the limit of the voltage.
    pub meter: Accuracy,
}

/// A quantity for which an instrument has no range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lack {
    /// The instrument.
    pub device: Device,
    /// The quantity.
    pub quantity: Quantity,
    /// Value that no range holds, in the unit of the quantity.
    pub value: f64,
}

/// Levels, ranges and times of a test.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Nominal control voltage, V.
    pub control_v: f64,
    /// Voltage at the reversed input, V, above 0.
    pub reverse_v: f64,
    /// Voltage of the blocked output, V.
    pub rated_v: f64,
    /// Current of the conducting output, A.
    pub rated_a: f64,
    /// Larger one of the two currents of the resistance, A; the other is half of it.
    pub drop_a: f64,
    /// True when the output conducts when reversed.
    pub body_diode: bool,
    /// True when a search follows the conformity test.
    pub searches: bool,
    /// Width of the interval at which a search ends, V.
    pub resolution_v: f64,
    /// Longest time constant of the output, s.
    pub time_constant_s: f64,
    /// Voltage at which the output must conduct, V; none without a limit.
    pub turn_on_v: Option<f64>,
    /// Voltage at which the output must block, V; none without a limit.
    pub turn_off_v: Option<f64>,
    /// Distance of an applied voltage from its limit, V: the expanded uncertainty of the source, or 0.
    pub guard_v: f64,
    /// Time after which the output must conduct, s.
    pub on_s: f64,
    /// Time after which the output must block, s.
    pub off_s: f64,
    /// Ranges at the control input.
    pub input: CurrentRange,
    /// Ranges at the reversed control input.
    pub reverse: CurrentRange,
    /// Ranges of the load circuit.
    pub load: CurrentRange,
    /// Ranges of the leakage before conduction.
    pub leakage_cold: CurrentRange,
    /// Ranges of the leakage after conduction.
    pub leakage_hot: CurrentRange,
    /// Ranges of the resistance.
    pub drop: DropRange,
    /// Errors of the digitizer's base of time.
    pub time: Accuracy,
}

impl Plan {
    /// Plans a test.
    ///
    /// # Errors
    /// Fails with the first quantity for which an instrument has no range.
    pub fn of(
        ssr: &SsrRecipe,
        limits: &Limits,
        rule: Rule,
        points: &Points,
        wiring: &Wiring,
    ) -> Result<Self, Lack> {
        let (part, test) = (&ssr.part, &ssr.test);
        let high = |parameter| limits.of(parameter).high;
        let find = |device, quantity, value: f64| {
            let all = &wiring
                .instrument(points.instrument(device))
                .profile
                .accuracy;
            range(all, quantity, value).ok_or(Lack {
                device,
                quantity,
                value,
            })
        };
        let currents = |device, level_v, ampere: f64, periods| {
            Ok(CurrentRange {
                source: find(device, Quantity::SourceVoltageV, level_v)?,
                meter: find(device, Quantity::CurrentA, ampere)?,
                periods,
            })
        };
        let time_constant_s = test.time_constant_ms / 1e3;
        let settled_s = SETTLED * time_constant_s;
        let within = |parameter| high(parameter).map_or(settled_s, |us| us / 1e6);
        let (on_s, off_s) = (
            within(Parameter::TurnOnTime),
            within(Parameter::TurnOffTime),
        );
        let leakage = |parameter| {
            let most_a = high(parameter).map_or(USUAL_SMALL_A, |ua| ROOM * ua / 1e6);
            currents(Device::SmuOut, part.rated_v, most_a, 1.0)
        };
        let input_a = high(Parameter::InputCurrent).map_or(USUAL_INPUT_A, |ma| ROOM * ma / 1e3);
        let reverse_a = high(Parameter::ReverseCurrent);
        let reverse_a = reverse_a.map_or(USUAL_SMALL_A, |ua| ROOM * ua / 1e6);
        let drop_a = part.rated_a.min(MOST_A);
        let drop_v = high(Parameter::OnResistance);
        let drop_v = drop_v.map_or(USUAL_DROP_V, |mohm| ROOM * mohm / 1e3 * drop_a);
        let hold = (on_s.max(off_s) / PERIOD_S).clamp(0.01, 10.0);
        let input = currents(Device::SmuIn, part.control_v, input_a, hold)?;
        Ok(Self {
            control_v: part.control_v,
            reverse_v: test.reverse_v,
            rated_v: part.rated_v,
            rated_a: part.rated_a,
            drop_a,
            body_diode: part.body_diode,
            searches: test.method == Method::Bisect,
            resolution_v: test.resolution_mv / 1e3,
            time_constant_s,
            turn_on_v: high(Parameter::TurnOnVoltage),
            turn_off_v: limits.of(Parameter::TurnOffVoltage).low,
            guard_v: match rule {
                Rule::GuardBand => COVERAGE_FACTOR * applied_u(&input.source, part.control_v),
                Rule::Simple => 0.0,
            },
            on_s,
            off_s,
            input,
            reverse: currents(Device::SmuIn, test.reverse_v, reverse_a, 0.1)?,
            load: currents(Device::SmuOut, LOAD_V, LOAD_V / LOAD_OHM, 0.01)?,
            leakage_cold: leakage(Parameter::LeakageCold)?,
            leakage_hot: leakage(Parameter::LeakageHot)?,
            drop: DropRange {
                source: find(Device::SmuOut, Quantity::SourceCurrentA, drop_a)?,
                meter: find(Device::SmuOut, Quantity::VoltageV, drop_v)?,
            },
            time: find(Device::Digitizer, Quantity::TimeS, 0.0)?,
        })
    }

    /// Returns the time that the output needs to follow a step of a search. Close to its threshold it turns on late, by
    /// one time constant times ln(V / distance); this time shows every threshold but those within [`Self::unseen_v`].
    pub fn dwell(&self) -> Span {
        let constants = (self.turn_on_v.unwrap_or(self.control_v) / self.unseen_v()).ln();
        Span::seconds(constants.max(1.0) * self.time_constant_s)
    }

    /// Returns the distance from its threshold within which the output may not have followed a step in time, V.
    pub fn unseen_v(&self) -> f64 {
        self.resolution_v / 8.0
    }

    /// Returns the length of the control pulse, s.
    pub fn pulse_s(&self) -> f64 {
        2.0 * self.on_s
    }

    /// Returns the length of the record, s: a tenth before the edge, the pulse, the time to turn off.
    pub fn record_s(&self) -> f64 {
        (self.pulse_s() + 2.0 * self.off_s) / 0.9
    }

    /// Returns the number of samples of a record: an interval is at most 1 % of the shorter time, where the memory holds
    /// as many.
    pub fn samples(&self) -> f64 {
        let wanted = self.record_s() / (0.01 * self.on_s.min(self.off_s));
        let depths = [1e3, 1e4];
        depths.into_iter().find(|it| *it >= wanted).unwrap_or(1e5)
    }
}
