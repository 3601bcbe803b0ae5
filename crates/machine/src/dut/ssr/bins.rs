//! Bins of solid-state relays that fail.

use crate::rig::bin::Bin;

/// Control input: open or shorted LED, wrong input current, aged LED.
pub const INPUT: Bin = Bin::named("input");
/// Output: shorted, too much drop, poor heat transfer, never off, never on.
pub const OUTPUT: Bin = Bin::named("output");
/// Leakage of the blocked output.
pub const LEAKAGE: Bin = Bin::named("leakage");
/// Slow to turn on or off.
pub const TIME: Bin = Bin::named("time");

/// Every bin, worst first.
pub const WORST_FIRST: &[Bin] = &[INPUT, OUTPUT, LEAKAGE, TIME];
