//! Run rules: patterns of points on a control chart that are unlikely by chance.
//!
//! A number in the table is how many points in a row make the pattern; deviations are standard deviations from the
//! centre.
//!
//! | rule: points | Nelson | Western Electric |
//! |---|---|---|
//! | 1: one beyond three deviations | yes | yes |
//! | 2: all on one side of the centre | 9 | 8 |
//! | 3: rising all the time, or falling all the time | 6 | |
//! | 4: alternately up and down | 14 | |
//! | 5: two of three beyond two deviations on one side | yes | yes |
//! | 6: four of five beyond one deviation on one side | yes | yes |
//! | 7: all within one deviation | 15 | |
//! | 8: none within one deviation, on both sides | 8 | |
//!
//! A rule signals at the point that completes its pattern. A pattern of rule 2, 3, 4, 7 or 8 signals once, however many
//! points follow in it; rules 1, 5 and 6 signal at every point that fits.

use super::chart::Point;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A published set of rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Rules {
    /// L. S. Nelson, Journal of Quality Technology 16 (1984).
    Nelson,
    /// Western Electric, Statistical Quality Control Handbook (1956).
    WesternElectric,
}

/// Signal of a rule: a point that completes its pattern.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
pub struct Signal {
    /// Index of the point that completes the pattern, from 0.
    pub at: usize,
    /// Number of the rule, 1 to 8.
    pub rule: u8,
}

/// Returns the signals of a set of rules, in the order of the points. `sigma` is the standard deviation of a point.
pub fn signals(points: &[f64], centre: f64, sigma: f64, rules: Rules) -> Vec<Signal> {
    // Deviations from the centre in units of `sigma`; when `sigma` is zero, points off the centre are infinitely far
    // away.
    let z: Vec<f64> = points
        .iter()
        .map(|it| {
            if *it == centre {
                0.0
            } else {
                (it - centre) / sigma
            }
        })
        .collect();
    let mut found = Vec::new();
    for at in 0..z.len() {
        let completed = completed(&z[..=at], rules);
        found.extend(completed.into_iter().map(|rule| Signal { at, rule }));
    }
    found
}

/// Returns a signal of rule 1 for each point outside its own limits. Charts whose limits differ from point to point
/// need this.
pub fn beyond_own_limits(points: &[Point]) -> Vec<Signal> {
    let beyond = |it: &Point| it.value > it.high || it.value < it.low;
    let places = points.iter().enumerate().filter(|(_, it)| beyond(it));
    places.map(|(at, _)| Signal { at, rule: 1 }).collect()
}

/// Returns the numbers of the rules whose pattern the last point completes.
fn completed(z: &[f64], rules: Rules) -> Vec<u8> {
    let side = match rules {
        Rules::Nelson => 9,
        Rules::WesternElectric => 8,
    };
    let both = [
        (1, last(z, 1, |it| it[0].abs() > 3.0)),
        (2, run(z, side, |it| one_side(it, it.len(), 0.0))),
        (5, last(z, 3, |it| ending(it, 2, 2.0))),
        (6, last(z, 5, |it| ending(it, 4, 1.0))),
    ];
    let only_nelson = [
        (3, run(z, 6, |it| steps(it, |a, b| a * b > 0.0))),
        (4, run(z, 14, |it| steps(it, |a, b| a * b < 0.0))),
        (7, run(z, 15, |it| it.iter().all(|z| z.abs() < 1.0))),
        (
            8,
            run(z, 8, |it| {
                it.iter().all(|z| z.abs() > 1.0) && !one_side(it, 8, 0.0)
            }),
        ),
    ];
    let nelson = only_nelson.into_iter().filter(|_| rules == Rules::Nelson);
    let mut numbers: Vec<u8> = both
        .into_iter()
        .chain(nelson)
        .filter_map(|(rule, speaks)| speaks.then_some(rule))
        .collect();
    numbers.sort_unstable();
    numbers
}

/// Returns true when the last `n` points have the pattern.
fn last(z: &[f64], n: usize, pattern: impl Fn(&[f64]) -> bool) -> bool {
    z.len() >= n && pattern(&z[z.len() - n..])
}

