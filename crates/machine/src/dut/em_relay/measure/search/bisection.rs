//! Bisection: each trial halves the interval and starts anew, so that no trial depends on the one before.

use super::{Next, Search};
use units::{Span, Volt};

/// Number of trials: the interval of the default lot, 2.3 V, shrinks to 18 mV.
const TRIALS: u32 = 7;
/// Dwell of a sealed armature at the level: a low threshold means good iron, in which the flux of the seal takes three
/// times 25 ms to decay.
pub(super) const SEALED_DWELL: Span = Span::ms(80);

/// Returns the middle of the interval.
pub(super) fn level(search: &Search) -> Volt {
    (search.untouched + search.changed) / 2.0
}

/// Returns the next level, the middle of the interval. After the last trial returns the threshold, if trials have
/// confirmed both ends of the interval; else a ramp must find it.
pub(super) fn next(search: &Search) -> Next {
    if search.trials < TRIALS {
        return Next::Try(level(search));
    }
    match search.seen {
        [true, true] => Next::Found(level(search), (search.changed - search.untouched).abs()),
        [_, _] => Next::Ramp,
    }
}
