//! Turn-on and turn-off voltage of an AC part. A part on the mains decides once in a half period, so that single steps are
//! slow: the source takes the control through many levels in a row, each a little longer than a half period, and one record
//! shows at which of them the output turns on or off.

use super::super::board::Position;
use super::super::given::{Given, NotDelivered};
use super::super::stage::Stage;
use super::super::state::{Next, State};
use super::super::threshold::{interval, narrowed};
use super::stage::AcStage;
use super::{STORED, close, supply};
use crate::dut::Reason;
use crate::dut::ssr::ac_plan::{AcPlan, CLAMP_V};
use crate::dut::ssr::plan::{CurrentRange, Plan};
use crate::dut::ssr::points::{Device, Points};
use crate::dut::ssr::program::{CONTROL_CHANNEL, DIVIDED_CHANNEL, OUTPUT_CHANNEL, SHUNT_CHANNEL};
use crate::dut::ssr::search::{Direction, Search};
use crate::dut::ssr::wave::Channel;
use crate::dut::ssr::wave::staircase::{Levels, turned};
use crate::instrument::act::Act;
use units::Span;

/// Averaging time of the current at a level, periods of the mains; the value does not matter.
const BRIEF: f64 = 0.01;
/// Greatest number of steps of a staircase.
const MOST: f64 = 16.0;
/// Resolution of levels, V: the text of a level holds no further digit.
const ROUND_V: f64 = 1e-4;

/// Channels that show the level and the output, and that the line has its voltage.
const CHANNELS: [f64; 4] = [
    CONTROL_CHANNEL,
    OUTPUT_CHANNEL,
    DIVIDED_CHANNEL,
    SHUNT_CHANNEL,
];

/// Returns the levels of the next staircase of a search.
fn levels(search: &Search, direction: Direction, plan: &Plan) -> Levels {
    let (low_v, high_v) = search.window();
    let steps = ((high_v - low_v) / plan.resolution_v).ceil();
    // Two short staircases in a row resolve what a long one would.
    let steps = if steps > MOST {
        steps.sqrt().ceil()
    } else {
        steps
    };
    let step_v = (high_v - low_v) / steps.max(2.0);
    let low_v = (low_v / ROUND_V).round() * ROUND_V;
    let step_v = (step_v / ROUND_V).floor().max(1.0) * ROUND_V;
    let all = (0_u32..).map(|it| low_v + step_v * f64::from(it));
    let all = all.take_while(|it| *it <= high_v + ROUND_V);
    // The ends of the interval are known.
    let is_open = |it: &f64| search.low_v < *it - ROUND_V && *it + ROUND_V < search.high_v;
    let inside: Vec<f64> = all.filter(is_open).collect();
    let (first_v, last_v) = match inside.as_slice() {
        [first_v, .., last_v] => (*first_v, *last_v),
        // A staircase has two levels at least.
        [] | [_] => (search.low_v, search.high_v),
    };
    let count = ((last_v - first_v) / step_v).round() as usize + 1;
    match direction {
        Direction::Rising => Levels {
            before_v: 0.0,
            first_v,
            step_v,
            count,
        },
        Direction::Falling => Levels {
            before_v: plan.control_v,
            first_v: last_v,
            step_v: -step_v,
            count,
        },
    }
}

/// Returns the acts of a staircase; none when no interval is proven to hold the threshold.
pub fn acts(
    state: &mut State,
    direction: Direction,
    plan: &Plan,
    ac: &AcPlan,
    points: &Points,
) -> Vec<Act> {
    let Some(search) = state.search.or_else(|| interval(state, direction, plan)) else {
        return Vec::new();
    };
    state.search = Some(search);
    let levels = levels(&search, direction, plan);
    let dwell_s = dwell_s(plan, ac);
    let scales = ac.staircase(levels.count as f64 * dwell_s);
    let brief = CurrentRange {
        periods: BRIEF,
        ..plan.input
    };
    let mut acts = close(state, Position::Line, ac, points);
    acts.extend([
        Act::Query(vec![
            points.source(Device::SmuIn, levels.before_v, &brief),
            points.capture_step(plan, &scales, (levels.before_v, levels.first_v)),
        ]),
        // The output blocks or conducts as it must before the first level, from the next zero on.
        Act::Wait(Span::seconds(ac.half_s() + plan.time_constant_s)),
        Act::Mark,
        Act::Query(vec![points.staircase(&levels, dwell_s)]),
        Act::WaitSinceMark(Span::seconds(scales.record_s) + STORED),
        Act::Query(points.record(&scales, &CHANNELS)),
    ]);
    acts
}

/// Returns the time at a level, s: between two zeros of the mains, and as long as a part near its threshold is late.
fn dwell_s(plan: &Plan, ac: &AcPlan) -> f64 {
    ac.half_s() + plan.dwell().as_seconds()
}

/// Concludes a staircase.
pub fn conclude(
    state: &mut State,
    direction: Direction,
    plan: &Plan,
    ac: &AcPlan,
    given: &Given,
) -> Result<Next, Reason> {
    let Some(mut search) = state.search else {
        return Ok(Next::Planned);
    };
    let [control, output, divided, shunt] = given.waveforms()?;
    let channels = Channel::of(&control, 1.0, 0.0).zip(Channel::of(&output, 1.0, 0.0));
    let on_v = ac.on_v.min(CLAMP_V / 2.0);
    let levels = levels(&search, direction, plan);
    let scales = ac.staircase(levels.count as f64 * dwell_s(plan, ac));
    supply::proven(ac, &scales, [&divided, &shunt])?;
    let turned = channels.and_then(|(control, output)| turned(&control, &output, &levels, on_v));
    let turned = turned.ok_or(NotDelivered(Device::Digitizer))?;
    match direction {
        Direction::Rising => search.narrow_to(turned.without_v, turned.with_v),
        Direction::Falling => search.narrow_to(turned.with_v, turned.without_v),
    }
    let again = Stage::Ac(AcStage::Threshold(direction));
    Ok(narrowed(state, search, (direction, again), plan))
}
