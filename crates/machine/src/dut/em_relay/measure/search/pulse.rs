//! Go / no-go: one step to the limit, less the uncertainty of level, probes and temperature. A contact that changes
//! proves that the part keeps the limit; otherwise ramps measure the threshold.

use super::{Next, parameter};
use crate::dut::em_relay::coil::{relative_per_kelvin, to_reference};
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::threshold::Direction;
use crate::gauge::Budget;
use units::{Celsius, Volt};

/// How far below its quasi-static threshold a relay operates on a single step, as a share of the level: the armature
/// swings beyond its equilibrium.
const SWING_SHARE: f64 = 0.0035;

/// Returns the level of the pulse; where the recipe sets no limit, the expected threshold takes its place.
pub(super) fn level(context: &Context, direction: Direction, part: Celsius) -> Volt {
    let (recipe, sign) = (&context.recipe, direction.sign());
    let limit = recipe.limits.of(parameter(direction));
    let (limit_v, expected_v) = match direction {
        Direction::Rising => (limit.high, context.relay.test.expected_operate_v),
        Direction::Falling => (limit.low, context.relay.test.expected_release_v),
    };
    let limit_v = limit_v.unwrap_or(expected_v);
    let reference = context.reference_temperature();
    let at_part_v = limit_v / to_reference(part, reference);
    let part_k = Budget::default().with_estimated("coil temperature", context.part_k());
    let u_v = at_part_v * part_k.combined() * relative_per_kelvin(part)
        + at_part_v * (context.calibration.level.gain.u + context.contact_share())
        + context.calibration.level.offset_v.u
        + context.operation_v();
    Volt(at_part_v - sign * (2.0 * u_v + at_part_v * SWING_SHARE))
}

/// Returns the consequence of the pulse.
pub(super) fn next(changed: bool) -> Next {
    if changed { Next::Proven } else { Next::Ramp }
}
