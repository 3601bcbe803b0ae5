//! Model of the overshoot of a coarse ramp, from earlier results of the same part.
//!
//! The overshoot of a ramp is its rate times a delay, and the causes of the delay affect other results too: an
//! armature that is late on a step is late on a ramp, eddy currents that hold the flux after switch-off also delay its
//! rise, a winding of more ohms has another time constant, and the ramp reaches a higher threshold later. The release
//! overshoot also depends on springs and travel, which the operate ramp shows. The model is therefore linear in the
//! logarithms of five results ([`CoarseResults`]), each relative to that of the first part.
//!
//! Reference parts and the first parts of a lot have both ramps and teach the model. It is a regression with a
//! conjugate prior (normal with inverse gamma), so it states an uncertainty from the first part on. A result that has
//! varied little among the parts widens that uncertainty. The weight of the prior falls with every part.
//!
//! The model is valid only for parts like those that taught it. For a part far outside, it may still place the ramp but
//! gives no result ([`Predicted::alike`]); the uncertainty grows with the square of the distance.

use serde::{Deserialize, Serialize};
use units::Volt;

/// Prior scatter about the line, volts of a 12 V coil (1 sd): two operations, and the residual of reference parts that
/// lie far apart.
const SCATTER_V: f64 = 0.004;
/// Weight of the prior, as a number of parts.
const PRIOR_WEIGHT: f64 = 4.0;
/// Standard uncertainty of the assumed overshoot of the first part, volts of a 12 V coil.
const GUESS_SD_V: f64 = 0.05;
/// Prior elasticities of the overshoot, percent per percent of a result (mean and 1 sd), in the order of
/// [`CoarseResults`]. A late armature is heavy: its flight is most of the delay of a rising ramp and half of an operate
/// time. A high threshold delays an operation independently of mass, hence the negative terms. A falling ramp waits for
/// the flux, which depends a little on each result.
const RISING: [f64; RESULTS] = [-0.8, -0.8, 1.3, 0.0, 0.3];
const FALLING: [f64; RESULTS] = [0.0; RESULTS];
const ELASTICITY_SD: f64 = 0.25;
/// Greatest residual, in standard uncertainties; the model clips a larger one to this. One outlier thus does not bend
/// the line, whereas residuals that persist widen the uncertainty until the line bends.
const OUTLIER: f64 = 3.0;
/// Greatest squared distance of a similar part from the parts learned, in squared standard deviations: one in two
/// thousand lies further away. `WIDER` raises it after few parts (Hotelling's T2 of five variates, accurate to a tenth
/// from ten parts on).
const MAX_DISTANCE2: f64 = 20.0;
const WIDER: f64 = 20.0;
const RESULTS: usize = 5;
/// Number of coefficients of the line: a constant, and a slope for each result.
const TERMS: usize = RESULTS + 1;

/// Results of a part that are known at the contact event of its coarse ramp; NaN for a missing result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoarseResults {
    /// Indication of the coarse ramp.
    pub indicated: Volt,
    /// Indication of the coarse operate ramp: of this ramp, or of the one before a release.
    pub operate: Volt,
    /// Operate time at nominal voltage, ms.
    pub operate_ms: f64,
    /// Release time with the coil suppression of the recipe, ms.
    pub release_ms: f64,
    /// Coil resistance at the reference temperature, ohm.
    pub coil_ohm: f64,
}

impl CoarseResults {
    /// Results of a part before any measurement.
    pub const NONE: Self = Self {
        indicated: Volt(f64::NAN),
        operate: Volt(f64::NAN),
        operate_ms: f64::NAN,
        release_ms: f64::NAN,
        coil_ohm: f64::NAN,
    };

    /// Returns the logarithms of the results; `None` unless all are above zero.
    fn logarithms(&self) -> Option<[f64; RESULTS]> {
        let results = [
            self.indicated.0,
            self.operate.0,
            self.operate_ms,
            self.release_ms,
            self.coil_ohm,
        ];
        let known = results.iter().all(|it| it.is_finite() && *it > 0.0);
        known.then(|| results.map(f64::ln))
    }
}

/// Expected overshoot of a part, from the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Coarse minus fine indication, volts.
    pub volts: f64,
    /// Standard uncertainty, volts.
    pub u_v: f64,
    /// Variance of the line at this part, as a multiple of the residual variance about the line.
    pub spread: f64,
    /// True when the part lies among those that taught the model.
    pub alike: bool,
}

/// Regression of the overshoot on the results of the parts learned so far.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OvershootModel {
    guess_v: f64,
    /// Nominal coil voltage as a multiple of 12 V, for which the prior is stated.
    #[serde(default = "of_12_v")]
    coil: f64,
    parts: u32,
    first: [f64; RESULTS],
    /// Sums over prior and parts: products of the terms with each other.
    products: [[f64; TERMS]; TERMS],
    /// Sums over prior and parts: products of the terms with the overshoot minus the guess.
    #[serde(rename = "with_lag")]
    with_overshoot: [f64; TERMS],
    squares: f64,
}

