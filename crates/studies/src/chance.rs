//! The chance that a measured part is judged wrongly (JCGM 106:2012, 9.5).
//!
//! The process is normal, the measurement too. With a guard band `w = U` a value is accepted inside the limit by w,
//! rejected outside by w; in between the part is measured again, and accepted only if the mean of all its readings
//! lies inside by the U of that mean. What systematic errors there are, both readings share: the first is the mean
//! plus what averaging has taken away.

use statrs::distribution::{ContinuousCDF, Normal};
use std::ops::RangeInclusive;

/// Steps of the integral over +-8 standard deviations of the process.
const STEPS: u32 = 40_000;
/// Steps of the integral over +-6 standard deviations of the second reading.
const AGAIN_STEPS: u32 = 240;

/// A process and a measurement, in the unit of the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chance {
    /// Mean of the true values.
    pub mean: f64,
    /// Their standard deviation.
    pub sd: f64,
    /// Standard uncertainty of one measurement.
    pub u: f64,
    /// That of the mean once a part near a limit was measured again; none where no part was.
    pub again: Option<f64>,
}

impl Chance {
    /// Chances of a false accept and of a false reject, with the limits moved inwards by `guard` times the expanded
    /// uncertainty (k = 2).
    ///
    /// `None` where a spread is not positive.
    pub fn of(&self, limits: &RangeInclusive<f64>, guard: f64) -> Option<(f64, f64)> {
        let process = Normal::new(self.mean, self.sd).ok()?;
        let noise = Normal::new(0.0, self.u).ok()?;
        let band = guard * 2.0 * self.u;
        let width = 16.0 * self.sd / f64::from(STEPS);
        let (mut accept, mut reject) = (0.0, 0.0);
        for step in 0..STEPS {
            let from = self.mean - 8.0 * self.sd + width * f64::from(step);
            let (truth, share) = (
                from + width / 2.0,
                process.cdf(from + width) - process.cdf(from),
            );
            let first = within(&noise, limits.start() + band, limits.end() - band, truth);
            let taken = first + self.second(limits, guard, truth);
            if limits.contains(&truth) {
                reject += share * (1.0 - taken);
            } else {
                accept += share * taken;
            }
        }
        Some((accept, reject))
    }

    /// Chance of a part that its first reading left open and its repetition accepts.
    fn second(&self, limits: &RangeInclusive<f64>, guard: f64, truth: f64) -> f64 {
        let (near, band) = (8.0 * self.u, guard * 2.0 * self.u);
        let far = |limit: &f64| (limit - truth).abs() > near;
        let Some(again) = self.again.filter(|again| *again < self.u && guard > 0.0) else {
            return 0.0;
        };
        let lost = (self.u * self.u - again * again).sqrt();
        let (Ok(kept), Ok(lost)) = (Normal::new(0.0, again), Normal::new(0.0, lost)) else {
            return 0.0;
        };
        if far(limits.start()) && far(limits.end()) {
            return 0.0;
        }
        let (low, high) = (
            limits.start() + guard * 2.0 * again,
            limits.end() - guard * 2.0 * again,
        );
        let width = 12.0 * again / f64::from(AGAIN_STEPS);
        let share = |step: u32| {
            let from = -6.0 * again + width * f64::from(step);
            let mean = truth + from + width / 2.0;
            if !(low..=high).contains(&mean) {
                return 0.0;
            }
            let open = [limits.start(), limits.end()]
                .map(|limit| within(&lost, limit - band, limit + band, mean));
            (kept.cdf(from + width) - kept.cdf(from)) * (open[0] + open[1])
        };
        (0..AGAIN_STEPS).map(share).sum()
    }
}

/// Chance that `about` plus noise lies between two ends.
fn within(noise: &Normal, low: f64, high: f64, about: f64) -> f64 {
    (noise.cdf(high - about) - noise.cdf(low - about)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parts per million.
    const PPM: f64 = 1e6;

    fn ppm(chance: Chance, limit: f64, guard: f64) -> (f64, f64) {
        let (accept, reject) = chance
            .of(&(f64::NEG_INFINITY..=limit), guard)
            .expect("a process with a spread");
        (accept * PPM, reject * PPM)
    }

    #[test]
    fn a_pickup_process_of_7_88_v_has_the_risks_of_the_tables() {
        let of = |u| Chance {
            mean: 7.88,
            sd: 0.30,
            u,
            again: None,
        };
        let (accept, reject) = ppm(of(0.020), 9.0, 0.0);
        assert!(
            (accept - 8.60).abs() < 0.1 && (reject - 11.8).abs() < 0.1,
            "{accept} {reject}"
        );
        let (accept, reject) = ppm(of(0.050), 9.0, 1.0);
        assert!(
            (accept - 0.44).abs() < 0.02 && (reject - 305.0).abs() < 3.0,
            "{accept} {reject}"
        );
    }

    #[test]
    fn without_a_spread_there_is_no_chance() {
        let none = Chance {
            mean: 1.0,
            sd: 0.0,
            u: 0.1,
            again: None,
        };
        assert_eq!(none.of(&(0.0..=2.0), 0.0), None);
    }

    #[test]
    fn a_second_look_takes_back_rejects_and_lets_few_accepts_in() {
        let once = Chance {
            mean: 8.74,
            sd: 0.26,
            u: 0.008,
            again: None,
        };
        let of = |again: Option<f64>| ppm(Chance { again, ..once }, 9.0, 1.0);
        let (accept, reject) = of(None);
        let (accept_again, reject_again) = of(Some(0.006));
        assert!(reject_again < 0.85 * reject, "{reject_again} {reject}");
        assert!(
            accept < accept_again && accept_again < 200.0,
            "{accept} {accept_again}"
        );
        let (_, next_to_once) = of(Some(0.007_999_9));
        assert!(
            (next_to_once / reject - 1.0).abs() < 0.02,
            "{next_to_once} {reject}"
        );
    }
}
