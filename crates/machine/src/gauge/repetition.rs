//! Several readings of one part, and what their mean does not know.
//!
//! What is promised to be drawn anew at each reading shrinks with the root of their number. How far the readings really lie
//! apart is a term of its own (type A, GUM 4.2), as far as nobody has promised it, and what it leaves open hangs on what
//! the mean is taken for ([`SpokenOf`]). Few readings tell their scatter badly: it is widened to Student's t, so that
//! twice the standard uncertainty covers as much as with many (GUM G.3).

use super::budget::{Budget, COVERAGE_FACTOR, Reading, Term};

/// What a row with a mean of several readings speaks of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpokenOf {
    /// A property of the part, about which its operations scatter as promised, or more: a threshold, the coil.
    Part,
    /// Any one operation, of which a limit speaks too: times and bounce. It lies as far from the mean as those that were
    /// read lie apart, and nobody promises how far.
    Operation,
    /// The closures that were read, and no other: contacts.
    Closures,
}

/// Student's t that covers 95.45 % with 1, 2, ... degrees of freedom (GUM, table G.2).
const STUDENT: [f64; 10] = [13.97, 4.53, 3.31, 2.87, 2.65, 2.52, 2.43, 2.37, 2.32, 2.28];

/// What a standard deviation of so many degrees of freedom is widened by. Beyond the table t falls to 2 as one over
/// their number, within a hundredth.
fn student(freedom: usize) -> f64 {
    let listed = STUDENT.get(freedom.saturating_sub(1)).copied();
    listed.map_or(1.0 + 1.4 / freedom as f64, |t| t / COVERAGE_FACTOR)
}

/// Mean of repetitions; `None` without one. The terms are those of the first.
///
/// # Panics
/// When they are not in the same unit.
pub fn mean(repetitions: &[Reading], of: SpokenOf) -> Option<Reading> {
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
        SpokenOf::Part => (first.budget.random(), 1.0 / n),
        SpokenOf::Operation => (0.0, 1.0 + 1.0 / n),
        SpokenOf::Closures => (0.0, 0.0),
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

    fn combined(values: &[f64], of: SpokenOf) -> f64 {
        mean(&readings(values), of)
            .expect("readings")
            .budget
            .combined()
    }

    const ALL: [SpokenOf; 3] = [SpokenOf::Part, SpokenOf::Operation, SpokenOf::Closures];

    #[test]
    fn repetition_helps_only_against_what_is_random() {
        for of in ALL {
            assert_eq!(combined(&[1.0; 4], of), 5.0);
            assert_eq!(combined(&[1.0], of), 73f64.sqrt());
            assert!(mean(&[], of).is_none());
        }
    }

    #[test]
    fn a_property_that_scatters_as_promised_is_doubted_no_more() {
        // Standard deviation 6.9 of 8.
        let apart = [1.0, 13.0, 1.0, 13.0];
        assert_eq!(combined(&apart, SpokenOf::Part), 5.0);
        assert_eq!(combined(&apart, SpokenOf::Closures), 5.0);
        assert!(combined(&apart, SpokenOf::Operation) > 6.9);
    }

    #[test]
    fn what_a_part_scatters_is_in_the_uncertainty_of_its_mean() {
        // Standard deviation 100; Student's t of two degrees of freedom is 4.53.
        let apart = [900.0, 1000.0, 1100.0];
        let promised_2 = 9.0 + 64.0 / 3.0;
        let with = |own_2: f64| (promised_2 + 2.265f64.powi(2) * own_2).sqrt();
        let near = |of, wanted: f64| assert!((combined(&apart, of) - wanted).abs() < 1e-9);
        near(SpokenOf::Part, with((1e4 - 64.0) / 3.0));
        near(SpokenOf::Operation, with(1e4 * 4.0 / 3.0));
        near(SpokenOf::Closures, with(0.0));
    }

    #[test]
    fn the_mean_of_a_bounce_covers_every_operation_it_was_made_of() {
        let apart = [1680.0, 1750.0, 1790.0, 1960.0];
        let mean = mean(&readings(&apart), SpokenOf::Operation).expect("readings");
        let furthest = apart.map(|it| (it - mean.value).abs());
        assert!(furthest.iter().all(|it| *it < mean.expanded()));
    }

    #[test]
    fn few_readings_are_widened_as_far_as_student_says() {
        assert_eq!(student(1), 6.985);
        assert_eq!(student(10), 1.14);
        // GUM, table G.2: 2.13 with 20, 2.05 with 50 degrees of freedom.
        assert!((student(20) - 2.13 / 2.0).abs() < 0.01);
        assert!((student(50) - 2.05 / 2.0).abs() < 0.01);
    }
}
