//! Instants of results that the curves of a part show as marks.

/// Zero of the mains from which a time counts.
pub const ZERO: &str = "next_zero";
/// Instant at which the output turns on.
pub const ON: &str = "switch_on";
/// Instant at which the output turns off.
pub const OFF: &str = "switch_off";
