//! Uncertainty budget of one result (GUM, ISO/IEC Guide 98-3): named standard uncertainties, added in quadrature
//! because each comes from an instrument or effect that is independent of the others.

use super::factor::Deviation;
use super::repetition::student;
use serde::Serialize;
use units::Unit;

/// Coverage factor of every expanded uncertainty in rows, files and pages.
pub const COVERAGE_FACTOR: f64 = 2.0;

/// Returns the standard uncertainty of a rectangular distribution with this half width (GUM 4.3.7).
pub fn rectangular(half_width: f64) -> f64 {
    half_width / 3f64.sqrt()
}

/// Returns the standard uncertainty of a quantity read in steps of `step` (GUM F.2.2.1).
pub fn resolution(step: f64) -> f64 {
    step / 12f64.sqrt()
}

/// Coefficient and exponent of the coverage factor of 95.45 % as a function of the excess kurtosis: 2 - A |kurtosis|^B.
/// Exact for one, two and three equal rectangular distributions (1.653, 1.927, 1.970), at most 2 % too large where
/// normal ones join them.
const NARROWER: (f64, f64) = (0.2303, 2.249);
/// Excess kurtosis of a rectangular distribution.
const RECTANGULAR_KURTOSIS: f64 = -1.2;

/// One source of uncertainty.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Term {
    /// Name of the source, for example `coil temperature` or `slope`.
    pub source: &'static str,
    /// Standard uncertainty in the unit of the result.
    pub u: f64,
    /// True when the error varies between repetitions, so that averaging reduces it.
    pub random: bool,
    /// True for an error between two bounds, within which every value is as likely.
    #[serde(skip)]
    pub bounded: bool,
}

impl Term {
    fn new(source: &'static str, u: f64) -> Self {
        Self {
            source,
            u: u.abs(),
            random: false,
            bounded: false,
        }
    }
}

/// The terms of one result.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[serde(transparent)]
pub struct Budget(pub Vec<Term>);

impl Budget {
    /// Adds a term that repetition does not reduce; ignores the sign of `u`.
    pub fn with(self, source: &'static str, u: f64) -> Self {
        self.and(Term::new(source, u))
    }

    /// Adds a term that varies between repetitions; ignores the sign of `u`.
    pub fn with_random(self, source: &'static str, u: f64) -> Self {
        let random = true;
        self.and(Term {
            random,
            ..Term::new(source, u)
        })
    }

    /// Adds an error of at most `half_width` that repetition does not reduce; ignores the sign.
    pub fn with_bounds(self, source: &'static str, half_width: f64) -> Self {
        let bounded = true;
        self.and(Term {
            bounded,
            ..Term::new(source, rectangular(half_width))
        })
    }

    /// Adds an error of at most `half_width` that varies between repetitions; ignores the sign.
    pub fn with_random_bounds(self, source: &'static str, half_width: f64) -> Self {
        let (random, bounded) = (true, true);
        self.and(Term {
            random,
            bounded,
            ..Term::new(source, rectangular(half_width))
        })
    }

    fn and(mut self, term: Term) -> Self {
        self.0.push(term);
        self
    }

    /// Narrows all terms by one factor, so that k = 2 covers 95.45 % where a few bounded terms make most of the sum: k
    /// = 2 of a single rectangular distribution would cover more than all of it (EA-4/02, S9.14). Call this after all
    /// terms are added.
    pub fn covering(mut self) -> Self {
        let variance = self.combined().powi(2);
        let fourth: f64 = self
            .0
            .iter()
            .filter(|it| it.bounded)
            .map(|it| it.u.powi(4))
            .sum();
        if variance > 0.0 && variance.is_finite() {
            let kurtosis = RECTANGULAR_KURTOSIS * fourth / variance.powi(2);
            let narrower = NARROWER.0 * kurtosis.abs().powf(NARROWER.1) / COVERAGE_FACTOR;
            assert!((0.0..0.5).contains(&narrower), "kurtosis {kurtosis}");
            for term in &mut self.0 {
                term.u *= 1.0 - narrower;
            }
        }
        self
    }

