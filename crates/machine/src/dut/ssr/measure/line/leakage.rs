//! Leakage of a blocked AC part: one record of voltage and current, split into a resistive and a capacitive part.

use super::super::board::Position;
use super::super::given::{Given, NotDelivered};
use super::super::state::{Next, State};
use super::stage::AcStage;
use super::supply::{self, FULL, Fed};
use super::{STORED, close};
use crate::dut::Reason;
use crate::dut::ssr::Finding;
use crate::dut::ssr::ac_accuracy::{self as accuracy, LeakageOf};
use crate::dut::ssr::ac_plan::{AcPlan, DIVIDER, LINE_SHUNT_OHM, Scales};
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::program::{DIVIDED_CHANNEL, SHUNT_CHANNEL};
use crate::dut::ssr::references::{Doubt, References};
use crate::dut::ssr::wave::Channel;
use crate::dut::ssr::wave::mains::Mains;
use crate::dut::ssr::wave::split::{Admittance, Phasor, phasor};
use crate::instrument::act::Act;
use crate::instrument::query::{Query, Waveform};
use units::{Span, Unit};

/// Least amplitude of the voltage at the output, as a share of the nominal one; the greatest is 2 minus this.
const BLOCKED: f64 = 0.8;
/// Rms of the voltage around its fit, as a share of the amplitude: an output that fires now and then leaves more.
const CURVED: f64 = 0.1;
/// A polarity whose peak is below this share of the nominal one counts as conducting: the load has the rest.
const CONDUCTS: f64 = 0.3;

/// Result of reading a record of a blocked output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Seen {
    /// The output blocks.
    Blocked(Leak),
    /// The output blocks, and its current is over the range of the channel.
    Beyond,
    /// The output conducts in one polarity.
    Half,
    /// The output conducts in both polarities.
    Conducts,
    /// The line does not have its nominal voltage.
    WrongMains,
    /// The line was open or without its source for a while.
    Dead,
}

/// Current of a blocked output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leak {
    /// Admittance of the output.
    pub admittance: Admittance,
    /// Frequency of the line, Hz.
    pub hz: f64,
    /// Standard uncertainty from noise of either part at the nominal voltage, A.
    pub noise_a: f64,
    /// Noise of the references that have corrected the admittance; `None` without them.
    pub referenced: Option<Doubt>,
}

/// Returns the acts that take a record of the blocked output with these scales at a control voltage, reached from the
/// present one; `besides` goes to another instrument during the record.
pub fn record_acts(
    plan: &Plan,
    points: &Points,
    scales: &Scales,
    (level_v, wait_s): (f64, f64),
    besides: Option<Query>,
) -> Vec<Act> {
    let mut acts = vec![
        Act::Query(vec![
            points.source(Device::SmuIn, level_v, &plan.input),
            points.capture_all(plan, scales),
        ]),
        Act::Wait(Span::seconds(wait_s)),
        Act::Query(vec![points.force_trigger()]),
        Act::Mark,
    ];
    acts.extend(besides.map(|it| Act::Query(vec![it])));
    acts.extend([
        Act::WaitSinceMark(Span::seconds(scales.record_s) + STORED),
        Act::Query(points.record(scales, &[DIVIDED_CHANNEL, SHUNT_CHANNEL])),
    ]);
    acts
}

/// Returns the acts of a leakage without control. The pulse source, which is slow, takes the train meanwhile.
pub fn acts(
    state: &mut State,
    stage: AcStage,
    plan: &Plan,
    ac: &AcPlan,
    points: &Points,
) -> Vec<Act> {
    let mut acts = close(state, Position::Line, ac, points);
    let besides = match stage == AcStage::LeakageHot {
        true => None,
        false => state.prepare_pulses(plan, points),
    };
    let scales = ac.leakage();
    acts.extend(record_acts(plan, points, &scales, (0.0, 0.0), besides));
    acts
}

/// Reads a record of a blocked output on the line; `None` when the two channels do not fit each other or a sample is
/// not finite.
pub fn seen(ac: &AcPlan, waveforms: [&Waveform; 2]) -> Option<Seen> {
    seen_at(ac, ac.peak_v(), &ac.leakage(), waveforms)
}

