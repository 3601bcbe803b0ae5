//! Staircase: steps of 20 mV with a dwell until the contact changes. The slow method that decides a dispute.

use super::{Next, Search};
use units::{Span, Volt};

/// Height of a step on a 12 V coil.
pub(super) const STEP: Volt = Volt(0.020);
/// Dwell at each level after its write is acknowledged.
pub(super) const DWELL: Span = Span::ms(20);

/// Returns the first level: the near end of the interval.
pub(super) fn level(search: &Search) -> Volt {
    search.untouched
}

/// Returns the next level, or the threshold half a step before the level at which the contact changed.
pub(super) fn next(search: &Search, changed: bool) -> Next {
    let sign = search.direction.sign();
    if changed {
        return match search.seen {
            [true, true] => Next::Found(search.at - search.step * (0.5 * sign), search.step),
            [_, _] => Next::Ramp,
        };
    }
    if (search.at - search.changed).0 * sign >= 0.0 {
        return Next::Ramp;
    }
    Next::Try(search.at + search.step * sign)
}
