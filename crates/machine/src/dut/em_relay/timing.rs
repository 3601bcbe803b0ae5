//! Times from the gated counters.
//!
//! Gate 0 is open from the start event to the latched first make, gate 1 while the window is open and the selected
//! contact is open. So `N0 / f` is the operate or release time without bounce, and `(N1 - N0) / f` the open time of
//! the bounces after the first make. A count is the floor of a length with a random phase: unbiased, sd at most half a
//! period. Bounces shorter than one period of the 50 kHz clock (20 us) are not counted.

use crate::gauge::Factor;
use crate::gauge::budget::{Budget, Reading, rectangular};
use units::Unit;

/// Reference clock of both counters.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    /// Nominal frequency, hertz.
    pub hz: f64,
    /// Half width of the tolerance of the frequency, parts per million.
    pub tolerance_ppm: f64,
}

/// Returns the counts of a counter between two reads, across its 32-bit wrap.
pub fn counts(before: u32, after: u32) -> u32 {
    after.wrapping_sub(before)
}

/// Returns the rms error of a count with uniform phase and uniform length, in milliseconds: `1 / (sqrt(6) f)`.
fn count_u_ms(clock: Clock) -> f64 {
    1e3 / (clock.hz * 6f64.sqrt())
}

/// Returns the length of one gate in milliseconds.
pub fn gate_ms(gate: u32, delay_us: Factor, clock: Clock) -> Reading {
    let value = f64::from(gate) / clock.hz * 1e3 - delay_us.value / 1e3;
    let budget = Budget::default()
        .with_random("count", count_u_ms(clock))
        .with("gate delay", delay_us.u / 1e3)
        .with("clock", value * rectangular(clock.tolerance_ppm) * 1e-6);
    Reading {
        value,
        unit: Unit::Millisecond,
        budget,
    }
}

/// Returns the total open time of the bounces in milliseconds, from both gates.
///
/// Each count is the floor of a length on the same clock, so each has its own count error.
pub fn bounce_ms(gate0: u32, gate1: u32, delay_us: [Factor; 2], clock: Clock) -> Reading {
    let open_ms = (f64::from(gate1) - f64::from(gate0)) / clock.hz * 1e3;
    let value = (open_ms - (delay_us[1].value - delay_us[0].value) / 1e3).max(0.0);
    let budget = Budget::default()
        .with_random("count", count_u_ms(clock) * 2f64.sqrt())
        .with("gate delay", delay_us[0].u.hypot(delay_us[1].u) / 1e3)
        .with("clock", value * rectangular(clock.tolerance_ppm) * 1e-6);
    Reading {
        value,
        unit: Unit::Millisecond,
        budget,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CLOCK: Clock = Clock {
        hz: 50_000.0,
        tolerance_ppm: 50.0,
    };

    #[test]
    fn differences_survive_the_wrap_of_the_counter() {
        assert_eq!(counts(u32::MAX - 1, 3), 5);
    }

    #[test]
    fn a_gate_time_excludes_the_gate_delay() {
        let time = gate_ms(236, Factor::new(10.0, 2.0), CLOCK);
        assert!((time.value - 4.71).abs() < 1e-12);
        assert!(time.expanded() < 0.02);
    }

    #[test]
    fn bounce_is_the_difference_of_both_gates() {
        let delays = [Factor::new(10.0, 1.0), Factor::new(-5.0, 1.0)];
        let bounce = bounce_ms(236, 252, delays, CLOCK);
        assert!((bounce.value - 0.335).abs() < 1e-12);
    }
}
