//! Conformity of an AC part: after a step of its control to the turn-off voltage it blocks within its turn-off time,
//! and after a step to the turn-on voltage it conducts within its turn-on time in both polarities.
//!
//! The control voltage stays a guard band away from the limit, on the side that is harder for the part. When a part
//! fails there, the test tries a guard band beyond the limit, then far beyond: this tells a wrong threshold from an
//! output that is stuck on or never turns on.

use super::super::board::Position;
use super::super::given::{Given, NotDelivered};
use super::super::stage::Stage;
use super::super::state::{Next, State};
use super::leakage::{Seen, record_acts, seen};
use super::stage::{AcStage, Shift};
use super::{STORED, close, supply};
use crate::dut::Reason;
use crate::dut::ssr::Finding;
use crate::dut::ssr::ac_plan::{AcPlan, CLAMP_V, DIVIDER, Scales};
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::program::{DIVIDED_CHANNEL, OUTPUT_CHANNEL, SHUNT_CHANNEL};
use crate::dut::ssr::wave::pulses::Output;
use crate::dut::ssr::wave::{Channel, tail};
use crate::gauge::{Judgement, Side};
use crate::instrument::act::Act;
use crate::instrument::query::Waveform;
use units::Span;

/// A polarity counts as blocked when its voltage exceeds that of a conducting output for more than this share of a half
/// period.
const BLOCKED: f64 = 0.4;
/// The current of a blocked output may exceed its limit by this share, because the digitizer has errors.
const ROOM: f64 = 0.05;

/// Time after a step of the control, s, from which an output that still conducts is stuck on, and one that still blocks
/// never turns on.
const LATE_S: f64 = 0.2;

/// Channels that show whether the output conducts, while the line has its voltage.
const CONDUCTS_CHANNELS: [f64; 3] = [DIVIDED_CHANNEL, OUTPUT_CHANNEL, SHUNT_CHANNEL];

/// Polarities that conduct in a period of a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Conducting {
    /// Both polarities.
    Both,
    /// One polarity.
    One,
    /// No polarity.
    None,
}

/// Returns the acts of the turn-off test: the output conducts at the nominal control voltage for a period and a half,
/// then the control goes down.
pub fn block_acts(
    state: &mut State,
    shift: Shift,
    plan: &Plan,
    ac: &AcPlan,
    points: &Points,
) -> Vec<Act> {
    let limit_v = plan.turn_off_v.unwrap_or(0.0);
    let level_v = match shift {
        Shift::Within => plan
            .turn_off_v
            .map_or(0.0, |limit_v| limit_v + plan.guard_v),
        Shift::Beyond => (limit_v - plan.guard_v).max(0.0),
        Shift::Far => 0.0,
        Shift::Late => {
            let mut acts = close(state, Position::Line, ac, points);
            let scales = ac.blocks(0.0);
            acts.extend(record_acts(plan, points, &scales, (0.0, LATE_S), None));
            return acts;
        }
    };
    falling_acts(state, (level_v, plan.off_s), plan, ac, points)
}

/// Returns the acts that let the part conduct at its nominal voltage for a period and record its answer to a step down
/// to a level, beginning with the step. The part must block from `within_s` after the step onwards.
fn falling_acts(
    state: &mut State,
    (level_v, within_s): (f64, f64),
    plan: &Plan,
    ac: &AcPlan,
    points: &Points,
) -> Vec<Act> {
    let scales = ac.blocks(within_s);
    let mut acts = close(state, Position::Line, ac, points);
    acts.extend([
        Act::Query(vec![
            points.source(Device::SmuIn, plan.control_v, &plan.input),
            points.capture_step(plan, &scales, (plan.control_v, level_v)),
        ]),
        Act::Wait(Span::seconds(plan.on_s.max(ac.half_s()))),
        Act::Query(vec![points.level(Device::SmuIn, level_v)]),
    ]);
    acts.extend(recorded(&scales, &[DIVIDED_CHANNEL, SHUNT_CHANNEL], points));
    acts
}