/// Returns true when the last `n` points have the pattern and the `n` points that end one point earlier do not, so that
/// a longer run signals once.
fn run(z: &[f64], n: usize, pattern: impl Fn(&[f64]) -> bool) -> bool {
    last(z, n, &pattern) && !last(&z[..z.len() - 1], n, &pattern)
}

/// Returns true when at least `n` points lie farther than `far` standard deviations from the centre on the same side.
fn one_side(z: &[f64], n: usize, far: f64) -> bool {
    let above = z.iter().filter(|&&it| it > far).count();
    let below = z.iter().filter(|&&it| it < -far).count();
    above >= n || below >= n
}

/// Returns true when the last point lies beyond `far`, and on its side at least `n` points do, the last one included.
fn ending(z: &[f64], n: usize, far: f64) -> bool {
    let Some(&end) = z.last() else { return false };
    let with_it = z.iter().filter(|&&it| it * end > 0.0 && it.abs() > far);
    end.abs() > far && with_it.count() >= n
}

/// Returns true when `relate` holds for every two consecutive steps from point to point.
fn steps(z: &[f64], relate: impl Fn(f64, f64) -> bool) -> bool {
    z.windows(3).all(|it| relate(it[1] - it[0], it[2] - it[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the signals for a centre of 0 and a standard deviation of 1, as (point, rule).
    fn signals_of(points: &[f64], rules: Rules) -> Vec<(usize, u8)> {
        let found = signals(points, 0.0, 1.0, rules);
        found.into_iter().map(|it| (it.at, it.rule)).collect()
    }

    #[test]
    fn every_rule_signals_when_its_pattern_is_complete() {
        let weave = |n: usize, high: f64| -> Vec<f64> {
            (0..n)
                .map(|it| if it % 2 == 0 { high } else { -high })
                .collect()
        };
        let flat: Vec<f64> = [
            0.1, 0.2, -0.3, -0.1, 0.2, 0.4, -0.1, -0.3, 0.2, 0.3, -0.2, -0.4, 0.1, 0.3, -0.2,
        ]
        .to_vec();
        let cases: [(u8, Vec<f64>); 8] = [
            (1, vec![0.5, 3.01]),
            (2, vec![0.5, 0.4, 0.6, 0.3, 0.5, 0.4, 0.4, 0.6, 0.5]),
            (3, vec![-0.9, -0.4, -0.1, 0.2, 0.6, 0.9]),
            (4, weave(14, 0.5)),
            (5, vec![2.1, 0.0, 2.2]),
            (6, vec![1.1, 1.2, -0.1, 1.1, 1.3]),
            (7, flat),
            (8, vec![1.1, -1.2, -1.4, 1.2, 1.3, -1.1, -1.5, 1.2]),
        ];
        for (rule, points) in cases {
            let before = signals_of(&points[..points.len() - 1], Rules::Nelson);
            assert!(before.is_empty(), "rule {rule} before its end: {before:?}");
            assert_eq!(
                signals_of(&points, Rules::Nelson),
                [(points.len() - 1, rule)]
            );
        }
    }

    #[test]
    fn western_electric_needs_eight_on_one_side() {
        let side = [0.5, 0.4, 0.6, 0.3, 0.5, 0.4, 0.4, 0.6, 0.5];
        assert_eq!(signals_of(&side, Rules::WesternElectric), [(7, 2)]);
        let trend = [-0.9, -0.4, -0.1, 0.2, 0.6, 0.9];
        assert_eq!(signals_of(&trend, Rules::WesternElectric), []);
    }

    #[test]
    fn a_continuing_pattern_signals_once() {
        let long: Vec<f64> = (0..30).map(|n| 0.4 + f64::from(n % 2) * 0.1).collect();
        let sides = signals_of(&long, Rules::WesternElectric);
        assert_eq!(sides, [(7, 2)]);
    }

    #[test]
    fn points_without_spread_give_no_signal() {
        assert_eq!(signals(&[5.0; 14], 5.0, 0.0, Rules::Nelson), []);
    }
}
