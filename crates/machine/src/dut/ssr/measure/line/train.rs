//! Train of control pulses whose period shifts the phase of the mains from pulse to pulse. One record gives the times,
//! the voltage at turn-on, and the voltage at later half cycles.

use super::super::board::{Position, RELAY};
use super::super::given::Given;
use super::super::state::{Next, Pulses, State};
use super::{STORED, close, conclude_ready, leave, loop_level, supply};
use crate::dut::Reason;
use crate::dut::ssr::Finding;
use crate::dut::ssr::ac_accuracy as accuracy;
use crate::dut::ssr::ac_plan::{AcPlan, BEFORE, CLAMP_V, DIVIDER};
use crate::dut::ssr::marks;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::Points;
use crate::dut::ssr::program::{CONTROL_CHANNEL, DIVIDED_CHANNEL, OUTPUT_CHANNEL, SHUNT_CHANNEL};
use crate::dut::ssr::references::References;
use crate::dut::ssr::wave::Channel;
use crate::dut::ssr::wave::mains::Mains;
use crate::dut::ssr::wave::pulses::{Answer, Output, Pulse};
use crate::instrument::act::Act;
use crate::instrument::query::Waveform;
use units::{Span, Unit};

/// Least voltage of the mains at the edge of a pulse, as a share of the peak, from which the turn-on time of a part
/// with random turn-on counts: nearer to zero the load current is too small to latch.
const LATCHES: f64 = 0.3;

/// Channels of the record that the test reads. The source takes longer to go to the voltage of the loop than the
/// digitizer to deliver them.
const CHANNELS: [f64; 4] = [
    CONTROL_CHANNEL,
    DIVIDED_CHANNEL,
    OUTPUT_CHANNEL,
    SHUNT_CHANNEL,
];
/// Time from a zero of the mains within which the voltage shows the time of a turn-on, microseconds.
const NEAR_US: f64 = 400.0;
/// Share of the clamp voltage up to which the clamped channel follows the signal, so that it can be compared with the
/// divided one.
const FOLLOWED: f64 = 0.85;

/// Returns the acts of the train. The test reads the record after the contactor of the line has opened, while the
/// source goes to the voltage of the loop.
pub fn acts(state: &mut State, plan: &Plan, ac: &AcPlan, points: &Points) -> Vec<Act> {
    let scales = ac.train();
    let mut acts = close(state, Position::LinePulsed, ac, points);
    let mut queries: Vec<_> = state.prepare_pulses(plan, points).into_iter().collect();
    queries.push(points.capture_all(plan, &scales));
    state.pulses = Pulses::Sent;
    acts.extend([
        Act::Query(queries),
        // The digitizer needs the part of its record before the trigger, the output a zero of its current.
        Act::Wait(Span::seconds(2.0 * BEFORE * scales.record_s)),
        Act::WaitSinceMark(Span::seconds(ac.half_s()).max(RELAY)),
        Act::Query(vec![points.start()]),
        Act::Wait(Span::seconds(scales.record_s) + STORED),
    ]);
    acts.extend(leave(state, points));
    let mut queries = points.record(&scales, &CHANNELS);
    queries.extend(state.end_pulses(points));
    queries.extend(loop_level(state, ac, points));
    acts.push(Act::Query(queries));
    acts
}

/// Mains and answers of the output, read from the record of a train.
pub struct Walk {
    /// The mains, fitted while the output blocks.
    pub mains: Mains,
    /// Answer to each pulse.
    pub answers: Vec<Answer>,
    /// Interval between two samples, s.
    pub step_s: f64,
}

/// Reads the record of a train; `None` when the channels do not fit each other, or the output never blocks.
pub fn walk(
    ac: &AcPlan,
    references: Option<References>,
    [divided, clamped]: [&Waveform; 2],
) -> Option<Walk> {
    let (gain, clamped_gain) = references.map_or((1.0, 1.0), |it| (it.divided_gain, it.gain));
    let output = Output {
        divided: Channel::of(divided, DIVIDER / gain, 0.0)?,
        clamped: Channel::of(clamped, 1.0 / clamped_gain, 0.0)?,
        clamp_v: CLAMP_V,
        on_v: ac.on_v,
    };
    if !output.divided.is_beside(&output.clamped) {
        return None;
    }
    // The mains has no offset, so the offset of the fit is that of the channel.
    let mains = output.mains(ac.mains_hz)?;
    let (divided, mains) = (output.divided.less(mains.offset), mains.centred());
    let clamped = output.clamped.less(beside(&divided, &output)?);
    let output = Output {
        divided,
        clamped,
        ..output
    };
    // The first edge is the trigger, which lies before its sample by half an interval on average; the period is exact.
    let step_s = output.divided.step_s;
    let pulse = |number: u32| {
        let rise_s = f64::from(number) * ac.period_s() - step_s / 2.0;
        Pulse {
            rise_s,
            fall_s: rise_s + ac.pulse_s(),
            end_s: rise_s + ac.period_s(),
        }
    };
    let answers = (0..ac.phases as u32).map(|number| output.answer(&mains, pulse(number)));
    Some(Walk {
        mains,
        answers: answers.collect(),
        step_s,
    })
}

/// Returns the offset of the clamped channel against the divided one, V, from the samples that both follow.
fn beside(divided: &Channel, output: &Output) -> Option<f64> {
    let both = (0..divided.len()).map(|it| (divided.at(it), output.clamped.at(it)));
    let follows = both.filter(|(_, clamped)| clamped.abs() < FOLLOWED * output.clamp_v);
    let (sum, count) = follows.fold((0.0, 0.0), |(sum, count), (divided, clamped)| {
        (sum + clamped - divided, count + 1.0)
    });
    (count > 0.0).then(|| sum / count)
}