/// Returns true when the record of the digitizer shows an output that blocks from `from_s` after its trigger onwards;
/// fails with the reason when the line shows nothing of the output.
fn blocks(ac: &AcPlan, given: &Given, from_s: f64) -> Result<bool, Reason> {
    let all: [_; 2] = given.waveforms()?;
    let [divided, shunt] = all.map(|it| tail(&it, from_s));
    let seen = seen(ac, [&divided, &shunt]).ok_or(NotDelivered(Device::Digitizer))?;
    match seen {
        Seen::Blocked(leak) => Ok(leak.rms_a(ac) <= (1.0 + ROOM) * ac.blocked_a),
        Seen::Beyond | Seen::Half | Seen::Conducts => Ok(false),
        Seen::WrongMains => Err(Finding::WrongMains.into()),
        Seen::Dead => Err(Finding::LineDead.into()),
    }
}

/// Concludes a turn-off test.
pub fn conclude_blocks(
    state: &mut State,
    shift: Shift,
    plan: &Plan,
    ac: &AcPlan,
    given: &Given,
) -> Result<Next, Reason> {
    let of = Parameter::TurnOffVoltage;
    let from_s = if shift == Shift::Late {
        0.0
    } else {
        plan.off_s
    };
    match (blocks(ac, given, from_s)?, shift) {
        (true, Shift::Within) => {
            let proven = (of, Judgement::Pass);
            state.proven.extend(plan.turn_off_v.map(|_| proven));
        }
        (true, Shift::Beyond) => state.proven.push((of, Judgement::Conditional(Side::Low))),
        (true, Shift::Far) => state.record.stop(Finding::ConductsBelowTurnOff),
        (false, Shift::Within) if plan.turn_off_v.is_none() => {
            state.record.stop(Finding::StuckOn);
        }
        (false, Shift::Within) => {
            return Ok(Next::Insert(Stage::Ac(AcStage::Blocks(Shift::Beyond))));
        }
        (false, Shift::Beyond) => return Ok(Next::Insert(Stage::Ac(AcStage::Blocks(Shift::Far)))),
        (false, Shift::Far) => return Ok(Next::Insert(Stage::Ac(AcStage::Blocks(Shift::Late)))),
        (true, Shift::Late) if plan.bounds(Parameter::TurnOffTime) => {
            state.record.stop(Finding::TurnsOffTooLate);
        }
        (true, Shift::Late) => {}
        (false, Shift::Late) => state.record.stop(Finding::StuckOn),
    }
    Ok(Next::Planned)
}

/// Returns the acts of the turn-on test, from 0 V up.
pub fn conduct_acts(
    state: &mut State,
    shift: Shift,
    plan: &Plan,
    ac: &AcPlan,
    points: &Points,
) -> Vec<Act> {
    let limit_v = plan.turn_on_v.unwrap_or(plan.control_v);
    let level_v = match shift {
        Shift::Within => plan
            .turn_on_v
            .map_or(plan.control_v, |it| it - plan.guard_v),
        Shift::Beyond => limit_v + plan.guard_v,
        Shift::Far | Shift::Late => plan.control_v,
    };
    if shift == Shift::Late {
        return late_acts(state, plan, ac, points);
    }
    rising_acts(state, (level_v, plan.on_s), plan, ac, points)
}

/// Returns the acts that record the output 0.2 s after its control has gone to the nominal voltage.
fn late_acts(state: &mut State, plan: &Plan, ac: &AcPlan, points: &Points) -> Vec<Act> {
    let scales = ac.conducts(0.0);
    let mut acts = close(state, Position::Line, ac, points);
    acts.extend([
        Act::Query(vec![
            points.source(Device::SmuIn, plan.control_v, &plan.input),
            points.capture_all(plan, &scales),
        ]),
        Act::Wait(Span::seconds(LATE_S)),
        Act::Query(vec![points.force_trigger()]),
    ]);
    acts.extend(recorded(&scales, &CONDUCTS_CHANNELS, points));
    acts
}

/// Returns the acts that step the control from 0 V to a level and record the output, beginning with the step. The
/// output must conduct from `within_s` after the step onwards.
fn rising_acts(
    state: &mut State,
    (level_v, within_s): (f64, f64),
    plan: &Plan,
    ac: &AcPlan,
    points: &Points,
) -> Vec<Act> {
    let scales = ac.conducts(within_s);
    let mut acts = close(state, Position::Line, ac, points);
    acts.extend([
        Act::Query(vec![
            points.source(Device::SmuIn, 0.0, &plan.input),
            points.capture_step(plan, &scales, (0.0, level_v)),
        ]),
        // The output blocks before the step, whatever the level was before: at the next zero of the current.
        Act::Wait(Span::seconds(ac.half_s() + plan.time_constant_s)),
        Act::Query(vec![points.level(Device::SmuIn, level_v)]),
    ]);
    acts.extend(recorded(&scales, &CONDUCTS_CHANNELS, points));
    acts
}

