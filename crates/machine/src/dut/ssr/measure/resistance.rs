//! Resistance of the conducting output from its drops at two currents, drop at the rated current, drift by heat.

use super::board::{self, Position};
use super::given::{Given, NotDelivered};
use super::state::{Next, State};
use crate::dut::ssr::Finding;
use crate::dut::ssr::accuracy;
use crate::dut::ssr::parameter::Parameter;
use crate::dut::ssr::plan::{DcPlan, PERIOD_S, Plan};
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::program::drop_count;
use crate::dut::ssr::wave::warming;
use crate::instrument::act::Act;
use units::{Span, Unit};

/// Share of the voltage limit from which a drop shows that the source limits its voltage and keeps less than the
/// commanded current.
const LIMITED: f64 = 0.98;
/// Greatest distance of the drops from their course, standard deviation, as a multiple of the noise of a drop and as a share
/// of the rise: a lead that breaks or a short that closes meanwhile leaves more.
const UNEVEN: f64 = 6.0;
const CURVED: f64 = 0.1;
/// Times after the begin of the current between which the drift counts, s.
const DRIFT_S: [f64; 2] = [0.01, 0.2];
/// Time from the half current to its reading, periods of the mains: least and greatest.
const AFTER: [f64; 2] = [0.0, 0.2];

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
    if drops.len() != drop_count() {
        return Err(NotDelivered(device));
    }
    let most_v = drops.iter().copied().fold(*half_v, f64::max);
    if most_v >= LIMITED * dc.drop.meter.full_scale {
        // Without a limit of the resistance, a reading over range fails no part.
        if plan.bounds(Parameter::OnResistance) || plan.bounds(Parameter::Drop) {
            state.record.stop(Finding::DropTooHigh);
        }
        return Ok(Next::Planned);
    }
    let course = warming::course(drops).ok_or(NotDelivered(device))?;
    let rise_v = course.at(DRIFT_S[1] / PERIOD_S) - course.at(DRIFT_S[0] / PERIOD_S);
    let noise_v = dc.drop.meter.noise_over(1.0);
    if course.residual() > UNEVEN * noise_v + CURVED * rise_v.abs() {
        state.record.stop(Finding::Contradictory);
        return Ok(Next::Planned);
    }
    let (cold_v, warm_v) = (course.at(0.0), course.at(drops.len() as f64));
    // Half of the current makes a quarter of the heat; the rest of the junction's heat decays.
    let warmth = |left: f64| 0.5 * (warm_v - cold_v) * (0.25 + 0.75 * left);
    let [soon_v, late_v] = AFTER.map(|it| warmth(course.left(it)));
    let half_v = half_v - f64::midpoint(soon_v, late_v);
    let ohm = (cold_v - half_v) / (dc.drop_a / 2.0);
    let of_ohm = accuracy::resistance(dc, ohm, (soon_v - late_v) / 2.0);
    let of_drop = accuracy::drop_at_rated(dc, &of_ohm);
    let of_rise = accuracy::drift(dc, rise_v);
    state.found([
        (Parameter::Drop, ohm * dc.rated_a, Unit::Volt, of_drop),
        (Parameter::OnResistance, ohm * 1e3, Unit::Milliohm, of_ohm),
        (Parameter::Drift, rise_v * 1e3, Unit::Millivolt, of_rise),
    ]);
    Ok(Next::Planned)
}
