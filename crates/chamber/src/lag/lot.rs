//! Lag of a lot: the lag with which the passes of each part agree best.

use super::{Filtered, Record, Switching, Transition};
use crate::statistics::{mean, median};

/// Least and greatest lag that the search tries, s.
const LAGS_S: [f64; 2] = [2.0, 400.0];
/// Points of the first search, evenly spaced in the logarithm.
const POINTS: i32 = 24;
/// A part whose passes disagree by more than this multiple of the median counts no further: it scatters or creeps.
const OUTLIER: f64 = 5.0;
/// Ratio of the median of squares of a normal quantity to its variance.
const MEDIAN_OF_SQUARES: f64 = 0.455;

/// The lag of a lot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LotLag {
    /// Lag behind the reference sensor, s.
    pub seconds: f64,
    /// Standard uncertainty of the lag, s.
    pub u_s: f64,
    /// Number of parts that count.
    pub parts: usize,
}

/// Finds the lag of a lot from parts that switched in two passes or more, at different rates. Returns `None` without
/// such a part, or when the passes do not determine the lag. A part with a transition that the record does not cover
/// does not count.
pub fn lot_lag(record: &Record, parts: &[Switching]) -> Option<LotLag> {
    let switching: Vec<&[Transition]> = parts
        .iter()
        .flat_map(|part| [part.operate.as_slice(), part.reset.as_slice()])
        .filter(|all| all.len() >= 2 && all.iter().all(|it| record.covers(it.first_s)))
        .collect();
    let first_s = least(|lag_s| median(&spreads(record, &switching, lag_s)))?;
    let typical = median(&spreads(record, &switching, first_s))?;
    let limit = (OUTLIER * OUTLIER * typical / MEDIAN_OF_SQUARES).max(1e-6);
    let at_first = record.filtered(first_s);
    let kept: Vec<&[Transition]> = switching
        .into_iter()
        .filter(|all| spread(&at_first, all).is_some_and(|it| it <= limit))
        .collect();
    let cost = |lag_s: f64| {
        let all = spreads(record, &kept, lag_s);
        (!all.is_empty()).then(|| mean(&all))
    };
    let seconds = least(cost)?;
    Some(LotLag {
        seconds,
        u_s: uncertainty(&cost, seconds, kept.len())?,
        parts: kept.len(),
    })
}

/// Returns for each list of transitions the mean square of its temperatures about their mean, K², with the record
/// filtered by a lag.
fn spreads(record: &Record, switching: &[&[Transition]], lag_s: f64) -> Vec<f64> {
    let filtered = record.filtered(lag_s);
    let all = switching.iter();
    all.filter_map(|it| spread(&filtered, it)).collect()
}

/// Returns the mean square of the temperatures of transitions about their mean, K²; `None` outside the record.
fn spread(filtered: &Filtered<'_>, all: &[Transition]) -> Option<f64> {
    let celsius = |it: &Transition| filtered.at(it.first_s).map(|at| at.celsius);
    let temperatures: Vec<f64> = all.iter().map(celsius).collect::<Option<_>>()?;
    let middle_c = mean(&temperatures);
    let squares = temperatures.iter().map(|it| (it - middle_c).powi(2));
    Some(squares.sum::<f64>() / (temperatures.len() as f64 - 1.0))
}

/// Returns the lag of the least cost: a coarse search, then golden section. Returns `None` when the cost is least at an
/// end of the range.
fn least(cost: impl Fn(f64) -> Option<f64>) -> Option<f64> {
    let [low, high] = LAGS_S.map(f64::ln);
    let place = |point: i32| low + (high - low) * f64::from(point) / f64::from(POINTS);
    let at = |ln: f64| cost(ln.exp());
    let (mut best, mut value) = (0, f64::INFINITY);
    for point in 0..=POINTS {
        let found = at(place(point))?;
        if found < value {
            (best, value) = (point, found);
        }
    }
    if best == 0 || best == POINTS {
        return None;
    }
    let (mut left, mut right) = (place(best - 1), place(best + 1));
    const GOLDEN: f64 = 0.618_033_988_749_895;
    for _ in 0..24 {
        let [a, b] = [
            right - GOLDEN * (right - left),
            left + GOLDEN * (right - left),
        ];
        if at(a)? < at(b)? { right = b } else { left = a }
    }
    Some(((left + right) / 2.0).exp())
}

/// Returns the standard uncertainty of the best lag, s, from the curvature of the mean spread.
fn uncertainty(mean: &impl Fn(f64) -> Option<f64>, seconds: f64, lists: usize) -> Option<f64> {
    let step = 0.1 * seconds;
    let [below, best, above] = [seconds - step, seconds, seconds + step].map(mean);
    let best = best?;
    let curvature = (below? - 2.0 * best + above?) / (step * step);
    (curvature > 0.0).then(|| (2.0 * best / (curvature * lists as f64)).sqrt())
}