    /// Adds a term that repetition does not reduce and that is itself an estimate. Call this after all other terms are
    /// added: the term is widened to Student's t of the effective degrees of freedom of the whole budget (Welch and
    /// Satterthwaite, GUM G.4), so that k = 2 covers as much as with many degrees of freedom.
    pub fn with_estimated(self, source: &'static str, of: Deviation) -> Self {
        let own = of.value.powi(2);
        let others = self.combined().powi(2);
        let combined = own + others;
        if own == 0.0 || !combined.is_finite() {
            return self.with(source, of.value);
        }
        let effective = of.freedom * (combined / own).powi(2);
        let widened = student(effective as usize).powi(2) * combined;
        self.with(source, (widened - others).sqrt())
    }

    /// Returns the combined standard uncertainty of all terms.
    pub fn combined(&self) -> f64 {
        root_sum(self.0.iter())
    }

    /// Returns the combined standard uncertainty of the terms that vary between repetitions.
    pub fn random(&self) -> f64 {
        root_sum(self.0.iter().filter(|term| term.random))
    }

    /// Returns the expanded uncertainty, k = 2.
    pub fn expanded(&self) -> f64 {
        COVERAGE_FACTOR * self.combined()
    }
}

fn root_sum<'a>(terms: impl Iterator<Item = &'a Term>) -> f64 {
    terms.map(|term| term.u * term.u).sum::<f64>().sqrt()
}

/// A result with its budget.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Corrected value.
    pub value: f64,
    /// Unit of the value and of every term of the budget.
    pub unit: Unit,
    /// Sources of the value's uncertainty.
    pub budget: Budget,
}

impl Reading {
    /// Returns the expanded uncertainty, k = 2.
    pub fn expanded(&self) -> f64 {
        self.budget.expanded()
    }

    /// Returns false when value or uncertainty is not a finite number; such a reading is void.
    pub fn is_usable(&self) -> bool {
        self.value.is_finite() && self.expanded().is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn independent_terms_add_in_quadrature() {
        let budget = Budget::default().with("a", 3.0).with("b", -4.0);
        assert_eq!(budget.combined(), 5.0);
        assert_eq!(budget.expanded(), 10.0);
    }

    #[test]
    fn an_estimated_term_gets_students_t() {
        let budget = |others: f64, freedom: f64| {
            let value = 1.0;
            let of = Deviation { value, freedom };
            let budget = Budget::default().with("others", others);
            budget.with_estimated("estimated", of).combined()
        };
        // GUM, table G.2: t of 5 degrees of freedom is 2.65, of 10, 2.28.
        assert!((budget(0.0, 5.0) - 2.65 / 2.0).abs() < 1e-12);
        // Both variances are equal: four times as many effective degrees of freedom.
        assert!((budget(1.0, 2.5) - 2.28 / 2.0 * 2f64.sqrt()).abs() < 1e-12);
        assert!((budget(1.0, f64::INFINITY) - 2f64.sqrt()).abs() < 1e-12);
        assert_eq!(budget(f64::INFINITY, 5.0), f64::INFINITY);
        let none = Budget::default().with_estimated("none", Deviation::known(0.0));
        assert_eq!(none.combined(), 0.0);
    }

    #[test]
    fn bounded_terms_keep_k_at_two() {
        let expanded = |budget: Budget| budget.covering().expanded();
        let near = |found: f64, exact: f64| {
            assert!((found / exact - 1.0).abs() < 0.021, "{found}, {exact}")
        };
        // One rectangle of half width 1: 95.45 % lie within 0.9545.
        near(expanded(Budget::default().with_bounds("a", -1.0)), 0.9545);
        // Two make a triangle: half width 2, 95.45 % within 2 (1 - 0.0455^0.5).
        let two = Budget::default()
            .with_bounds("a", 1.0)
            .with_random_bounds("b", 1.0);
        near(expanded(two), 1.5734);
        // A rectangle with twice the standard deviation of a normal distribution, by simulation.
        let mixed = Budget::default()
            .with_bounds("a", 2.0 * 3f64.sqrt())
            .with("b", 1.0);
        near(expanded(mixed), 1.837 * 5f64.sqrt());
        let normal = Budget::default().with("a", 3.0).with_random("b", 4.0);
        assert_eq!(expanded(normal), 10.0);
        assert_eq!(expanded(Budget::default()), 0.0);
    }

    #[test]
    fn a_reading_without_a_number_is_not_usable() {
        let reading = Reading {
            value: f64::NAN,
            unit: Unit::Volt,
            budget: Budget::default(),
        };
        assert!(!reading.is_usable());
        let endless = Reading {
            value: 1.0,
            unit: Unit::Volt,
            budget: Budget::default().with("x", f64::INFINITY),
        };
        assert!(!endless.is_usable());
    }
}
