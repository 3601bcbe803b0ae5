//! The lag of a coarse ramp as a law of what the same part has shown before.
//!
//! A ramp overshoots by its rate times a delay, and the delay is made of what makes other results: an armature that
//! is late on a step is late on a ramp, eddy currents that hold the flux after switch-off hold it back while it rises,
//! a winding of more ohms has another time constant, and a higher threshold is crossed later. Beside its own indication a
//! release follows that of the operate ramp: springs and travel carry both. So the lag is a line in
//! the logarithms of five results ([`Shown`]), each against that of the first part seen.
//!
//! Golden parts and the first parts of a lot teach the line: they have both ramps. It is a regression with a conjugate
//! prior (normal with inverse gamma), so it says from the first part on how sure it is: what has hardly varied yet
//! widens the answer. The prior is forgotten with the parts.
//!
//! A line holds where it was learnt. A part that lies far outside ([`Predicted::alike`]) may be placed by it, not judged:
//! what bends the line grows with the square of the distance, and so does the doubt.

use serde::{Deserialize, Serialize};
use units::Volt;

/// Scatter about the line that is believed before any part was seen, volts (1 sd): that of two operations, and what a
/// line leaves of golden parts that lie far apart.
const SCATTER_V: f64 = 0.004;
/// How many parts that belief is worth.
const WORTH: f64 = 4.0;
/// How far the guess of the lag may be off for the first part, volts (1 sd).
const GUESS_SD_V: f64 = 0.05;
/// By how many hundredths of itself the lag changes when a result is greater by a hundredth (mean and 1 sd), in the order of
/// [`Shown`]. An armature that operates late is a heavy one: its flight is most of what a rising ramp waits for and half of
/// an operation. A high threshold makes an operation late without any mass, and so is taken off again; of a rising ramp
/// both indications are the same. A falling ramp waits for the flux, which follows each result a little.
const RISING: [f64; RESULTS] = [-0.8, -0.8, 1.3, 0.0, 0.3];
const FALLING: [f64; RESULTS] = [0.0; RESULTS];
const ELASTICITY_SD: f64 = 0.25;
/// A part that is further from what is expected of it teaches as if it were so far, in standard uncertainties: one odd golden
/// part does not bend the line for a lot, and a line that is wrong still widens until it is not.
const ODD: f64 = 3.0;
/// Greatest squared distance from the parts seen, in standard deviations along every direction in which they vary, and
/// how it widens while few parts tell those: of parts like them one in two thousand is further away (Hotelling's T2 of
/// five variates, to a tenth from ten parts on).
const FURTHEST2: f64 = 20.0;
const WIDER: f64 = 20.0;
/// Results that the line follows.
const RESULTS: usize = 5;
/// A constant, and a slope for each.
const TERMS: usize = RESULTS + 1;

/// What a part has shown when the event of its coarse ramp is read; NaN where it has shown nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shown {
    /// Indication of the coarse ramp.
    pub indicated: Volt,
    /// Indication of the coarse operate ramp: the same, or that of the ramp before a release.
    pub operate: Volt,
    /// Operate time at nominal voltage, ms.
    pub operate_ms: f64,
    /// Release time into the clamp of the recipe, ms.
    pub release_ms: f64,
    /// Coil resistance at the reference temperature, ohm.
    pub coil_ohm: f64,
}

impl Shown {
    /// Of a part that has not shown a ramp.
    pub const NOTHING: Self = Self {
        indicated: Volt(f64::NAN),
        operate: Volt(f64::NAN),
        operate_ms: f64::NAN,
        release_ms: f64::NAN,
        coil_ohm: f64::NAN,
    };

    /// Logarithms of all, none when one is no number above zero.
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

/// The lag to expect of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Coarse minus fine indication, volts.
    pub volts: f64,
    /// Standard uncertainty, volts.
    pub u_v: f64,
    /// The part lies among those that taught the law.
    pub alike: bool,
}

