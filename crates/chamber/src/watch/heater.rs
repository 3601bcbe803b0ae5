//! Heat at the surface of the heater: a heater that gets power is warmer than the air.
//!
//! The surface exceeds the air by `offset + rise × power`, behind the lag of the heater. The check learns both figures
//! in each batch: the offset, an error of the two thermometers against each other, while the heater has no power; the
//! rise during the first minute of power.
//!
//! A heater counts as open when it shows less than a quarter of the expected excess: an open one shows nothing, one that
//! has lost half of its power shows half. The thermometers leave a doubt about the excess. The check judges only an
//! expected excess of four times the doubt or more. Then the doubt neither hides an open heater nor makes one with
//! half its power look open.
//!
//! ```text
//! doubt = 0.5 K + 6 s × rate of the air
//! least power = 4 × doubt / rise: 4.5 % in still air with a rise of 44 K, 9 % at 5 K/min
//! ```
//! Below the least power the check is silent. There the air of an open heater falls behind its set point, and the
//! controller adds power until the check judges.

use super::lasting::{Lasting, Recent};

/// Time constants, s, between which that of a heater with its thermometer lies. Of two low-passes of the power with these,
/// the lower one bounds the excess from below, the higher one from above.
const LAGS_S: [f64; 2] = [6.0, 20.0];
/// Change of the offset within a batch, K: cold junction, amplifier, radiation of the walls.
const DRIFT_K: f64 = 0.5;
/// Difference of the lags of the two thermometers, s: a moving air shows as an excess.
const APART_S: f64 = 6.0;
/// Share of the expected excess below which the heater is open.
const OPEN_SHARE: f64 = 0.25;
/// Time for which it must be below, s.
const LASTS_S: u32 = 10;
/// Stretch that gives the rate of the air and the mean excess, s.
const STRETCH_S: usize = 10;
/// Time without power after which the surface has the temperature of the air, s.
const QUIET_S: u32 = 90;
/// Time of power that gives the rise, s, and least power that counts.
const LEARNS_S: u32 = 60;
const LEARNS_FROM: f64 = 0.1;

/// Excess of the surface without power.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Offset {
    offset_k: f64,
    doubt_k: f64,
}

/// State of the check, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Heater {
    /// Low-passes of the power with [`LAGS_S`].
    powers: [f64; 2],
    air: Recent,
    excess: Recent,
    quiet_s: u32,
    offset: Option<Offset>,
    /// Seconds of power so far, with the sums of excess and power over them.
    learnt_s: u32,
    learnt: [f64; 2],
    open: Lasting,
}

impl Default for Heater {
    fn default() -> Self {
        Self {
            powers: [0.0; 2],
            air: Recent::of(STRETCH_S),
            excess: Recent::of(STRETCH_S),
            quiet_s: 0,
            offset: None,
            learnt_s: 0,
            learnt: [0.0; 2],
            open: Lasting::of(LASTS_S),
        }
    }
}

impl Heater {
    /// Takes the readings of a second, C, and the power of that second, 0 to 1; returns true when the heater is open.
    /// Without a reading of the surface the check judges nothing.
    pub fn step(&mut self, air_c: f64, surface_c: Option<f64>, power: f64) -> bool {
        for (low_pass, lag_s) in self.powers.iter_mut().zip(LAGS_S) {
            *low_pass += (power - *low_pass) / lag_s;
        }
        self.quiet_s = if power > 0.0 { 0 } else { self.quiet_s + 1 };
        self.air.push(air_c);
        let Some(surface_c) = surface_c else {
            self.excess.clear();
            self.open.step(false);
            return false;
        };
        self.excess.push(surface_c - air_c);
        let is_open = self.judge();
        self.open.step(is_open.unwrap_or(false))
    }

