//! Staircase: up (or down) in steps of 20 mV with a dwell, until the contact changes. Slow, and made of
//! nothing but levels: the method that settles a dispute.

use super::{Next, Search};
use units::{Span, Volt};

/// Height of a step.
const STEP: Volt = Volt(0.020);
/// Time at each level, after its write was answered.
pub(super) const DWELL: Span = Span::ms(20);

/// First level: the near end of the interval.
pub(super) fn level(search: &Search) -> Volt {
    search.untouched
}

/// One step on; half a step back from the level at which the contact changed.
pub(super) fn next(search: &Search, changed: bool) -> Next {
    let sign = search.direction.sign();
    if changed {
        return match search.seen {
            [true, true] => Next::Found(search.at - STEP * (0.5 * sign), STEP),
            [_, _] => Next::Ramp,
        };
    }
    if (search.at - search.changed).0 * sign >= 0.0 {
        return Next::Ramp;
    }
    Next::Try(search.at + STEP * sign)
}
