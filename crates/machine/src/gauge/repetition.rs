//! The mean of several readings of one part, and its uncertainty.
//!
//! Averaging n readings divides the random terms of the budget by the root of n. If the readings scatter more than
//! those terms explain, the excess becomes a term of its own (type A, GUM 4.2); [`MeanOf`] says what the mean
//! estimates, and thereby how large this term is. A standard deviation of few readings is widened to Student's t, so
//! that k = 2 covers as much as with many (GUM G.3).

use super::budget::{Budget, COVERAGE_FACTOR, Reading, Term};

/// What the mean of several readings estimates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeanOf {
    /// A property of the part: a threshold, the coil. Its readings scatter at least by the random terms of the budget.
    Part,
    /// Any single operation, to which the limit applies: times and bounce. One operation deviates from the mean as much
    /// as the readings do, and the random terms of the budget set no bound to this deviation.
    Operation,
    /// Exactly the closures that were measured: contacts.
    Closures,
}

/// Student's t for 95.45 % coverage with 1, 2, ... degrees of freedom (GUM, table G.2).
const STUDENT: [f64; 10] = [13.97, 4.53, 3.31, 2.87, 2.65, 2.52, 2.43, 2.37, 2.32, 2.28];

/// Returns the factor that widens a standard deviation with `freedom` degrees of freedom. Beyond the table t - 2 falls
/// in proportion to 1 / `freedom`, accurate to a hundredth.
pub fn student(freedom: usize) -> f64 {
    let listed = STUDENT.get(freedom.saturating_sub(1)).copied();
    listed.map_or(1.0 + 1.4 / freedom as f64, |t| t / COVERAGE_FACTOR)
}

/// Returns the mean of repetitions, with the budget terms of the first one; `None` for no repetitions.
///
/// # Panics
/// Panics when the readings have different units.
pub fn mean(repetitions: &[Reading], of: MeanOf) -> Option<Reading> {
    let (first, more) = repetitions.split_first()?;
    if more.is_empty() {
        return Some(first.clone());
    }
    let alike = more.iter().all(|it| it.unit == first.unit);
    assert!(alike, "repetitions in different units");
    let n = repetitions.len() as f64;
    let value = repetitions.iter().map(|it| it.value).sum::<f64>() / n;
    let squares: f64 = repetitions
        .iter()
        .map(|it| (it.value - value).powi(2))
        .sum();
    let (promised, open) = match of {
        MeanOf::Part => (first.budget.random(), 1.0 / n),
        MeanOf::Operation => (0.0, 1.0 + 1.0 / n),
        MeanOf::Closures => (0.0, 0.0),
    };
    let own_2 = (squares / (n - 1.0) - promised.powi(2)).max(0.0);
    let shrink = |term: &Term| Term {
        u: if term.random {
            term.u / n.sqrt()
        } else {
            term.u
        },
        ..term.clone()
    };
    let budget = Budget(first.budget.0.iter().map(shrink).collect());
    let scatter = student(more.len()) * (own_2 * open).sqrt();
    Some(Reading {
        value,
        unit: first.unit,
        budget: budget.with("scatter of the part", scatter),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use units::Unit;

    fn readings(values: &[f64]) -> Vec<Reading> {
        let budget = Budget::default()
            .with("gain", 3.0)
            .with_random("noise", 8.0);
        let of = |value: &f64| Reading {
            value: *value,
            unit: Unit::Volt,
            budget: budget.clone(),
        };
        values.iter().map(of).collect()
    }

    fn combined(values: &[f64], of: MeanOf) -> f64 {
        mean(&readings(values), of)
            .expect("readings")
            .budget
            .combined()
    }

    const ALL: [MeanOf; 3] = [MeanOf::Part, MeanOf::Operation, MeanOf::Closures];

    #[test]
    fn repetition_reduces_only_random_terms() {
        for of in ALL {
            assert_eq!(combined(&[1.0; 4], of), 5.0);
            assert_eq!(combined(&[1.0], of), 73f64.sqrt());
            assert!(mean(&[], of).is_none());
        }
    }

    #[test]
    fn expected_scatter_adds_no_uncertainty() {
        // The readings have a standard deviation of 6.9; the random term of their budget is 8.
        let apart = [1.0, 13.0, 1.0, 13.0];
        assert_eq!(combined(&apart, MeanOf::Part), 5.0);
        assert_eq!(combined(&apart, MeanOf::Closures), 5.0);
        assert!(combined(&apart, MeanOf::Operation) > 6.9);
    }

    #[test]
    fn excess_scatter_adds_to_the_uncertainty_of_the_mean() {
        // Standard deviation 100; Student's t of two degrees of freedom is 4.53.
        let apart = [900.0, 1000.0, 1100.0];
        let promised_2 = 9.0 + 64.0 / 3.0;
        let with = |own_2: f64| (promised_2 + 2.265f64.powi(2) * own_2).sqrt();
        let near = |of, wanted: f64| assert!((combined(&apart, of) - wanted).abs() < 1e-9);
        near(MeanOf::Part, with((1e4 - 64.0) / 3.0));
        near(MeanOf::Operation, with(1e4 * 4.0 / 3.0));
        near(MeanOf::Closures, with(0.0));
    }

    #[test]
    fn the_uncertainty_of_a_mean_bounce_covers_every_operation() {
        let apart = [1680.0, 1750.0, 1790.0, 1960.0];
        let mean = mean(&readings(&apart), MeanOf::Operation).expect("readings");
        let furthest = apart.map(|it| (it - mean.value).abs());
        assert!(furthest.iter().all(|it| *it < mean.expanded()));
    }

    #[test]
    fn few_readings_are_widened_by_students_t() {
        assert_eq!(student(1), 6.985);
        assert_eq!(student(10), 1.14);
        // GUM, table G.2: 2.13 with 20, 2.05 with 50 degrees of freedom.
        assert!((student(20) - 2.13 / 2.0).abs() < 0.01);
        assert!((student(50) - 2.05 / 2.0).abs() < 0.01);
    }
}