impl OvershootModel {
    /// Returns the model before the first part, from a guess of the overshoot in volts; `coil`: nominal coil voltage
    /// relative to 12 V.
    pub fn guess(guess_v: f64, coil: f64) -> Self {
        let mut law = Self {
            guess_v,
            coil,
            parts: 0,
            first: [0.0; RESULTS],
            products: [[0.0; TERMS]; TERMS],
            with_overshoot: [0.0; TERMS],
            squares: PRIOR_WEIGHT * (SCATTER_V * coil).powi(2),
        };
        for term in 0..TERMS {
            let (mean_v, weight) = law.prior(term);
            law.products[term][term] = weight;
            law.with_overshoot[term] = weight * mean_v;
            law.squares += weight * mean_v.powi(2);
        }
        law
    }

    /// Returns the number of parts learned.
    pub fn parts(&self) -> u32 {
        self.parts
    }

    /// Learns from a part that has both indications; ignores a part with a missing result.
    pub fn learn(&mut self, shown: &CoarseResults, fine: Volt) {
        let overshoot_v = (shown.indicated - fine).0;
        let Some(logarithms) = shown.logarithms().filter(|_| overshoot_v.is_finite()) else {
            return;
        };
        if self.parts == 0 {
            self.first = logarithms;
        }
        let expected = self.of(shown);
        let off_v =
            (overshoot_v - expected.volts).clamp(-OUTLIER * expected.u_v, OUTLIER * expected.u_v);
        let overshoot_v = expected.volts + off_v - self.guess_v;
        let terms = self.terms(logarithms);
        for (row, one) in terms.iter().enumerate() {
            for (column, other) in terms.iter().enumerate() {
                self.products[row][column] += one * other;
            }
            self.with_overshoot[row] += one * overshoot_v;
        }
        self.squares += overshoot_v * overshoot_v;
        self.parts += 1;
    }

    /// Returns the expected overshoot of a part. For a part with a missing result, returns the overshoot expected of
    /// the first part, with `alike` false.
    pub fn of(&self, shown: &CoarseResults) -> Predicted {
        let logarithms = shown.logarithms().filter(|_| self.parts > 0);
        let terms = self.terms(logarithms.unwrap_or(self.first));
        let line = solved(self.products, self.with_overshoot);
        let spread = dot(terms, solved(self.products, terms));
        let left = (self.squares - dot(line, self.with_overshoot)).max(0.0);
        let freedom = PRIOR_WEIGHT + f64::from(self.parts) - self.determined();
        // Variance of Student's t relative to a normal distribution.
        let student = freedom / (freedom - 2.0);
        let beyond = self.beyond(spread);
        Predicted {
            volts: self.guess_v + dot(line, terms),
            u_v: (left / freedom * (1.0 + spread) * student).sqrt()
                * beyond.unwrap_or(1.0).max(1.0),
            spread,
            alike: logarithms.is_some() && beyond.is_some_and(|it| it < 1.0),
        }
    }

    /// Returns the number of terms that the parts determine rather than the prior: the degrees of freedom of the line.
    fn determined(&self) -> f64 {
        let of_term = |term: usize| {
            let mut alone = [0.0; TERMS];
            alone[term] = 1.0;
            1.0 - self.prior(term).1 * solved(self.products, alone)[term]
        };
        (0..TERMS).map(of_term).sum()
    }

    /// Returns the squared distance of a part from the parts learned, as a multiple of the limit for similar parts;
    /// `None` after too few parts.
    fn beyond(&self, spread: f64) -> Option<f64> {
        let parts = f64::from(self.parts);
        let more = parts - RESULTS as f64;
        (more > 0.0).then(|| (parts * spread - 1.0) / (MAX_DISTANCE2 * (1.0 + WIDER / more)))
    }

    /// Returns the prior mean of a term, volts, and its weight. The overshoot of a rising ramp is positive, that of a
    /// falling one negative.
    fn prior(&self, term: usize) -> (f64, f64) {
        let (guess_v, guess_sd_v) = (self.guess_v, GUESS_SD_V * self.coil);
        let elasticities = if guess_v > 0.0 { RISING } else { FALLING };
        let (mean_v, sd_v) = match term.checked_sub(1) {
            None => (0.0, guess_sd_v),
            Some(result) => (
                elasticities[result] * guess_v,
                ELASTICITY_SD * guess_v.abs().max(guess_sd_v),
            ),
        };
        (mean_v, (SCATTER_V * self.coil / sd_v).powi(2))
    }

    fn terms(&self, logarithms: [f64; RESULTS]) -> [f64; TERMS] {
        let mut terms = [1.0; TERMS];
        for (term, (now, first)) in terms[1..]
            .iter_mut()
            .zip(logarithms.iter().zip(&self.first))
        {
            *term = now - first;
        }
        terms
    }
}

/// Returns the coil factor of a model that was stored without one.
fn of_12_v() -> f64 {
    1.0
}

fn dot(a: [f64; TERMS], b: [f64; TERMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves `products x = right` by elimination; the prior of every term keeps the pivots above zero.
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
mod tests;
