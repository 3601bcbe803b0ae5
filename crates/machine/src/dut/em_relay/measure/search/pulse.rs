//! Go / no-go: one step to the limit, less what the level, the probes and the temperature may be off. A contact that
//! changes proves the limit kept; one that does not proves nothing, and ramps measure it.

use super::{Next, parameter};
use crate::dut::em_relay::coil::{relative_per_kelvin, to_reference};
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::threshold::Direction;
use units::{Celsius, Volt};

/// A step picks up so much below the quasi-static threshold, of its level: the armature swings over.
const KINDER: f64 = 0.0035;

/// Level of the pulse; the expected threshold where the recipe sets no limit.
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
    let u_v = at_part_v * context.accuracy.part_minus_track_k * relative_per_kelvin(part)
        + at_part_v * (context.calibration.level.gain.u + context.contact_share())
        + context.calibration.level.offset_v.u
        + context.operation_v();
    Volt(at_part_v - sign * (2.0 * u_v + at_part_v * KINDER))
}

/// One bit.
pub(super) fn next(changed: bool) -> Next {
    if changed { Next::Proven } else { Next::Ramp }
}
