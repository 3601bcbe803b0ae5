//! Fuzzy inference over two inputs and seven levels each: minimum for "and", maximum for "or", centroid of the output.
//!
//! Levels are triangles of half width 1 around -3 to 3 (NB, NM, NS, ZO, PS, PM, PB); inputs beyond ±3 count as ±3. The
//! centroid is exact: between two neighbouring levels the clipped output is piecewise linear.

/// Levels from negative big to positive big.
pub const LEVELS: [Level; 7] = [
    Level::NB,
    Level::NM,
    Level::NS,
    Level::ZO,
    Level::PS,
    Level::PM,
    Level::PB,
];

/// A level of an input or an output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// Negative big, -3.
    NB,
    /// Negative medium, -2.
    NM,
    /// Negative small, -1.
    NS,
    /// Zero.
    ZO,
    /// Positive small, 1.
    PS,
    /// Positive medium, 2.
    PM,
    /// Positive big, 3.
    PB,
}

impl Level {
    /// Returns the peak of the triangle, -3 to 3.
    pub fn peak(self) -> f64 {
        f64::from(self as u8) - 3.0
    }
}

/// Rules: rows by the error NB to PB, columns by its change NB to PB.
pub type Table = [[Level; 7]; 7];

use Level::{NB, NM, NS, PB, PM, PS, ZO};

/// Rule table in common use for furnaces.
pub const FURNACE: Table = [
    [NB, NB, NB, NB, NM, ZO, ZO],
    [NB, NB, NB, NB, NM, ZO, ZO],
    [NM, NM, NM, NM, ZO, PS, PS],
    [NM, NM, NS, ZO, PS, PM, PM],
    [NS, NS, ZO, PM, PM, PM, PM],
    [ZO, ZO, PM, PB, PB, PB, PB],
    [ZO, ZO, PM, PB, PB, PB, PB],
];

/// Rule table of MacVicar-Whelan: the level is the sum of both inputs, within ±3.
pub const MACVICAR_WHELAN: Table = [
    [NB, NB, NB, NB, NM, NS, ZO],
    [NB, NB, NB, NM, NS, ZO, PS],
    [NB, NB, NM, NS, ZO, PS, PM],
    [NB, NM, NS, ZO, PS, PM, PB],
    [NM, NS, ZO, PS, PM, PB, PB],
    [NS, ZO, PS, PM, PB, PB, PB],
    [ZO, PS, PM, PB, PB, PB, PB],
];

/// Returns the output of the rules, -3 to 3.
///
/// ```
/// use chamber::control::fuzzy::{FURNACE, infer};
/// assert_eq!(infer(&FURNACE, 1.0, 0.0), 2.0);
/// ```
pub fn infer(table: &Table, error: f64, change: f64) -> f64 {
    centroid(&fired(table, error, change))
}

/// Returns for each level of the output the height at which the rules clip it.
fn fired(table: &Table, error: f64, change: f64) -> [f64; 7] {
    let (errors, changes) = (memberships(error), memberships(change));
    let mut heights = [0.0; 7];
    for (row, by_error) in table.iter().zip(errors) {
        for (level, by_change) in row.iter().zip(changes) {
            let height = &mut heights[*level as usize];
            *height = f64::max(*height, by_error.min(by_change));
        }
    }
    heights
}

fn memberships(input: f64) -> [f64; 7] {
    let input = input.clamp(-3.0, 3.0);
    LEVELS.map(|level| (1.0 - (input - level.peak()).abs()).max(0.0))
}

/// Returns the centre of the union of the clipped triangles on -4 to 4; zero when no rule fires.
fn centroid(heights: &[f64; 7]) -> f64 {
    let height = |index: i32| usize::try_from(index).ok().and_then(|it| heights.get(it));
    let (mut area, mut moment) = (0.0, 0.0);
    for index in -1..7 {
        let [left, right] = [index, index + 1].map(|it| height(it).copied().unwrap_or(0.0));
        let (piece, first) = between(left, right);
        area += piece;
        moment += first + piece * f64::from(index - 3);
    }
    if area > 0.0 { moment / area } else { 0.0 }
}