/// Concludes the train.
pub fn conclude(
    state: &mut State,
    plan: &Plan,
    ac: &AcPlan,
    given: &Given,
) -> Result<Next, Reason> {
    conclude_ready(state, ac, given);
    let [_control, divided, clamped, shunt] = given.waveforms()?;
    // On a line that has died the output answers wrongly, or seems to conduct well.
    supply::proven(ac, &ac.train(), [&divided, &shunt])?;
    let walk = walk(ac, state.references, [&divided, &clamped]);
    judge(state, plan, ac, walk);
    Ok(Next::Planned)
}

/// Finds times and voltages, or why there are none.
fn judge(state: &mut State, plan: &Plan, ac: &AcPlan, walk: Option<Walk>) {
    let Some(walk) = walk else {
        state.record.stop(Finding::PulseNotRecorded);
        return;
    };
    mark(state, &walk);
    if walk.answers.iter().any(|it| it.on.is_none()) {
        if plan.bounds(Parameter::TurnOnTime) {
            state.record.stop(Finding::TurnsOnTooLate);
        }
        return;
    }
    on_found(state, plan, ac, &walk);
    if walk.answers.iter().all(|it| it.off_s.is_some()) {
        off_found(state, plan, &walk);
    } else if plan.bounds(Parameter::TurnOffTime) {
        state.record.stop(Finding::TurnsOffTooLate);
    }
}

/// Marks the zeros of the mains from which times count, and the instants at which the output switches.
fn mark(state: &mut State, walk: &Walk) {
    let trace = &mut state.record.trace;
    for it in &walk.answers {
        trace.mark(marks::ZERO, it.zero_s);
        it.on.iter().for_each(|on| trace.mark(marks::ON, on.at_s));
        trace.mark(marks::ZERO, it.off_zero_s);
        it.off_s
            .iter()
            .for_each(|off_s| trace.mark(marks::OFF, *off_s));
    }
}

/// Finds turn-on time, zero-cross voltage and retrigger voltage. Each is the greatest value over all pulses: the mean
/// of the values that lie within two intervals of the samples of the greatest one.
fn on_found(state: &mut State, plan: &Plan, ac: &AcPlan, walk: &Walk) {
    let us = Unit::Microsecond;
    let counts =
        |it: &&Answer| ac.zero_cross || it.edge_v.abs() >= LATCHES * walk.mains.amplitude();
    let late = |it: &Answer| {
        let took_s = match ac.zero_cross {
            true => it.after_zero_s(&walk.mains, ac.slope()),
            false => it.on.map(|on| on.at_s - it.pulse.rise_s),
        };
        took_s.map(|it| it * 1e6)
    };
    let step_v = walk.mains.slope(walk.answers[0].zero_s).abs() * walk.step_s;
    let is_referenced = state.references.is_some();
    let times = walk.answers.iter().filter(counts).filter_map(late);
    if let Some((latest, count)) = around_greatest(times, walk.step_s * 1e6) {
        let is_near = ac.zero_cross && latest.abs() < NEAR_US;
        let budget = match is_near {
            true => {
                let volts = latest / 1e6 * ac.slope();
                let budget =
                    accuracy::turn_on_voltage(ac, is_referenced, step_v, (volts.abs(), count));
                accuracy::scaled(&budget, 1e6 / ac.slope())
            }
            false if ac.zero_cross => accuracy::line_time(plan, walk, (latest, count)),
            false => accuracy::from_trigger(plan, walk, (latest, count)),
        };
        state.found([(Parameter::TurnOnTime, latest, us, budget)]);
    }
    let volts = |it: &Answer| it.on.map(|on| on.before.abs());
    if ac.zero_cross
        && let Some((value, count)) = around_greatest(walk.answers.iter().filter_map(volts), step_v)
    {
        let budget = accuracy::turn_on_voltage(ac, is_referenced, step_v, (value, count));
        state.found([(Parameter::ZeroCross, value, Unit::Volt, budget)]);
    }
    // Later half cycles of a pulse are nearly a whole number of samples apart, and err alike: they count as one.
    let again = |it: &Answer| {
        let sum: f64 = it.again_v.iter().sum();
        (!it.again_v.is_empty()).then(|| sum / it.again_v.len() as f64)
    };
    let again = walk.answers.iter().filter_map(again);
    if let Some((value, count)) = around_greatest(again, step_v) {
        let budget = accuracy::turn_on_voltage(ac, is_referenced, step_v, (value, count));
        state.found([(Parameter::Retrigger, value, Unit::Volt, budget)]);
    }
}

/// Returns the mean of all values within two steps of the greatest one, and their number.
fn around_greatest(values: impl Iterator<Item = f64> + Clone, step: f64) -> Option<(f64, usize)> {
    let most = values.clone().max_by(f64::total_cmp)?;
    let near: Vec<f64> = values.filter(|it| *it > most - 2.0 * step).collect();
    Some((near.iter().sum::<f64>() / near.len() as f64, near.len()))
}

fn off_found(state: &mut State, plan: &Plan, walk: &Walk) {
    let late = |it: &Answer| it.off_after_zero_s(&walk.mains).map(|it| it * 1e6);
    let times = walk.answers.iter().filter_map(late);
    if let Some(latest) = times.max_by(f64::total_cmp) {
        let budget = accuracy::line_time(plan, walk, (latest, 1));
        state.found([(Parameter::TurnOffTime, latest, Unit::Microsecond, budget)]);
    }
}
