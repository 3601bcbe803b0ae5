//! Levels, ranges and times of a test, as they follow from the recipe and from the accuracies of the instruments.

use super::ac_plan::AcPlan;
use super::accuracy::applied_u;
use super::parameter::Parameter;
use super::points::{Device, Points};
use super::recipe::{Method, Output, SsrRecipe};
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
/// Largest current for measuring the resistance, A.
const MOST_A: f64 = 1.0;
/// Room above a limit that a range must have.
const ROOM: f64 = 1.2;
/// Number of time constants after which an output counts as settled where the recipe limits no time.
const SETTLED: f64 = 10.0;
/// Input current that chooses its range where the recipe does not limit it, A.
const USUAL_INPUT_A: f64 = 0.05;
/// As [`USUAL_INPUT_A`], for a reverse current or a leakage, A.
const USUAL_SMALL_A: f64 = 1e-3;
/// Drop that chooses its range where the recipe does not limit it, V.
const USUAL_DROP_V: f64 = 1.5;
/// Share of the load current up to which an output counts as blocked where the recipe does not limit its leakage.
const OFF: f64 = 0.1;
/// Averaging time of the input current of an AC part, periods of the mains: its noise is far below its limits.
const HOLD: f64 = 0.1;
/// Period over which meters average, s: one of 50 Hz mains.
pub const PERIOD_S: f64 = 0.02;

/// Range of a voltage source that measures its own current; it limits the current at the end of the meter's range.
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
    /// Number of parts of a lot, from the first one on, in which a search or a ramp follows the conformity test.
    pub searched: u32,
    /// True for ramps in place of a search.
    pub ramps: bool,
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
    /// Time after the control edge within which the output must conduct, s.
    pub on_s: f64,
    /// Time after the control edge within which the output must block, s.
    pub off_s: f64,
    /// Ranges at the control input.
    pub input: CurrentRange,
    /// Ranges at the reversed control input.
    pub reverse: CurrentRange,
    /// Ranges of the load circuit.
    pub load: CurrentRange,
    /// Errors of the time base of the digitizer.
    pub time: Accuracy,
    /// Number of parts of a lot of which the test measures the sampled characteristics; `None` for all parts.
    pub sampling: Option<u32>,
    /// Characteristics with a limit; the others sort no part.
    pub judged: Vec<Parameter>,
    /// Characteristics with an upper limit. For these, a reading over range proves the limit exceeded.
    pub bounded: Vec<Parameter>,
    /// What the output switches.
    pub output: OutputPlan,
}

/// Plan of the output.
#[derive(Debug, Clone, PartialEq)]
pub enum OutputPlan {
    /// A DC load.
    Dc(DcPlan),
    /// An AC load.
    Ac(AcPlan),
}

/// Plan of an output that switches a DC load.
#[derive(Debug, Clone, PartialEq)]
pub struct DcPlan {
    /// Voltage of the blocked output, V.
    pub rated_v: f64,
    /// Current of the conducting output, A.
    pub rated_a: f64,
    /// Larger of the two currents that measure the resistance, A; the other is half of it.
    pub drop_a: f64,
    /// True when the reversed output conducts through its body diode.
    pub body_diode: bool,
    /// Largest load current at which the output counts as blocked, A.
    pub blocked_a: f64,
    /// Ranges of the leakage before conduction.
    pub leakage_cold: CurrentRange,
    /// Ranges of the leakage after conduction.
    pub leakage_hot: CurrentRange,
    /// Ranges of the resistance.
    pub drop: DropRange,
}

/// Finds the measuring ranges of the instruments.
struct Ranges<'a> {
    points: &'a Points,
    wiring: &'a Wiring,
}