    /// Returns whether the excess is that of an open heater; `None` where the check does not judge.
    fn judge(&mut self) -> Option<bool> {
        let moves_k = APART_S * self.air.slope()?.abs();
        let excess_k = self.excess.mean()?;
        if self.quiet_s >= QUIET_S {
            self.learn_offset(excess_k, DRIFT_K + moves_k);
        }
        let Offset { offset_k, doubt_k } = self.offset?;
        let excess_k = excess_k - offset_k;
        let [low, high] = [f64::min, f64::max].map(|of| self.powers.into_iter().reduce(of));
        let (low, high) = (low?, high?);
        if self.learnt_s < LEARNS_S {
            if low >= LEARNS_FROM {
                self.learnt_s += 1;
                self.learnt = [self.learnt[0] + excess_k, self.learnt[1] + high];
            }
            return None;
        }
        let expected_k = self.learnt[0] / self.learnt[1] * low;
        let is_clear = OPEN_SHARE * expected_k >= doubt_k + moves_k;
        is_clear.then_some(excess_k < OPEN_SHARE * expected_k)
    }

    /// Keeps the offset that has the least doubt.
    fn learn_offset(&mut self, offset_k: f64, doubt_k: f64) {
        if self.offset.is_none_or(|it| doubt_k <= it.doubt_k) {
            self.offset = Some(Offset { offset_k, doubt_k });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::split_range::Command;
    use crate::test_plant::Plant;

    /// A chamber with its check; the surface reads too high by 1.3 K.
    struct Run {
        plant: Plant,
        heater: Heater,
        mains: f64,
    }

    impl Run {
        fn new() -> Self {
            let (plant, heater) = (Plant::at(40.0), Heater::default());
            let mains = 1.0;
            Self {
                plant,
                heater,
                mains,
            }
        }

        /// Runs at these powers, each for some seconds; returns the second in which the check finds an open heater.
        fn go(&mut self, powers: &[(f64, usize)]) -> Option<usize> {
            let each = powers.iter();
            let seconds = each.flat_map(|(heater, seconds)| std::iter::repeat_n(*heater, *seconds));
            let mut found = None;
            for (second, heater) in seconds.enumerate() {
                let vent = 0.0;
                self.plant.mains = self.mains;
                self.plant.step(Command { heater, vent });
                let (air_c, surface_c) = (self.plant.seen().measured_c, self.plant.surface_c());
                let is_open = self.heater.step(air_c, Some(surface_c + 1.3), heater);
                found = found.or(is_open.then_some(second));
            }
            found
        }

        /// Returns a run that has learnt offset and rise.
        fn learnt() -> Self {
            let mut run = Self::new();
            assert_eq!(run.go(&[(0.0, 120), (0.15, 120)]), None);
            run
        }
    }

    #[test]
    fn an_open_heater_is_found_in_half_a_minute() {
        for power in [0.08, 0.15, 0.5] {
            let mut run = Run::learnt();
            assert_eq!(run.go(&[(power, 120)]), None, "{power}");
            run.mains = 0.0;
            let found = run.go(&[(power, 120)]);
            assert!(matches!(found, Some(10..=45)), "{power} {found:?}");
        }
    }

    #[test]
    fn half_a_heater_is_no_open_one() {
        let mut run = Run::learnt();
        run.mains = 0.5;
        let powers = [(0.5, 60), (0.0, 30), (0.05, 60), (1.0, 20), (0.02, 60)];
        assert_eq!(run.go(&powers), None);
    }

    #[test]
    fn power_that_drowns_in_the_doubt_is_not_judged() {
        let mut run = Run::learnt();
        run.mains = 0.0;
        assert_eq!(run.go(&[(0.0, 60), (0.04, 300)]), None);
        let found = run.go(&[(0.08, 60)]);
        assert!(found.is_some());
    }

    #[test]
    fn a_heater_without_thermometer_is_not_judged() {
        let mut heater = Heater::default();
        assert!((0..300).all(|_| !heater.step(60.0, None, 0.5)));
    }
}
