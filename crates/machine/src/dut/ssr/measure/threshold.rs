//! Turn-on and turn-off voltage of a DC part by a search, or by a [`ramp`]. The output switches with hysteresis, so each
//! step begins from 0 V, or from the nominal voltage for the turn-off.

use super::conformity::{is_off, is_on};
use super::dc_stage::DcStage;
use super::given::{Given, NotDelivered};
use super::ramp;
use super::search_ends;
use super::stage::Stage;
use super::state::{Next, State};
use crate::dut::ssr::accuracy;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::search::{Direction, Search};
use crate::gauge::Judgement;
use crate::instrument::act::Act;
use units::Unit;

/// Most steps of a search; one without expectation takes twelve from 40 V to 10 mV.
const MOST_STEPS: u32 = 20;
/// Excess of a width by rounding alone, V.
const ROUNDING_V: f64 = 1e-9;

/// Returns the acts of one step; none when no interval is proven to hold the threshold.
pub fn acts(state: &mut State, direction: Direction, plan: &Plan, points: &Points) -> Vec<Act> {
    if plan.ramps {
        return ramp::acts(state, direction, plan, points);
    }
    let Some(search) = state.search.or_else(|| interval(state, direction, plan)) else {
        return Vec::new();
    };
    state.search = Some(search);
    let before_v = match direction {
        Direction::Rising => 0.0,
        Direction::Falling => plan.control_v,
    };
    // After a step that has left the output as it was at the begin of every step, the next one needs none.
    let step = match search.is_ready(direction) {
        true => points.level(Device::SmuIn, search.next_v()),
        false => points.step(Device::SmuIn, before_v, search.next_v()),
    };
    vec![
        Act::Query(vec![step]),
        Act::Wait(plan.dwell()),
        Act::Query(vec![points.read(Device::SmuOut)]),
    ]
}

/// Returns the interval that holds the threshold: the output is proven to block at its lower end and to conduct at its
/// upper end.
pub fn interval(state: &State, direction: Direction, plan: &Plan) -> Option<Search> {
    let obeys = |of| state.proof(of).unwrap_or(Judgement::Pass) == Judgement::Pass;
    if !obeys(Parameter::TurnOnVoltage) || !obeys(Parameter::TurnOffVoltage) {
        return None;
    }
    let low_v = plan.turn_off_v.unwrap_or(0.0);
    let high_v = plan.turn_on_v.unwrap_or(plan.control_v);
    let turn_on = state.record.result(Parameter::TurnOnVoltage);
    let expected = state
        .learned
        .expected(direction, turn_on.map(|it| it.value));
    Some(match direction {
        Direction::Rising => Search::between(low_v, high_v, expected),
        Direction::Falling => Search::between(low_v, state.turn_on_v.unwrap_or(high_v), expected),
    })
}

/// Concludes one step.
pub fn conclude(
    state: &mut State,
    direction: Direction,
    plan: &Plan,
    given: &Given,
) -> Result<Next, NotDelivered> {
    if plan.ramps {
        return ramp::conclude(state, direction, plan, given);
    }
    let Some(mut search) = state.search else {
        return Ok(Next::Planned);
    };
    let [ampere] = given.singles(Device::SmuOut)?;
    let again = Stage::Dc(DcStage::Threshold(direction));
    search.narrow(match direction {
        Direction::Rising => is_on(ampere),
        Direction::Falling => !is_off(ampere),
    });
    let next = narrowed(state, search, (direction, again), plan);
    if next != Next::Planned {
        return Ok(next);
    }
    state.ends.keep(direction, &search);
    let is_last = direction == Direction::Falling;
    Ok(match is_last && search_ends::are_doubtful(state) {
        true => Next::Insert(Stage::Dc(DcStage::SearchEnds)),
        false => Next::Planned,
    })
}

/// Goes on with a narrowed search; `again` is the stage of its next step. After the last one the threshold is known.
pub fn narrowed(
    state: &mut State,
    search: Search,
    (direction, again): (Direction, Stage),
    plan: &Plan,
) -> Next {
    if search.width_v() > plan.resolution_v + ROUNDING_V && search.tried < MOST_STEPS {
        state.search = Some(search);
        return Next::Insert(again);
    }
    state.search = None;
    let of = match direction {
        Direction::Rising => {
            state.turn_on_v = Some(search.high_v);
            Parameter::TurnOnVoltage
        }
        Direction::Falling => Parameter::TurnOffVoltage,
    };
    let volts = search.middle_v();
    let budget = accuracy::threshold(plan, volts, search.width_v());
    state.found([(of, volts, Unit::Volt, budget)]);
    Next::Planned
}
