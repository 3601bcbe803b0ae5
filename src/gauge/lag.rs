//! The lag of a coarse ramp as a line of what the same part shows elsewhere: its operate time and its indication.
//!
//! A ramp overshoots by `rate x (delay of the mode + flight of the armature)`, and the flight is in the operate time
//! at nominal voltage as well: of two parts with one threshold the one that is a millisecond slower shows up to
//! `rate x 1 ms` more. How much of the operate time is flight, and how the mode's delay follows the threshold,
//! golden parts and the first parts of a lot tell, which have both ramps.
//!
//! `lag = a + b time + c indication` by Bayesian regression with a conjugate prior: with few parts the prior keeps
//! the slopes from following the noise, with many it is forgotten. The prediction is Student's; its standard
//! uncertainty is widened so that k = 2 covers as usual.

use serde::{Deserialize, Serialize};

/// Coefficients of the line: constant, operate time, indication.
const TERMS: usize = 3;
/// Scatter about the line that is believed before any part was seen, volts (1 sd): that of one operation. The prior
/// is worth the more the less parts scatter; believed too large, it would hold the slopes where they began.
const SCATTER_V: f64 = 0.002;
/// How many parts that belief is worth.
const WORTH: f64 = 1.0;
/// Half of the operate time is flight, give or take the other half.
const FLIGHT_SHARE: f64 = 0.5;
/// The constant may be anything: volts (1 sd).
const CONSTANT_SD_V: f64 = 10.0;
/// The lag follows the threshold by no more than a tenth of it (1 sd).
const FOLLOWS_SD: f64 = 0.1;

/// What a part shows besides its lag.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Operate time at nominal voltage, ms.
    pub operate_ms: f64,
    /// Indication of the coarse ramp, volts.
    pub seen_v: f64,
}

impl Shown {
    fn terms(self) -> [f64; TERMS] {
        [1.0, self.operate_ms, self.seen_v]
    }
}

/// The line as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LagLine {
    /// Prior and seen parts: sums of products of the terms, and of terms and lag, over the variance of the prior.
    products: [[f64; TERMS]; TERMS],
    with_lag: [f64; TERMS],
    squares: f64,
    parts: f64,
}

impl LagLine {
    /// Before any part was seen, for a ramp of so many volts per second.
    pub fn before(rate_v_per_s: f64) -> Self {
        let per_ms = rate_v_per_s * 1e-3 * FLIGHT_SHARE;
        let means = [0.0, per_ms, 0.0];
        let sds = [CONSTANT_SD_V, per_ms, FOLLOWS_SD];
        let mut line = Self {
            products: [[0.0; TERMS]; TERMS],
            with_lag: [0.0; TERMS],
            squares: 0.0,
            parts: 0.0,
        };
        for (term, (mean, sd)) in means.into_iter().zip(sds).enumerate() {
            let weight = (SCATTER_V / sd).powi(2);
            line.products[term][term] = weight;
            line.with_lag[term] = weight * mean;
            line.squares += weight * mean * mean;
        }
        line
    }

    /// Takes in a part with both indications; one that is not a number is passed over.
    pub fn learn(&mut self, shown: Shown, lag_v: f64) {
        let terms = shown.terms();
        if !lag_v.is_finite() || terms.iter().any(|term| !term.is_finite()) {
            return;
        }
        for (row, one) in terms.iter().enumerate() {
            for (column, other) in terms.iter().enumerate() {
                self.products[row][column] += one * other;
            }
            self.with_lag[row] += one * lag_v;
        }
        self.squares += lag_v * lag_v;
        self.parts += 1.0;
    }

