//! Control charts: of individuals and moving ranges, of means and ranges of subgroups, of the share of defectives.
//!
//! Limits lie three standard deviations from the centre. The deviation always comes from short-term variation: from the
//! mean moving range of neighbours, the mean range of subgroups, or the binomial distribution. The lower limit of a
//! range or a share is never below zero. The run rules are in [`super::rules`].

use super::capability::D2_PAIR;
use super::rules::{self, Rules, Signal};
use super::spread::{self, Spread};
use serde::Serialize;
use utoipa::ToSchema;

/// Factors for subgroups of n values: (n, A2, D3, D4), from the ASTM manual of control charts.
const FACTORS: [(usize, f64, f64, f64); 9] = [
    (2, 1.880, 0.0, 3.267),
    (3, 1.023, 0.0, 2.575),
    (4, 0.729, 0.0, 2.282),
    (5, 0.577, 0.0, 2.114),
    (6, 0.483, 0.0, 2.004),
    (7, 0.419, 0.076, 1.924),
    (8, 0.373, 0.136, 1.864),
    (9, 0.337, 0.184, 1.816),
    (10, 0.308, 0.223, 1.777),
];

/// One control chart. Every point has limits of its own, because on a chart of shares they differ from point to point.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Chart {
    /// Kind of chart: `individuals`, `moving range`, `means`, `ranges`, `share`.
    pub kind: &'static str,
    /// Points in order of time.
    pub points: Vec<Point>,
    /// Value of the centre line.
    pub centre: f64,
    /// Violations of the run rules.
    pub signals: Vec<Signal>,
}

/// A point with its limits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
pub struct Point {
    /// Plotted value.
    pub value: f64,
    /// Lower control limit.
    pub low: f64,
    /// Upper control limit.
    pub high: f64,
}

/// Returns a chart of individuals and one of moving ranges; `None` with fewer than two values.
pub fn individuals(values: &[f64], rules: Rules) -> Option<[Chart; 2]> {
    let centre = Spread::of(values).mean()?;
    let range = spread::mean_moving_range(values)?;
    let half = 3.0 * range / D2_PAIR;
    let moving: Vec<f64> = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    Some([
        level(
            "individuals",
            values,
            centre,
            [centre - half, centre + half],
            Some(rules),
        ),
        level("moving range", &moving, range, [0.0, 3.267 * range], None),
    ])
}

/// Returns a chart of means and one of ranges, for subgroups of `size` consecutive values, 2 to 10; leaves out an
/// incomplete last subgroup. Returns `None` for another size, and with fewer than two subgroups.
pub fn subgroups(values: &[f64], size: usize, rules: Rules) -> Option<[Chart; 2]> {
    let &(_, a2, d3, d4) = FACTORS.iter().find(|(n, ..)| *n == size)?;
    let groups: Vec<Spread> = values.chunks_exact(size).map(Spread::of).collect();
    if groups.len() < 2 {
        return None;
    }
    let means: Vec<f64> = groups.iter().filter_map(Spread::mean).collect();
    let ranges: Vec<f64> = groups
        .iter()
        .filter_map(|it| Some(it.max()? - it.min()?))
        .collect();
    let centre = Spread::of(&means).mean()?;
    let range = Spread::of(&ranges).mean()?;
    let limits = [centre - a2 * range, centre + a2 * range];
    Some([
        level("means", &means, centre, limits, Some(rules)),
        level("ranges", &ranges, range, [d3 * range, d4 * range], None),
    ])
}

/// Returns the chart of the share of defectives. Each group is `(number tested, number defective)` of a lot or an hour;
/// the chart leaves out groups without a tested part. Returns `None` when no group has one.
pub fn shares(groups: &[(u64, u64)]) -> Option<Chart> {
    let all: u64 = groups.iter().map(|(n, _)| n).sum();
    if all == 0 {
        return None;
    }
    let bad: u64 = groups.iter().map(|(_, bad)| bad).sum();
    let centre = bad as f64 / all as f64;
    let points: Vec<Point> = groups
        .iter()
        .filter(|(n, _)| *n > 0)
        .map(|&(n, bad)| {
            let half = 3.0 * (centre * (1.0 - centre) / n as f64).sqrt();
            Point {
                value: bad as f64 / n as f64,
                low: (centre - half).max(0.0),
                high: (centre + half).min(1.0),
            }
        })
        .collect();
    let signals = rules::beyond_own_limits(&points);
    Some(Chart {
        kind: "share",
        points,
        centre,
        signals,
    })
}

fn level(
    kind: &'static str,
    values: &[f64],
    centre: f64,
    [low, high]: [f64; 2],
    rules: Option<Rules>,
) -> Chart {
    let point = |&value: &f64| Point { value, low, high };
    let points: Vec<Point> = values.iter().map(point).collect();
    let signals = match rules {
        Some(rules) => rules::signals(values, centre, (high - centre) / 3.0, rules),
        None => rules::beyond_own_limits(&points),
    };
    Chart {
        kind,
        points,
        centre,
        signals,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn individuals_have_limits_from_the_mean_moving_range() {
        let [levels, ranges] = individuals(&[10.0, 12.0, 11.0, 13.0, 9.0], Rules::Nelson).unwrap();
        let range = (2.0 + 1.0 + 2.0 + 4.0) / 4.0;
        assert_eq!((levels.centre, ranges.centre), (11.0, range));
        assert!((levels.points[0].high - (11.0 + 3.0 * range / 1.128)).abs() < 1e-12);
        assert!((ranges.points[0].high - 3.267 * range).abs() < 1e-12);
        assert_eq!((levels.points.len(), ranges.points.len()), (5, 4));
        assert!(individuals(&[1.0], Rules::Nelson).is_none());
    }

    #[test]
    fn means_and_ranges_take_the_factors_of_their_subgroup() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0, 3.0, 4.0, 5.0, 6.0, 7.0, 99.0];
        let [means, ranges] = subgroups(&values, 5, Rules::Nelson).unwrap();
        assert_eq!((means.centre, ranges.centre), (4.0, 4.0));
        assert!((means.points[0].high - (4.0 + 0.577 * 4.0)).abs() < 1e-12);
        assert!((ranges.points[0].high - 2.114 * 4.0).abs() < 1e-12);
        assert!(subgroups(&values, 11, Rules::Nelson).is_none());
    }

    #[test]
    fn a_share_has_wider_limits_where_fewer_were_tested() {
        let it = shares(&[(100, 4), (0, 0), (400, 16), (100, 20)]).unwrap();
        let centre = 40.0 / 600.0;
        assert_eq!((it.points.len(), it.centre), (3, centre));
        let half = 3.0 * (centre * (1.0 - centre) / 400.0_f64).sqrt();
        assert!((it.points[1].high - (centre + half)).abs() < 1e-12);
        assert!(it.points[0].high > it.points[1].high && it.points[0].low == 0.0);
        assert_eq!(it.signals.iter().map(|it| it.at).collect::<Vec<_>>(), [2]);
        assert!(shares(&[(0, 0)]).is_none());
    }
}
