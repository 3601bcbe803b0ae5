use super::*;
use crate::gauge::Budget;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// Normal deviates: sums of twelve uniform ones less their mean.
struct Normal(Xoshiro256PlusPlus);

impl Normal {
    fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    fn next(&mut self) -> f64 {
        let uniform = |draw: u64| (draw >> 11) as f64 / (1u64 << 53) as f64;
        (0..12).map(|_| uniform(self.0.next_u64())).sum::<f64>() - 6.0
    }
}

fn one(square: f64, own: f64, others: f64) -> Residuals {
    Residuals {
        squares: square,
        freedom: 1,
        own,
        others,
    }
}

/// Number of residuals, of at most `parts`, that disprove a promise of 1 when the term is `factor` times as large.
fn noticed(seed: u64, factor: f64, others: f64, parts: usize, rate: f64) -> Option<usize> {
    let (mut normal, mut evidence) = (Normal::new(seed), Evidence::default());
    (1..=parts).find(|_| {
        let residual = factor * normal.next() + others.sqrt() * normal.next();
        evidence.add(one(residual * residual, 1.0, others));
        evidence.disproves(rate)
    })
}

#[test]
fn a_kept_promise_is_disproved_at_most_as_stated() {
    let lots = 2000;
    let alarms =
        |others| (0..lots).filter(move |seed| noticed(*seed, 1.0, others, 100, 0.02).is_some());
    for others in [0.0, 1.0] {
        let share = alarms(others).count() as f64 / lots as f64;
        assert!(share < 0.02, "{share} of the lots, others {others}");
    }
}

#[test]
fn twice_the_promised_scatter_is_noticed_within_fifty_residuals() {
    let lots = 300;
    let found = |others, parts| {
        (0..lots)
            .filter(|seed| noticed(*seed, 2.0, others, parts, 1e-5).is_some())
            .count()
    };
    assert!(
        found(0.0, 50) >= lots as usize * 97 / 100,
        "{}",
        found(0.0, 50)
    );
    assert!(
        found(1.0, 100) >= lots as usize * 95 / 100,
        "{}",
        found(1.0, 100)
    );
}

#[test]
fn less_scatter_than_promised_is_no_evidence() {
    assert_eq!(noticed(1, 0.5, 0.0, 1000, 0.5), None);
}

#[test]
fn the_scatter_seen_has_the_interval_of_chi_square() {
    // Quantiles of chi-square with 10 degrees of freedom: 3.247 and 20.483.
    let mut evidence = Evidence::default();
    evidence.add(Residuals {
        squares: 40.0,
        freedom: 10,
        own: 1.0,
        others: 0.0,
    });
    let seen = evidence.seen().expect("residuals");
    let near = |found: f64, wanted: f64| assert!((found - wanted).abs() < 1e-3, "{found} {wanted}");
    near(seen.value, 2.0);
    near(seen.interval.0, (40.0f64 / 20.483).sqrt());
    near(seen.interval.1, (40.0f64 / 3.247).sqrt());
    // Student's t of 10 degrees of freedom is 2.28.
    near(evidence.covering(), 2.0 * 1.14);
}

#[test]
fn other_terms_are_taken_out_of_the_scatter_seen() {
    let mut evidence = Evidence::default();
    evidence.add(Residuals {
        squares: 1000.0 * (4.0 + 3.0),
        freedom: 1000,
        own: 1.0,
        others: 3.0,
    });
    let seen = evidence.seen().expect("residuals");
    assert!((seen.value - 2.0).abs() < 1e-9);
    assert!(evidence.disproves(1e-5));
}

#[test]
fn no_residuals_are_no_evidence() {
    let mut none = Evidence::default();
    none.add(one(f64::NAN, 1.0, 0.0));
    none.add(one(1.0, 0.0, 0.0));
    assert_eq!(none, Evidence::default());
    assert_eq!((none.seen(), none.covering()), (None, 1.0));
    assert!(!none.disproves(0.01));
}

#[test]
fn a_promise_is_pooled_with_residuals() {
    assert_eq!(freedom_of(50.0), 2.0);
    assert_eq!(freedom_of(25.0), 8.0);
    let alone = Evidence::default().pooled(2.0);
    assert_eq!((alone.value, alone.freedom), (1.0, 2.0));
    let mut evidence = Evidence::default();
    evidence.add(Residuals {
        squares: 4.0 * 4.0,
        freedom: 4,
        own: 1.0,
        others: 0.0,
    });
    let pooled = evidence.pooled(2.0);
    assert!((pooled.value - 3f64.sqrt()).abs() < 1e-12, "{pooled:?}");
    assert_eq!(pooled.freedom, 6.0);
}

/// Share of the lots whose true value lies within U, for a promise known to 70 % that is wrong by `factor`, and four
/// residuals.
fn covered(factor: f64) -> f64 {
    let lots = 4000;
    let is_covered = |seed: &u64| {
        let mut normal = Normal::new(*seed);
        let mut evidence = Evidence::default();
        (0..4).for_each(|_| evidence.add(one((factor * normal.next()).powi(2), 1.0, 0.0)));
        let pooled = evidence.pooled(freedom_of(70.0));
        let u = Budget::default().with_estimated("own", pooled).expanded();
        (factor * normal.next()).abs() < u
    };
    (0..lots).filter(is_covered).count() as f64 / lots as f64
}

#[test]
fn a_pooled_promise_covers_though_wrong_by_two() {
    let (kept, broken) = (covered(1.0), covered(2.0));
    assert!((0.93..0.98).contains(&kept), "{kept}");
    assert!((0.92..0.96).contains(&broken), "{broken}");
}
