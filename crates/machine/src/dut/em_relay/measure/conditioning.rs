//! Conditioning: operations before the first measurement, at nominal voltage and without contact load.
//!
//! Conditioning measures nothing; the timed operation finds a relay that does not move.

use super::board::{Armature, BoardState};
use super::{Context, set};
use crate::dut::em_relay::act::Act;
use crate::dut::em_relay::points::DigitalOut::{Arm, CoilDrive, KelvinTest, RampMode, SourceOn};
use units::{Span, Volt};

/// Time for which the drive is on, and then off; operation, release and bounce end within it, with a diode too.
const HALF: Span = Span::ms(40);
/// Longest time of one operation on a line that repeats requests.
const OPERATION: Span = Span::ms(250);

/// Operates the relay as often as the recipe demands.
pub(super) fn acts(context: &Context, board: BoardState) -> (Vec<Act>, BoardState) {
    let mut supply = board.supply;
    let idle = [
        (KelvinTest, false),
        (SourceOn, false),
        (RampMode, false),
        (Arm, false),
    ];
    let nominal = supply.step_to(Volt(context.relay.part.nominal_v));
    let mut acts = vec![set(&idle), nominal, Act::Wait(board.still_ramping)];
    for _ in 0..context.relay.test.conditioning_operations {
        acts.extend([
            set(&[(CoilDrive, true)]),
            Act::Wait(HALF),
            set(&[(CoilDrive, false)]),
            Act::Mark,
            Act::Wait(HALF),
        ]);
    }
    let left = BoardState {
        supply,
        armature: Armature::Released,
        still_ramping: Span(0),
        ..board
    };
    (acts, left)
}

/// Returns the longest time that this number of operations takes.
pub(super) fn longest(operations: u32) -> Span {
    Span(OPERATION.0 * u64::from(operations))
}