impl Ranges<'_> {
    fn find(&self, device: Device, quantity: Quantity, value: f64) -> Result<Accuracy, Lack> {
        let lack = Lack {
            device,
            quantity,
            value,
        };
        let instrument = self.points.instrument(device);
        let all = &self.wiring.instrument(instrument).profile.accuracy;
        range(all, quantity, value).ok_or(lack)
    }

    fn currents(
        &self,
        device: Device,
        level_v: f64,
        ampere: f64,
        periods: f64,
    ) -> Result<CurrentRange, Lack> {
        Ok(CurrentRange {
            source: self.find(device, Quantity::SourceVoltageV, level_v)?,
            meter: self.find(device, Quantity::CurrentA, ampere)?,
            periods,
        })
    }
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
        let ranges = Ranges { points, wiring };
        let time_constant_s = test.time_constant_ms / 1e3;
        let settled_s = SETTLED * time_constant_s;
        let within = |parameter| high(parameter).map_or(settled_s, |us| us.max(0.0) / 1e6);
        let (mut on_s, mut off_s) = (
            within(Parameter::TurnOnTime),
            within(Parameter::TurnOffTime),
        );
        let input_a = high(Parameter::InputCurrent).map_or(USUAL_INPUT_A, |ma| ROOM * ma / 1e3);
        let reverse_a = high(Parameter::ReverseCurrent);
        let reverse_a = reverse_a.map_or(USUAL_SMALL_A, |ua| ROOM * ua / 1e6);
        let output = match part.output {
            Output::Dc => OutputPlan::Dc(DcPlan::of(ssr, limits, &ranges)?),
            Output::AcZeroCross | Output::AcRandom => {
                let ac = AcPlan::of(ssr, limits, &ranges)?;
                // Both times of the recipe count from a zero, which comes at most half a period after the edge.
                off_s += ac.half_s();
                on_s += if ac.zero_cross { ac.half_s() } else { 0.0 };
                OutputPlan::Ac(ac)
            }
        };
        let hold = match &output {
            OutputPlan::Dc(_) => (on_s.max(off_s) / PERIOD_S).clamp(0.01, 10.0),
            OutputPlan::Ac(_) => HOLD,
        };
        let input = ranges.currents(Device::SmuIn, part.control_v, input_a, hold)?;
        let is_bounded = |of: &Parameter| high(*of).is_some();
        let is_judged = |of: &Parameter| !limits.of(*of).is_open();
        Ok(Self {
            control_v: part.control_v,
            reverse_v: test.reverse_v,
            searched: match test.method {
                Method::Conformity => 0,
                Method::Bisect | Method::Ramp => test.searched.unwrap_or(u32::MAX),
            },
            ramps: test.method == Method::Ramp,
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
            reverse: ranges.currents(Device::SmuIn, test.reverse_v, reverse_a, 0.1)?,
            load: ranges.currents(Device::SmuOut, LOAD_V, LOAD_V / LOAD_OHM, 0.01)?,
            time: ranges.find(Device::Digitizer, Quantity::TimeS, 0.0)?,
            sampling: test.sampling,
            judged: Parameter::ALL.into_iter().filter(is_judged).collect(),
            bounded: Parameter::ALL.into_iter().filter(is_bounded).collect(),
            output,
        })
    }

    /// Returns true when the recipe limits the characteristic, so that it can fail a part.
    pub fn judges(&self, of: Parameter) -> bool {
        self.judged.contains(&of)
    }

    /// Returns true when the recipe has an upper limit of the characteristic, so that a reading over range fails the
    /// part.
    pub fn bounds(&self, of: Parameter) -> bool {
        self.bounded.contains(&of)
    }

    /// Returns the plan of an output for a DC load.
    pub fn dc(&self) -> Option<&DcPlan> {
        match &self.output {
            OutputPlan::Dc(dc) => Some(dc),
            OutputPlan::Ac(_) => None,
        }
    }

    /// Returns the plan of an output for an AC load.
    pub fn ac(&self) -> Option<&AcPlan> {
        match &self.output {
            OutputPlan::Dc(_) => None,
            OutputPlan::Ac(ac) => Some(ac),
        }
    }

    /// Returns how long a search waits at each step for the output to follow. Close to the threshold the output turns
    /// on late, by one time constant times ln(V / distance); in this time it follows every step farther from the
    /// threshold than [`Self::unseen_v`].
    pub fn dwell(&self) -> Span {
        let constants = (self.turn_on_v.unwrap_or(self.control_v) / self.unseen_v()).ln();
        Span::seconds(constants.max(1.0) * self.time_constant_s)
    }

    /// Returns the distance of the control voltage from the threshold, V, below which the output may switch later than
    /// [`Self::dwell`].
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

    /// Returns the number of samples of a record: an interval is at most 1 % of the shorter time, where the memory
    /// holds as many.
    pub fn samples(&self) -> f64 {
        let wanted = self.record_s() / (0.01 * self.on_s.min(self.off_s));
        let depths = [1e3, 1e4];
        depths.into_iter().find(|it| *it >= wanted).unwrap_or(1e5)
    }
}

impl DcPlan {
    fn of(ssr: &SsrRecipe, limits: &Limits, ranges: &Ranges) -> Result<Self, Lack> {
        let part = &ssr.part;
        let high = |parameter| limits.of(parameter).high;
        let leakage = |parameter| {
            let most_a = high(parameter).map_or(USUAL_SMALL_A, |ua| ROOM * ua / 1e6);
            ranges.currents(Device::SmuOut, part.rated_v, most_a, 1.0)
        };
        let drop_a = part.rated_a.min(MOST_A);
        let drop_v = high(Parameter::OnResistance);
        let drop_v = drop_v.map_or(USUAL_DROP_V, |mohm| ROOM * mohm / 1e3 * drop_a);
        let leak_ua = high(Parameter::LeakageHot).or(high(Parameter::LeakageCold));
        let most_a = OFF * LOAD_V / LOAD_OHM;
        Ok(Self {
            rated_v: part.rated_v,
            rated_a: part.rated_a,
            drop_a,
            body_diode: part.body_diode,
            blocked_a: leak_ua.map_or(most_a, |ua| (ua / 1e6).min(most_a)),
            leakage_cold: leakage(Parameter::LeakageCold)?,
            leakage_hot: leakage(Parameter::LeakageHot)?,
            drop: DropRange {
                source: ranges.find(Device::SmuOut, Quantity::SourceCurrentA, drop_a)?,
                meter: ranges.find(Device::SmuOut, Quantity::VoltageV, drop_v)?,
            },
        })
    }
}

impl AcPlan {
    fn of(ssr: &SsrRecipe, limits: &Limits, ranges: &Ranges) -> Result<Self, Lack> {
        let digitizer = |value| ranges.find(Device::Digitizer, Quantity::VoltageV, value);
        let source = |value| ranges.find(Device::AcSource, Quantity::VoltageV, value);
        Ok(Self::new(
            ssr,
            limits,
            digitizer(0.0)?,
            source(ssr.part.mains_v)?,
        ))
    }
}
