//! Checks of the two sensors of the air, which need no identified chamber; stepped once a second.

use super::Trouble;
use super::lasting::{Lasting, Recent};

/// Largest step of a reading, K/s.
const JUMP_K: f64 = 3.0;
/// Difference of two sensors at rest above which they disagree, K, once it has lasted for `DIFFER_S`.
const DIFFER_K: f64 = 1.0;
/// Additional difference allowed while the air moves, K per K/min of its rate; the next constant is the time, s.
const DIFFER_MIN: f64 = 0.1;
const DIFFER_S: u32 = 10;
/// Stretch that gives the rate of a reading, s. Behind a door that has just closed, warm walls heat the air faster than any
/// ramp; the slower sensor then moves towards the other.
const RATE_S: usize = 5;
/// A sensor counts as stuck when it moves by less than this within `STUCK_S` at more than `STUCK_POWER`, K.
const STUCK_K: f64 = 0.02;
const STUCK_S: usize = 60;
const STUCK_POWER: f64 = 0.3;

/// State of the checks.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensors {
    each: [Sensor; 2],
    differ: Lasting,
}

/// Checks of one sensor.
#[derive(Debug, Clone, PartialEq)]
struct Sensor {
    last_c: Option<f64>,
    moved: Recent,
    recent: Recent,
}

impl Sensor {
    fn new() -> Self {
        Self {
            last_c: None,
            moved: Recent::of(STUCK_S),
            recent: Recent::of(RATE_S),
        }
    }

    /// Returns how fast the reading moves towards one at this distance, K/min; 0 in its first seconds.
    fn towards_k_per_min(&self, distance_k: f64) -> f64 {
        60.0 * self.recent.slope().unwrap_or(0.0) * distance_k.signum()
    }

    fn step(&mut self, reading_c: Option<f64>, power: f64) -> Option<Trouble> {
        let Some(now_c) = reading_c else {
            *self = Self::new();
            return Some(Trouble::SensorBroken);
        };
        let last_c = self.last_c.replace(now_c).unwrap_or(now_c);
        if power <= STUCK_POWER {
            self.moved.clear();
        }
        self.moved.push(now_c);
        self.recent.push(now_c);
        if (now_c - last_c).abs() > JUMP_K {
            return Some(Trouble::SensorJump);
        }
        let range_k = self.moved.range();
        range_k
            .is_some_and(|it| it < STUCK_K)
            .then_some(Trouble::SensorStuck)
    }
}

impl Default for Sensors {
    fn default() -> Self {
        Self {
            each: [Sensor::new(), Sensor::new()],
            differ: Lasting::of(DIFFER_S),
        }
    }
}

impl Sensors {
    /// Checks a second: readings of control and reference sensor, C, the rate at which the air is to move now,
    /// K/min, and the power of the heater, 0 to 1. A reading that is not finite counts as missing.
    pub fn step(
        &mut self,
        readings_c: [Option<f64>; 2],
        rate_k_per_min: f64,
        power: f64,
    ) -> Vec<Trouble> {
        let readings = readings_c.map(|it| it.filter(|it| it.is_finite()));
        let mut found: Vec<Trouble> = self
            .each
            .iter_mut()
            .zip(readings)
            .filter_map(|(sensor, reading)| sensor.step(reading, power))
            .collect();
        let [control_c, reference_c] = readings;
        let apart = control_c
            .zip(reference_c)
            .is_some_and(|(control_c, reference_c)| {
                let apart_k = reference_c - control_c;
                let [control, reference] = &self.each;
                let rate_k_per_min = rate_k_per_min
                    .max(control.towards_k_per_min(apart_k))
                    .max(reference.towards_k_per_min(-apart_k));
                apart_k.abs() > DIFFER_K + DIFFER_MIN * rate_k_per_min
            });
        found.extend(self.differ.step(apart).then_some(Trouble::SensorsDiffer));
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sensors_that_disagree_for_ten_seconds_are_found() {
        let mut sensors = Sensors::default();
        let second = |sensors: &mut Sensors| sensors.step([Some(40.0), Some(42.2)], 10.0, 0.1);
        for _ in 0..9 {
            assert_eq!(second(&mut sensors), []);
        }
        assert_eq!(second(&mut sensors), [Trouble::SensorsDiffer]);
    }

    #[test]
    fn walls_behind_a_closed_door_raise_no_difference() {
        let mut sensors = Sensors::default();
        // The air jumps from 25 to 42 C; the sensors follow with lags of 4 and 9 s.
        for second in 0..120 {
            let after = |lag_s: f64| Some(42.0 - 17.0 * (-f64::from(second) / lag_s).exp());
            let found = sensors.step([after(9.0), after(6.0)], 10.0, 0.0);
            assert_eq!(found, [], "{second}");
        }
    }
}
