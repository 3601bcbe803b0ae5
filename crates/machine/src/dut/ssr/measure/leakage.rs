//! Leakage of the blocked output at its rated voltage, before and after conduction.

use super::board::{self, Position, RELAY};
use super::dc_stage::DcStage;
use super::given::{Given, NotDelivered};
use super::stage::Stage;
use super::state::{Next, State};
use crate::dut::Reason;
use crate::dut::ssr::Finding;
use crate::dut::ssr::accuracy::leakage;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::{CurrentRange, DcPlan, Plan};
use crate::dut::ssr::points::{Device, DigitalOut, Points};
use crate::dut::ssr::references::OpenFixture;
use crate::instrument::act::{Act, Read};
use crate::instrument::query::Query;
use crate::rig::point::Point;
use units::{RigTime, Unit};

/// Share of the current of a blocked output that the open fixture may take.
const OPEN: f64 = 0.1;
/// Largest difference of the voltage at the socket from that of the source, as a share of the rated one.
const FED: f64 = 0.2;

fn range(stage: DcStage, dc: &DcPlan) -> (Parameter, &CurrentRange, Finding) {
    match stage == DcStage::HotLeakage {
        true => (Parameter::LeakageHot, &dc.leakage_hot, Finding::LeaksHot),
        false => (Parameter::LeakageCold, &dc.leakage_cold, Finding::Leaks),
    }
}

/// Returns the acts that measure the leakage, in both directions unless a body diode conducts in reverse.
///
/// The current limit is the end of the meter's range: a part that conducts draws no more, and the range does not
/// overflow. Each direction takes two readings; during the short first one the output charges.
pub fn acts(
    state: &mut State,
    stage: DcStage,
    plan: &Plan,
    dc: &DcPlan,
    points: &Points,
) -> Vec<Act> {
    let (_, range, _) = range(stage, dc);
    let mut acts = board::change(points, state.position, Position::Direct);
    state.position = Position::Direct;
    let mut queries = vec![points.off(Device::SmuIn)];
    queries.extend(in_each_direction(dc, range, points));
    // The pulse source, which is slow, takes the pulse meanwhile.
    if stage == DcStage::ColdLeakage {
        queries.extend(state.prepare_pulses(plan, points));
    }
    acts.push(Act::Query(queries));
    acts.push(Act::Read(Read::points([Point::Analog(points.residual)])));
    acts
}

fn in_each_direction(dc: &DcPlan, range: &CurrentRange, points: &Points) -> Vec<Query> {
    let levels_v = [dc.rated_v, -dc.rated_v].into_iter();
    let levels_v = levels_v.take(directions(dc));
    levels_v
        .map(|volts| points.settle_and_read(Device::SmuOut, volts, range))
        .collect()
}

const fn directions(dc: &DcPlan) -> usize {
    if dc.body_diode { 1 } else { 2 }
}

/// Returns the acts that measure the leakage of the fixture without a part.
pub fn open_acts(state: &mut State, dc: &DcPlan, points: &Points) -> Vec<Act> {
    let mut acts = board::change(points, state.position, Position::Isolated);
    state.position = Position::Isolated;
    let open = &[DigitalOut::BleedOpen, DigitalOut::Reference0];
    let connected = &[
        DigitalOut::BleedOpen,
        DigitalOut::Reference0,
        DigitalOut::SmuToOutput,
    ];
    let mut queries = in_each_direction(dc, &dc.leakage_cold, points);
    queries.push(points.off(Device::SmuOut));
    acts.extend([
        Act::Set(points.outputs(open)),
        Act::Wait(RELAY),
        Act::Set(points.outputs(connected)),
        Act::Wait(RELAY),
        Act::Query(queries),
        Act::Set(points.outputs(open)),
        Act::Wait(RELAY),
        Act::Set(points.outputs(&[])),
        Act::Wait(RELAY),
    ]);
    acts
}

/// Concludes the open fixture, whose current may be at most a tenth of that at which a part counts as blocked.
pub fn conclude_open(
    state: &mut State,
    dc: &DcPlan,
    given: &Given,
    now: RigTime,
) -> Result<Next, NotDelivered> {
    let device = Device::SmuOut;
    let all = given.lists(device, directions(dc))?;
    let mut both_a = [0.0; 2];
    for (numbers, of) in all.into_iter().zip(&mut both_a) {
        (*of, _) = Given::settled(device, numbers)?;
    }
    let [forward_a, reversed_a] = both_a;
    if both_a.iter().any(|it| it.abs() > OPEN * dc.blocked_a) {
        state.record.stop(Finding::WrongReference);
        return Ok(Next::Planned);
    }
    state.open = Some(OpenFixture {
        forward_a,
        reversed_a,
        at: now,
    });
    Ok(Next::Planned)
}

/// Returns true when the socket has the voltage of the last direction: an open lead of the source would show no leakage.
fn has_voltage(dc: &DcPlan, given: &Given) -> bool {
    let last_v = match directions(dc) {
        1 => dc.rated_v,
        _both => -dc.rated_v,
    };
    let residual = given.readings.analog(given.points.residual).last();
    let volts = residual.and_then(|it| it.good());
    volts.is_some_and(|it| (it - last_v).abs() < FED * dc.rated_v)
}

/// Concludes a leakage: the greater one of both directions.
pub fn conclude(
    state: &mut State,
    stage: DcStage,
    plan: &Plan,
    dc: &DcPlan,
    given: &Given,
) -> Result<Next, Reason> {
    let (of, range, finding) = range(stage, dc);
    let device = Device::SmuOut;
    let all = given.lists(device, directions(dc))?;
    let fixture_a = state
        .open
        .map_or([0.0; 2], |it| [it.forward_a, it.reversed_a]);
    let mut most = (0.0, 0.0);
    for (numbers, fixture_a) in all.into_iter().zip(fixture_a) {
        let (ampere, moved) = Given::settled(device, numbers)?;
        if range.is_limited(ampere) {
            most = (ampere.abs(), moved);
            break;
        }
        let ampere = ampere - fixture_a;
        if ampere.abs() >= f64::abs(most.0) {
            most = (ampere.abs(), moved);
        }
    }
    let (ampere, moved) = most;
    if !range.is_limited(ampere) && !has_voltage(dc, given) {
        return Err(Finding::LoopDead.into());
    }
    if range.is_limited(ampere) {
        state.suspected = plan.bounds(of).then_some(finding);
        return Ok(Next::Insert(Stage::Dc(DcStage::StuckShort)));
    }
    let budget = leakage(range, (dc.rated_v, ampere), moved, state.open.is_some());
    state.found([(of, ampere / 1e-6, Unit::Microampere, budget)]);
    Ok(Next::Planned)
}