/// The law as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OvershootModel {
    guess_v: f64,
    parts: u32,
    /// Logarithms of the first part.
    first: [f64; RESULTS],
    /// Prior and parts: sums of products of the terms, and of terms and lag less guess.
    products: [[f64; TERMS]; TERMS],
    #[serde(rename = "with_lag")]
    with_overshoot: [f64; TERMS],
    squares: f64,
}

impl OvershootModel {
    /// Before any part was seen: a guess of the lag in volts.
    pub fn guess(guess_v: f64) -> Self {
        let mut law = Self {
            guess_v,
            parts: 0,
            first: [0.0; RESULTS],
            products: [[0.0; TERMS]; TERMS],
            with_overshoot: [0.0; TERMS],
            squares: WORTH * SCATTER_V.powi(2),
        };
        for term in 0..TERMS {
            let (mean_v, weight) = believed(guess_v, term);
            law.products[term][term] = weight;
            law.with_overshoot[term] = weight * mean_v;
            law.squares += weight * mean_v.powi(2);
        }
        law
    }

    /// Parts that have taught it.
    pub fn parts(&self) -> u32 {
        self.parts
    }

    /// Takes in a part with both indications; one that is not a number is passed over.
    pub fn learn(&mut self, shown: &Shown, fine: Volt) {
        let overshoot_v = (shown.indicated - fine).0;
        let Some(logarithms) = shown.logarithms().filter(|_| overshoot_v.is_finite()) else {
            return;
        };
        if self.parts == 0 {
            self.first = logarithms;
        }
        let expected = self.of(shown);
        let off_v = (overshoot_v - expected.volts).clamp(-ODD * expected.u_v, ODD * expected.u_v);
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

    /// The lag to expect of a part. One that has not shown everything is taken for the first, and for unlike.
    pub fn of(&self, shown: &Shown) -> Predicted {
        let logarithms = shown.logarithms().filter(|_| self.parts > 0);
        let terms = self.terms(logarithms.unwrap_or(self.first));
        let line = solved(self.products, self.with_overshoot);
        let spread = dot(terms, solved(self.products, terms));
        let left = (self.squares - dot(line, self.with_overshoot)).max(0.0);
        let freedom = WORTH + f64::from(self.parts) - self.told();
        // Student's t of so many degrees of freedom is wider than a normal distribution by this.
        let student = freedom / (freedom - 2.0);
        let beyond = self.beyond(spread);
        Predicted {
            volts: self.guess_v + dot(line, terms),
            u_v: (left / freedom * (1.0 + spread) * student).sqrt()
                * beyond.unwrap_or(1.0).max(1.0),
            alike: logarithms.is_some() && beyond.is_some_and(|it| it < 1.0),
        }
    }

    /// How many terms the parts have told, and not the prior: so many of them are gone into the line and leave no scatter.
    fn told(&self) -> f64 {
        let of_term = |term: usize| {
            let mut alone = [0.0; TERMS];
            alone[term] = 1.0;
            1.0 - believed(self.guess_v, term).1 * solved(self.products, alone)[term]
        };
        (0..TERMS).map(of_term).sum()
    }

    /// Squared distance from the parts seen against that of the furthest that are like them; none while too few were.
    fn beyond(&self, spread: f64) -> Option<f64> {
        let parts = f64::from(self.parts);
        let more = parts - RESULTS as f64;
        (more > 0.0).then(|| (parts * spread - 1.0) / (FURTHEST2 * (1.0 + WIDER / more)))
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

/// What is believed of a term of the line before any part was seen, volts, and what it adds to the product of that term
/// with itself. The lag of a rising ramp lies above zero, that of a falling one below.
fn believed(guess_v: f64, term: usize) -> (f64, f64) {
    let elasticities = if guess_v > 0.0 { RISING } else { FALLING };
    let (mean_v, sd_v) = match term.checked_sub(1) {
        None => (0.0, GUESS_SD_V),
        Some(result) => (
            elasticities[result] * guess_v,
            ELASTICITY_SD * guess_v.abs().max(GUESS_SD_V),
        ),
    };
    (mean_v, (SCATTER_V / sd_v).powi(2))
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
mod tests;
