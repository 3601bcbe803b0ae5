//! Repeats the ends of both searches of a DC part. A lead that breaks for a moment looks like an output that blocks, a short
//! like one that conducts, and either moves the threshold that a search finds. A hysteresis like that of the lot shows that
//! neither search was disturbed.

use super::conformity::{is_off, is_on};
use super::given::{Given, NotDelivered};
use super::state::{Next, State};
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::Plan;
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::search::{Direction, Search};
use crate::instrument::act::Act;

/// Distance of a repeated end from that of the search, as a share of the width of its interval: a threshold at the end may
/// have moved a little since.
const MARGIN: f64 = 0.25;

/// Least distance of a doubtful turn-off voltage from the expected one, in reaches of a search (two standard deviations).
const UNLIKELY: f64 = 1.5;

/// Ends of the intervals in which both searches of a part have ended, V.
#[derive(Debug, Clone, Copy, Default)]
pub struct SearchEnds {
    rising: Option<(f64, f64)>,
    falling: Option<(f64, f64)>,
}

impl SearchEnds {
    /// Keeps the ends of a search that is over, moved outwards by [`MARGIN`].
    pub fn keep(&mut self, direction: Direction, search: &Search) {
        let margin_v = MARGIN * search.width_v();
        let ends = ((search.low_v - margin_v).max(0.0), search.high_v + margin_v);
        match direction {
            Direction::Rising => self.rising = Some(ends),
            Direction::Falling => self.falling = Some(ends),
        }
    }

    fn both(self) -> Option<[(f64, f64); 2]> {
        Some([self.rising?, self.falling?])
    }
}

/// Returns true when both thresholds are known and their difference is not the one that the lot lets expect.
pub fn are_doubtful(state: &State) -> bool {
    let volts = |of| state.record.result(of).map(|it| it.value);
    let thresholds = volts(Parameter::TurnOnVoltage).zip(volts(Parameter::TurnOffVoltage));
    let Some((on_v, off_v)) = thresholds.filter(|_| state.ends.both().is_some()) else {
        return false;
    };
    let expected = state.learned.expected(Direction::Falling, Some(on_v));
    expected.is_none_or(|it| (off_v - it.at_v).abs() > UNLIKELY * it.reach_v)
}

/// Returns the acts: up through the ends of the turn-on voltage, then down through those of the turn-off voltage. The output
/// conducts at the upper one of these only if it has turned on before, so the upper end of the turn-on voltage needs no
/// reading.
pub fn acts(state: &State, plan: &Plan, points: &Points) -> Vec<Act> {
    let Some([rising, falling]) = state.ends.both() else {
        return Vec::new();
    };
    let steps = [
        points.step(Device::SmuIn, 0.0, rising.0),
        points.step(Device::SmuIn, rising.1, falling.1),
        points.level(Device::SmuIn, falling.0),
    ];
    let act = |step| {
        [
            Act::Query(vec![step]),
            Act::Wait(plan.dwell()),
            Act::Query(vec![points.read(Device::SmuOut)]),
        ]
    };
    steps.into_iter().flat_map(act).collect()
}

/// Concludes the ends: drops both thresholds when one of the ends differs from its search. The limits stay proven, because
/// other stages prove them.
pub fn conclude(state: &mut State, given: &Given) -> Result<Next, NotDelivered> {
    if state.ends.both().is_none() {
        return Ok(Next::Planned);
    }
    let [below, held, dropped] = given.singles(Device::SmuOut)?;
    if !is_off(below) || !is_on(held) || !is_off(dropped) {
        state.record.forget(Parameter::TurnOnVoltage);
        state.record.forget(Parameter::TurnOffVoltage);
    }
    Ok(Next::Planned)
}