/// Returns the acts that wait for the end of a record and read channels of it.
fn recorded(scales: &Scales, channels: &[f64], points: &Points) -> [Act; 2] {
    [
        Act::Wait(Span::seconds(scales.record_s) + STORED),
        Act::Query(points.record(scales, channels)),
    ]
}

/// Returns which polarities conduct in the period from `from_s` after the trigger of a record on; fails with the reason
/// when the line was dead in it.
fn conducting(ac: &AcPlan, given: &Given, from_s: f64) -> Result<Conducting, Reason> {
    let [divided, clamped, shunt] = given.waveforms()?;
    supply::proven(ac, &ac.conducts(from_s), [&divided, &shunt])?;
    let seen = of_period(ac, [&divided, &clamped], from_s);
    seen.ok_or(NotDelivered(Device::Digitizer).into())
}

fn of_period(ac: &AcPlan, [divided, clamped]: [&Waveform; 2], from_s: f64) -> Option<Conducting> {
    let output = Output {
        divided: Channel::of(divided, DIVIDER, 0.0)?,
        clamped: Channel::of(clamped, 1.0, 0.0)?,
        clamp_v: CLAMP_V,
        on_v: ac.on_v,
    };
    let half = (ac.half_s() / output.divided.step_s) as usize;
    let first = output.divided.index(from_s);
    let last = first + 2 * half;
    if last > output.divided.len() {
        return None;
    }
    let blocked = |sign: f64| {
        let above = (first..last).filter(|it| sign * output.at(*it) > ac.on_v);
        above.count() as f64 > BLOCKED * half as f64
    };
    Some(match (blocked(1.0), blocked(-1.0)) {
        (false, false) => Conducting::Both,
        (true, false) | (false, true) => Conducting::One,
        (true, true) => Conducting::None,
    })
}

/// Concludes a turn-on test.
pub fn conclude_conducts(
    state: &mut State,
    shift: Shift,
    plan: &Plan,
    ac: &AcPlan,
    given: &Given,
) -> Result<Next, Reason> {
    let of = Parameter::TurnOnVoltage;
    let from_s = if shift == Shift::Late { 0.0 } else { plan.on_s };
    match (conducting(ac, given, from_s)?, shift) {
        (Conducting::One, Shift::Within | Shift::Beyond) => {
            return Ok(Next::Insert(Stage::Ac(AcStage::Conducts(Shift::Far))));
        }
        // Half a period late shows as one polarity, too.
        (Conducting::One, Shift::Far) => {
            return Ok(Next::Insert(Stage::Ac(AcStage::Conducts(Shift::Late))));
        }
        (Conducting::One, Shift::Late) => state.record.stop(Finding::HalfWave),
        (Conducting::Both, Shift::Within) => {
            let proven = (of, Judgement::Pass);
            state.proven.extend(plan.turn_on_v.map(|_| proven));
        }
        (Conducting::Both, Shift::Beyond) => {
            state.proven.push((of, Judgement::Conditional(Side::High)));
        }
        (Conducting::Both, Shift::Far) => state.record.stop(Finding::BlocksAboveTurnOn),
        (Conducting::Both, Shift::Late) => state.record.stop(Finding::TurnsOnTooLate),
        (Conducting::None, Shift::Within) if plan.turn_on_v.is_none() => {
            state.record.stop(Finding::NeverOn);
        }
        (Conducting::None, Shift::Within) => {
            return Ok(Next::Insert(Stage::Ac(AcStage::Conducts(Shift::Beyond))));
        }
        (Conducting::None, Shift::Beyond) => {
            return Ok(Next::Insert(Stage::Ac(AcStage::Conducts(Shift::Far))));
        }
        (Conducting::None, Shift::Far) => {
            return Ok(Next::Insert(Stage::Ac(AcStage::Conducts(Shift::Late))));
        }
        (Conducting::None, Shift::Late) => state.record.stop(Finding::NeverOn),
    }
    Ok(Next::Planned)
}
