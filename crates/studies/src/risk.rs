//! Global risks of a wrong decision about a part (JCGM 106:2012, 9.5).
//!
//! Values of the process and errors of the measurement are normally distributed. The guard band w is `guard` times the
//! expanded uncertainty U (k = 2). The decision rule accepts a first reading that lies inside the limits by at least w,
//! and rejects one that lies outside by at least w. In between, the rig measures the part again, and the rule accepts
//! it only if the mean of all readings lies inside the limits by at least the guard band of that mean. The first
//! reading and the mean share the systematic error; the first reading has more noise, which averaging reduces.

use statrs::distribution::{ContinuousCDF, Normal};
use std::ops::RangeInclusive;

/// Number of steps of the integral over +-8 standard deviations of the process.
const STEPS: u32 = 40_000;
/// Number of steps of the integral over +-6 standard deviations of the mean of all readings after a confirmation
/// measurement.
const AGAIN_STEPS: u32 = 240;

/// Distributions of a process and of its measurement, in the unit of the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DecisionRisk {
    /// Mean of the true values.
    pub mean: f64,
    /// Standard deviation of the true values.
    pub sd: f64,
    /// Standard uncertainty of one measurement.
    pub u: f64,
    /// Standard uncertainty of the mean of all readings after a confirmation measurement; `None` when no part had one.
    pub again: Option<f64>,
}

impl DecisionRisk {
    /// Returns the probabilities of a false accept and of a false reject, with the limits moved inwards by `guard`
    /// times the expanded uncertainty (k = 2); `None` unless both standard deviations are positive.
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

    /// Returns the probability that the first reading of a part is inconclusive and the confirmation measurement
    /// accepts it.
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

/// Returns the probability that `about` plus `noise` lies between `low` and `high`.
fn within(noise: &Normal, low: f64, high: f64, about: f64) -> f64 {
    (noise.cdf(high - about) - noise.cdf(low - about)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parts per million.
    const PPM: f64 = 1e6;

    fn ppm(chance: DecisionRisk, limit: f64, guard: f64) -> (f64, f64) {
        let (accept, reject) = chance
            .of(&(f64::NEG_INFINITY..=limit), guard)
            .expect("a process with a spread");
        (accept * PPM, reject * PPM)
    }

    #[test]
    fn a_pickup_process_has_the_risks_of_the_tables() {
        let of = |u| DecisionRisk {
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
    fn a_process_without_a_spread_has_no_risk() {
        let none = DecisionRisk {
            mean: 1.0,
            sd: 0.0,
            u: 0.1,
            again: None,
        };
        assert_eq!(none.of(&(0.0..=2.0), 0.0), None);
    }

    #[test]
    fn a_confirmation_measurement_lowers_false_rejects() {
        let once = DecisionRisk {
            mean: 8.74,
            sd: 0.26,
            u: 0.008,
            again: None,
        };
        let of = |again: Option<f64>| ppm(DecisionRisk { again, ..once }, 9.0, 1.0);
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
