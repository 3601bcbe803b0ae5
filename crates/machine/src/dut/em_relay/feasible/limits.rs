//! Limits of a recipe beyond the reach of its test: with such a limit every part would fail, or a bad part would pass.

use super::Reach;
use crate::dut::accuracy::READABLE_V;
use crate::dut::em_relay::measure::{BOUNCE_WINDOW, LONGEST_OPERATION};
use crate::dut::em_relay::parameter::Parameter;
use crate::dut::em_relay::points::AnalogIn;
use crate::dut::em_relay::recipe::RelayRecipe;
use crate::dut::recipe::Limits;
use crate::rig::fault::Fault;

/// Current of the contact source of the board, ampere.
const CONTACT_SOURCE_A: f64 = 1.0;

/// Returns a fault for each limit beyond the reach of the test; the fault states where that reach ends.
pub(super) fn faults(
    recipe: &RelayRecipe,
    limits: &Limits,
    reach: &Reach,
) -> impl Iterator<Item = Fault> {
    Parameter::ALL.into_iter().flat_map(move |parameter| {
        let limit = limits.of(parameter);
        let sides = [("low", limit.low), ("high", limit.high)];
        let most = most(parameter, recipe, reach);
        sides.into_iter().filter_map(move |(side, value)| {
            let (value, (most, end)) = (value?, most.as_ref()?);
            let expected = format!("at most {most:.2} {end}");
            (value > *most)
                .then(|| Fault::new(format!("limits.{parameter}.{side}"), value, expected))
        })
    })
}

/// Returns the highest value that the test can find, in the unit of the parameter, and what sets this bound. `None` for
/// the coil resistance: another check compares it with the range of its current channel.
fn most(parameter: Parameter, recipe: &RelayRecipe, reach: &Reach) -> Option<(f64, String)> {
    let test = &recipe.test;
    let most = match parameter {
        Parameter::CoilResistance => return None,
        Parameter::OperateVoltage | Parameter::ReleaseVoltage => (
            test.prebias_v + test.coarse_span_v,
            "V: the end of the coarse ramp, test.prebias_v + test.coarse_span_v".to_owned(),
        ),
        Parameter::OperateTime | Parameter::ReleaseTime => (
            LONGEST_OPERATION.as_seconds() * 1e3,
            "ms: the test waits no longer for a contact".to_owned(),
        ),
        Parameter::OperateBounce | Parameter::ReleaseBounce => (
            BOUNCE_WINDOW.as_seconds() * 1e3,
            "ms: the window of the counters is closed then".to_owned(),
        ),
        Parameter::ContactResistanceNo | Parameter::ContactResistanceNc => {
            let drop = AnalogIn::ContactDrop;
            let gain = reach.wiring.analog_in(reach.points.analog(drop)).gain;
            let end = format!("mOhm: {drop} reads no more at {CONTACT_SOURCE_A} A");
            (READABLE_V / gain / CONTACT_SOURCE_A * 1e3, end)
        }
    };
    Some(most)
}
