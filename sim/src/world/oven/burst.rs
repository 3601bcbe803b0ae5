//! The power unit of the heater: it passes whole half cycles of the mains, in time frames (bases) of one second.
//!
//! At the beginning of each base the unit reads the duty, passes that share of the half cycles, and then blocks until
//! the next base. It carries the remaining fraction of a half cycle to the next base, so the mean power is exact.

/// Half cycles in one base: 100 of 50 Hz mains in a second.
const HALF_CYCLES: u32 = 100;

/// Length of a half cycle, microseconds.
const HALF_CYCLE_US: u64 = 10_000;

/// Length of a base, microseconds.
const BASE_US: u64 = HALF_CYCLES as u64 * HALF_CYCLE_US;

/// State of a power unit.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BurstFiring {
    /// Time since the beginning of the base, microseconds.
    phase_us: u64,
    /// Time of this base for which the unit conducts, from its beginning, microseconds.
    on_us: u64,
    /// Fraction of a half cycle carried from earlier bases, below 1.
    carry: f64,
}

impl BurstFiring {
    /// Advances to the next switching of the unit, at most by `most_us`; returns the time advanced, microseconds, and
    /// true when the unit conducted in it. A new `duty` (0 to 1, clamped) takes effect at the next base.
    pub fn run(&mut self, duty: f64, most_us: u64) -> (u64, bool) {
        if self.phase_us == 0 {
            self.begin(duty);
        }
        let on = self.phase_us < self.on_us;
        let end_us = if on { self.on_us } else { BASE_US };
        let us = most_us.min(end_us - self.phase_us);
        self.phase_us = (self.phase_us + us) % BASE_US;
        (us, on)
    }

    /// Begins a base.
    fn begin(&mut self, duty: f64) {
        let asked = duty.clamp(0.0, 1.0) * f64::from(HALF_CYCLES) + self.carry;
        // A millionth of a half cycle absorbs rounding, so that a duty of 0.07 gives 7 half cycles every time.
        let whole = (asked + 1e-6).floor().min(f64::from(HALF_CYCLES));
        self.carry = (asked - whole).max(0.0);
        self.on_us = whole as u64 * HALF_CYCLE_US;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the number of half cycles that the unit passes in each of `bases` seconds.
    fn half_cycles(duty: f64, bases: u64) -> Vec<u64> {
        let mut unit = BurstFiring::default();
        let mut per_base = Vec::new();
        for _ in 0..bases {
            let (mut passed_us, mut on_us) = (0, 0);
            while passed_us < BASE_US {
                let (us, on) = unit.run(duty, BASE_US);
                passed_us += us;
                on_us += if on { us } else { 0 };
            }
            assert_eq!(on_us % HALF_CYCLE_US, 0);
            per_base.push(on_us / HALF_CYCLE_US);
        }
        per_base
    }

    #[test]
    fn a_fraction_of_a_half_cycle_is_carried() {
        assert_eq!(half_cycles(0.125, 4), [12, 13, 12, 13]);
        assert_eq!(half_cycles(0.07, 3), [7, 7, 7]);
        assert_eq!(half_cycles(0.002, 6).iter().sum::<u64>(), 1);
    }

    #[test]
    fn the_mean_power_is_exact_within_one_half_cycle() {
        for duty in [0.0, 0.0013, 0.3333, 0.777, 0.9999, 1.0, 7.0] {
            let sum: u64 = half_cycles(duty, 1000).iter().sum();
            let asked = f64::min(duty, 1.0) * 100_000.0;
            assert!((sum as f64 - asked).abs() <= 1.0, "{duty}: {sum}");
        }
    }

    #[test]
    fn a_new_duty_waits_for_the_next_base() {
        let mut unit = BurstFiring::default();
        assert_eq!(unit.run(0.5, 300_000), (300_000, true));
        assert_eq!(unit.run(0.0, 300_000), (200_000, true));
        assert_eq!(unit.run(0.0, 800_000), (500_000, false));
        assert_eq!(unit.run(0.0, 800_000), (800_000, false));
    }
}
