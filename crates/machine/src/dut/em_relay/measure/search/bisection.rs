//! Bisection: each trial halves the interval, from rest, so that no trial remembers the one before.

use super::{Next, Search};
use units::{Span, Volt};

/// Trials. The interval of the default lot, 2.3 V, comes down to 18 mV.
const TRIALS: u32 = 7;
/// Time at the level for a sealed armature: where the threshold is low the iron is good, and the flux of the seal takes three
/// times 25 ms to fall.
pub(super) const SEALED_DWELL: Span = Span::ms(80);

/// The middle of what is open.
pub(super) fn level(search: &Search) -> Volt {
    (search.untouched + search.changed) / 2.0
}

/// The middle of the half that is left.
pub(super) fn next(search: &Search) -> Next {
    if search.trials < TRIALS {
        return Next::Try(level(search));
    }
    match search.seen {
        [true, true] => Next::Found(level(search), (search.changed - search.untouched).abs()),
        [_, _] => Next::Ramp,
    }
}