    /// The lag to expect of a part, and its standard uncertainty, volts.
    pub fn lag_v(&self, shown: Shown) -> (f64, f64) {
        let terms = shown.terms();
        let line = solved(self.products, self.with_lag);
        let spread = dot(terms, solved(self.products, terms));
        let left = (self.squares - dot(line, self.with_lag)).max(0.0);
        let freedom = (self.parts + WORTH - TERMS as f64).max(WORTH);
        let scatter = (left + WORTH * SCATTER_V.powi(2)) / freedom;
        let student = 1.0 + 1.5 / freedom;
        let u = (scatter * (1.0 + spread)).sqrt() * student;
        (dot(line, terms), u)
    }
}

fn dot(a: [f64; TERMS], b: [f64; TERMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `products x = right` by elimination; a prior on every term keeps the pivots above zero.
fn solved(mut products: [[f64; TERMS]; TERMS], mut right: [f64; TERMS]) -> [f64; TERMS] {
    for pivot in 0..TERMS {
        for row in pivot + 1..TERMS {
            let share = products[row][pivot] / products[pivot][pivot];
            let above = products[pivot];
            for (it, above) in products[row].iter_mut().zip(above).skip(pivot) {
                *it -= share * above;
            }
            right[row] -= share * right[pivot];
        }
    }
    let mut line = [0.0; TERMS];
    for row in (0..TERMS).rev() {
        let known: f64 = (row + 1..TERMS)
            .map(|it| products[row][it] * line[it])
            .sum();
        line[row] = (right[row] - known) / products[row][row];
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(operate_ms: f64, seen_v: f64) -> Shown {
        Shown { operate_ms, seen_v }
    }

    /// A part of a rig whose lag is 0.6 V and 96 mV/ms of time less 50 mV/V of indication.
    fn lag(part: Shown) -> f64 {
        0.6 + 0.096 * part.operate_ms - 0.05 * part.seen_v
    }

    /// Parts over the ranges of a lot; no two with the same ratio of time and volts.
    fn parts(n: u32) -> impl Iterator<Item = Shown> {
        let turn = |at: u32, by: f64| (f64::from(at) * by).fract() - 0.5;
        (1..=n).map(move |at| shown(4.7 + 0.8 * turn(at, 0.618), 8.7 + 0.9 * turn(at, 0.382_7)))
    }

    fn taught(n: u32, noise_v: f64) -> LagLine {
        let mut line = LagLine::before(96.0);
        for (at, part) in parts(n).enumerate() {
            let off = if at % 2 == 0 { noise_v } else { -noise_v };
            line.learn(part, lag(part) + off);
        }
        line
    }

    #[test]
    fn a_rig_that_keeps_to_a_line_is_known_after_a_few_parts() {
        let line = taught(8, 0.0);
        for part in parts(30) {
            let (found, u) = line.lag_v(part);
            assert!((found - lag(part)).abs() < 0.002, "{part:?}: {found}");
            assert!(u < 0.005, "{u}");
        }
    }

    #[test]
    fn scatter_about_the_line_stays_in_the_uncertainty_however_many_parts_teach() {
        let part = shown(4.7, 8.7);
        let (_, few) = taught(5, 0.006).lag_v(part);
        let (_, many) = taught(500, 0.006).lag_v(part);
        assert!(few > many, "{few} {many}");
        assert!((many - 0.006).abs() < 0.0002, "{many}");
    }

    #[test]
    fn far_from_what_was_seen_the_lag_is_in_doubt() {
        let line = taught(10, 0.003);
        let (_, near) = line.lag_v(shown(4.7, 8.7));
        let (_, far) = line.lag_v(shown(12.0, 8.7));
        assert!(far > 3.0 * near, "{near} {far}");
    }

    #[test]
    fn before_any_part_nothing_is_known() {
        let (_, u) = LagLine::before(96.0).lag_v(shown(4.7, 8.7));
        assert!(u > CONSTANT_SD_V, "{u}");
    }

    #[test]
    fn what_is_not_a_number_teaches_nothing() {
        let mut line = taught(5, 0.0);
        let before = line;
        line.learn(shown(f64::NAN, 8.7), 0.8);
        line.learn(shown(4.7, 8.7), f64::INFINITY);
        assert_eq!(line, before);
    }
}