/// Reads a record for a nominal peak of the output voltage, V.
pub fn seen_at(
    ac: &AcPlan,
    peak_v: f64,
    scales: &Scales,
    [divided, shunt]: [&Waveform; 2],
) -> Option<Seen> {
    match supply::fed(ac, scales, [divided, shunt])? {
        Fed::Whole => {}
        Fed::Broken => return Some(Seen::Dead),
        Fed::Wrong => return Some(Seen::WrongMains),
    }
    let end_a = FULL * scales.shunt_v / LINE_SHUNT_OHM;
    let volts = Channel::of(divided, DIVIDER, 0.0)?;
    let current = Channel::of(shunt, 1.0 / LINE_SHUNT_OHM, 0.0)?;
    match [1.0, -1.0].map(|sign| volts.peak(sign) < CONDUCTS * peak_v) {
        [true, true] => return Some(Seen::Conducts),
        [true, false] | [false, true] => return Some(Seen::Half),
        [false, false] => {}
    }
    if current.reaches(end_a) {
        // The output charges at once when an open line closes; a leakage comes back in every period.
        let period = ((2.0 * ac.half_s() / current.step_s) as usize).max(1);
        let always = (0..current.len() / period)
            .map(|it| it * period..(it + 1) * period)
            .all(|mut it| it.any(|index| current.at(index).abs() >= end_a));
        return Some(if always { Seen::Beyond } else { Seen::Dead });
    }
    let mains = Mains::fit(volts.pairs(0, volts.len(), 1), ac.mains_hz);
    let is_near = |it: &Mains| {
        let is_whole = it.residual < CURVED * it.amplitude();
        is_whole && (BLOCKED..2.0 - BLOCKED).contains(&(it.amplitude() / peak_v))
    };
    let Some(mains) = mains.filter(is_near) else {
        return Some(Seen::WrongMains);
    };
    let phasor = phasor(current.pairs(0, current.len(), 1), mains.hz)?;
    Some(Seen::Blocked(leak(ac, &mains, &phasor)))
}

fn leak(ac: &AcPlan, mains: &Mains, phasor: &Phasor) -> Leak {
    let admittance = Admittance::of(mains, phasor.of);
    let noise = phasor.u.hypot(admittance.size() * mains.u);
    Leak {
        admittance,
        hz: mains.hz,
        noise_a: noise / mains.amplitude() * ac.mains_v,
        referenced: None,
    }
}

impl Leak {
    /// Returns resistive and capacitive current at the nominal voltage and frequency, A.
    pub fn split_a(&self, ac: &AcPlan) -> (f64, f64) {
        let nominal = self.admittance.at_hz(self.hz, ac.mains_hz);
        (
            nominal.conductance * ac.mains_v,
            nominal.susceptance * ac.mains_v,
        )
    }

    /// Returns the leakage of the part without that of the fixture; unchanged without references.
    fn corrected(self, references: Option<References>) -> Self {
        let Some(references) = references else {
            return self;
        };
        Self {
            admittance: references.corrected(self.admittance),
            referenced: Some(references.doubt),
            ..self
        }
    }

    /// Returns the whole current at the nominal voltage and frequency, rms, A.
    pub fn rms_a(&self, ac: &AcPlan) -> f64 {
        let (resistive_a, capacitive_a) = self.split_a(ac);
        resistive_a.hypot(capacitive_a)
    }
}

/// Concludes a leakage.
pub fn conclude(
    state: &mut State,
    stage: AcStage,
    plan: &Plan,
    ac: &AcPlan,
    given: &Given,
) -> Result<Next, Reason> {
    let is_hot = stage == AcStage::LeakageHot;
    let [divided, shunt] = given.waveforms()?;
    let seen = seen(ac, [&divided, &shunt]).ok_or(NotDelivered(Device::Digitizer))?;
    let (of, beyond, conducting) = match is_hot {
        true => (Parameter::LeakageHot, Finding::LeaksHot, Finding::StuckOn),
        false => (Parameter::LeakageCold, Finding::Leaks, Finding::Shorted),
    };
    match seen {
        Seen::Blocked(leak) => found(state, &leak.corrected(state.references), of, ac),
        Seen::Beyond if plan.bounds(of) => state.record.stop(beyond),
        Seen::Beyond => {}
        Seen::Half | Seen::Conducts => state.record.stop(conducting),
        Seen::WrongMains => state.record.stop(Finding::WrongMains),
        Seen::Dead => state.record.stop(Finding::LineDead),
    }
    Ok(Next::Planned)
}

fn found(state: &mut State, leak: &Leak, of: Parameter, ac: &AcPlan) {
    let unit = Unit::Microampere;
    let (resistive_a, capacitive_a) = leak.split_a(ac);
    let budget = |part, value_a: f64| accuracy::line_leakage(ac, leak, part, value_a);
    let rms_a = leak.rms_a(ac);
    state.found([(of, rms_a / 1e-6, unit, budget(LeakageOf::Whole, rms_a))]);
    if of == Parameter::LeakageCold {
        state.found([
            (
                Parameter::LeakageResistive,
                resistive_a / 1e-6,
                unit,
                budget(LeakageOf::Resistive, resistive_a),
            ),
            (
                Parameter::LeakageCapacitive,
                capacitive_a / 1e-6,
                unit,
                budget(LeakageOf::Capacitive, capacitive_a),
            ),
        ]);
    }
}