/// Returns area and first moment of the union between two neighbouring peaks; the moment is about the left peak.
fn between(left: f64, right: f64) -> (f64, f64) {
    let union = |x: f64| left.min(1.0 - x).max(right.min(x));
    let mut corners = [0.0, left, right, 0.5, 1.0 - left, 1.0 - right, 1.0];
    corners.sort_by(f64::total_cmp);
    let (mut area, mut moment) = (0.0, 0.0);
    for pair in corners.windows(2) {
        let (width, middle) = (pair[1] - pair[0], (pair[0] + pair[1]) / 2.0);
        let [a, b, c] = [pair[0], middle, pair[1]].map(|x| (x, union(x)));
        area += width * b.1;
        // Simpson's rule is exact for the product of two linear functions.
        moment += width / 6.0 * (a.0 * a.1 + 4.0 * b.0 * b.1 + c.0 * c.1);
    }
    (area, moment)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the centroid as a sum over samples of the clipped output on -4 to 4.
    fn sampled(heights: &[f64; 7], samples: i32) -> f64 {
        let union = |x: f64| {
            let clipped = |(level, height): (&Level, &f64)| {
                (1.0 - (x - level.peak()).abs()).max(0.0).min(*height)
            };
            LEVELS.iter().zip(heights).map(clipped).fold(0.0, f64::max)
        };
        let place = |sample: i32| -4.0 + 8.0 * f64::from(sample) / f64::from(samples - 1);
        let moment: f64 = (0..samples).map(|it| place(it) * union(place(it))).sum();
        moment / (0..samples).map(|it| union(place(it))).sum::<f64>()
    }

    /// The published values are sums over 61 samples; the exact centroid lies within 0.007 of them.
    #[test]
    fn both_tables_give_the_published_check_values() {
        let checks = [
            (&FURNACE, 1.0, 0.0, 2.0),
            (&FURNACE, 0.3, -0.2, 0.463),
            (&FURNACE, 3.0, 3.0, 3.0),
            (&MACVICAR_WHELAN, 1.0, 0.0, 1.0),
            (&MACVICAR_WHELAN, 0.3, -0.2, 0.091),
            (&MACVICAR_WHELAN, 2.4, 0.7, 2.642),
        ];
        for (table, error, change, published) in checks {
            let coarse = sampled(&fired(table, error, change), 61);
            assert!(
                (coarse - published).abs() < 6e-4,
                "{coarse}, expected {published}"
            );
            let exact = infer(table, error, change);
            assert!(
                (exact - published).abs() < 0.007,
                "{exact}, expected {published}"
            );
        }
    }

    #[test]
    fn macvicar_whelan_adds_its_inputs() {
        for (row, error) in MACVICAR_WHELAN.iter().zip(LEVELS) {
            for (level, change) in row.iter().zip(LEVELS) {
                let sum = (error.peak() + change.peak()).clamp(-3.0, 3.0);
                assert_eq!(level.peak(), sum);
            }
        }
    }

    #[test]
    fn both_tables_are_odd() {
        for table in [FURNACE, MACVICAR_WHELAN] {
            for (error, change) in [(0.7, 0.2), (2.2, -1.4), (5.0, 0.1)] {
                let sum = infer(&table, error, change) + infer(&table, -error, -change);
                assert!(sum.abs() < 1e-12);
            }
        }
    }

    /// Returns the rules of a table in the crate `rust-fuzzylogic`, whose centroid is a sum over samples.
    fn peer(table: &Table) -> rust_fuzzylogic::system::System {
        use rust_fuzzylogic::antecedent::Antecedent;
        use rust_fuzzylogic::mamdani::{Consequent, Rule};
        use rust_fuzzylogic::prelude::Triangular;
        use rust_fuzzylogic::system::SystemBuilder;
        let name = |level: Level| format!("{level:?}");
        let mut system = SystemBuilder::new().uniform_sampler(4_001).unwrap();
        for variable in ["error", "change", "power"] {
            system = system.var(variable, -4.0, 4.0).unwrap();
            for level in LEVELS {
                let peak = level.peak();
                let shape = Triangular::new(peak - 1.0, peak, peak + 1.0).unwrap();
                system = system.term(variable, name(level), shape).unwrap();
            }
        }
        let atom = |var: &str, level: Level| {
            Box::new(Antecedent::Atom {
                var: var.into(),
                term: name(level),
            })
        };
        for (row, error) in table.iter().zip(LEVELS) {
            for (level, change) in row.iter().zip(LEVELS) {
                let consequent = vec![Consequent {
                    var: "power".into(),
                    term: name(*level),
                }];
                let antecedent = Antecedent::And(atom("error", error), atom("change", change));
                system = system
                    .rule(Rule {
                        antecedent,
                        consequent,
                    })
                    .unwrap();
            }
        }
        system.build().unwrap()
    }

    #[test]
    fn both_tables_agree_with_the_crate_rust_fuzzylogic() {
        use rust_fuzzylogic::system::Evaluator;
        use std::collections::HashMap;
        for table in [FURNACE, MACVICAR_WHELAN] {
            let peer = peer(&table);
            for (error, change) in [
                (1.0, 0.0),
                (0.3, -0.2),
                (2.4, 0.7),
                (-1.6, 2.9),
                (-0.45, -2.2),
            ] {
                let inputs = HashMap::from([("error", error), ("change", change)]);
                let expected = peer.evaluate(&inputs).unwrap()["power"];
                let found = infer(&table, error, change);
                assert!(
                    (found - expected).abs() < 1e-4,
                    "{error} {change}: {found}, {expected}"
                );
            }
        }
    }

    #[test]
    fn the_exact_centroid_agrees_with_a_fine_sum() {
        let heights = [0.2, 0.7, 0.0, 0.45, 1.0, 0.55, 0.1];
        assert!((centroid(&heights) - sampled(&heights, 80_001)).abs() < 1e-5);
    }
}
