//! Resistance of the conducting output from its drops at two currents, drop at the rated current, drift by heat.

use super::board::{self, Position};
use super::given::{Given, NotDelivered};
use super::state::{Next, State};
use crate::dut::ssr::Finding;
use crate::dut::ssr::accuracy::{self, LAST_DROPS};
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::{DcPlan, Plan};
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::program::drop_count;
use crate::instrument::act::Act;
use units::{Span, Unit};

/// Share of the voltage limit from which a drop shows that the source limits its voltage and keeps less than the
/// commanded current.
const LIMITED: f64 = 0.98;

/// Returns the acts: the input at its nominal voltage, the full current over time from the cold part on, then half of it.
pub fn acts(state: &mut State, plan: &Plan, dc: &DcPlan, points: &Points) -> Vec<Act> {
    let mut acts = board::change(points, state.position, Position::Direct);
    state.position = Position::Direct;
    let control = points.source(Device::SmuIn, plan.control_v, &plan.input);
    acts.extend([
        Act::Query(vec![control]),
        Act::Wait(Span::seconds(plan.on_s)),
        Act::Query(vec![
            points.drops(dc, dc.drop_a),
            points.drop_at(dc, dc.drop_a / 2.0),
            points.off(Device::SmuOut),
        ]),
    ]);
    acts
}

/// Concludes resistance, drop and drift.
pub fn conclude(
    state: &mut State,
    plan: &Plan,
    dc: &DcPlan,
    given: &Given,
) -> Result<Next, NotDelivered> {
    let device = Device::SmuOut;
    let [full, half] = given.numbers(device)?;
    // The first number of the series repeats the last one.
    let ([half_v], Some((_, drops))) = (half, full.split_first()) else {
        return Err(NotDelivered(device));
    };
    let (Some(first_v), true) = (drops.first(), drops.len() == drop_count()) else {
        return Err(NotDelivered(device));
    };
    let most_v = drops.iter().copied().fold(*half_v, f64::max);
    if most_v >= LIMITED * dc.drop.meter.full_scale {
        // Without a limit of the resistance, a reading over range fails no part.
        if plan.bounds(Parameter::OnResistance) || plan.bounds(Parameter::Drop) {
            state.record.stop(Finding::DropTooHigh);
        }
        return Ok(Next::Planned);
    }
    let last = &drops[drops.len() - LAST_DROPS..];
    let rise_v = last.iter().sum::<f64>() / LAST_DROPS as f64 - first_v;
    let ohm = (first_v - half_v) / (dc.drop_a / 2.0);
    let of_ohm = accuracy::resistance(dc, ohm, rise_v);
    let of_drop = accuracy::drop_at_rated(dc, &of_ohm);
    let of_rise = accuracy::drift(dc, rise_v);
    state.found([
        (Parameter::Drop, ohm * dc.rated_a, Unit::Volt, of_drop),
        (Parameter::OnResistance, ohm * 1e3, Unit::Milliohm, of_ohm),
        (Parameter::Drift, rise_v * 1e3, Unit::Millivolt, of_rise),
    ]);
    Ok(Next::Planned)
}
