//! Lag of a lot, and the spread of lags within it, from parts that switched in passes of two rates.

use super::fit::{Expected, Fit, LAGS_S, Solution, fitted};
use super::scatter::scattered;
use super::{Filtered, Noise, Record, Switching, Transition};
use crate::statistics::{mean, median, robust};

/// Least spread of lags within a lot, one standard deviation of their logarithm; a lot whose spread is not known has this
/// one.
pub const LAG_SPREAD: f64 = 0.15;
/// Greatest spread: half of the parts with half the lag, half with double.
pub(super) const MOST_SPREAD: f64 = 5.0 * LAG_SPREAD;
/// Points of the search for a lag to begin with, evenly spaced in the logarithm.
const POINTS: i32 = 24;
/// Standard uncertainty of the logarithm of the lag of a part from which its passes tell none.
const UNTOLD: f64 = 0.5;
/// A part whose lag departs by more than this multiple of the robust deviation counts no further: it is slow, scatters
/// or creeps.
const OUTLIER: f64 = 4.0;
/// Greatest share of such parts; when there are more, the lot is a mixture, and all parts count.
const FEW: f64 = 0.2;
/// Rounds in which lag, spread and scatter settle.
const ROUNDS: usize = 20;

/// The lag of a lot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LotLag {
    /// Lag behind the reference sensor, s.
    pub seconds: f64,
    /// Standard uncertainty of the lag, s.
    pub u_s: f64,
    /// Standard deviation of the lags behind the air within the lot, as a share (of their logarithm); from
    /// [`LAG_SPREAD`] to five times that.
    pub spread: f64,
    /// Number of parts that count.
    pub parts: usize,
}

impl LotLag {
    /// Returns what to expect of the lag of a part.
    pub(super) fn expected(&self, noise: &Noise) -> Expected {
        let behind_air_s = (self.seconds + noise.sensor_lag_s).max(LAGS_S[0]);
        Expected {
            ln: behind_air_s.ln(),
            sd: self.spread.hypot(self.u_s / behind_air_s),
        }
    }
}

/// Finds lag and spread of a lot from parts that switched in two passes or more, at different rates; `assumed` is the
/// least scatter of their switchings. Returns `None` without such a part, or when the passes do not determine the lag. A
/// part with a transition that the record does not cover does not count.
pub fn lot_lag(record: &Record, parts: &[Switching], assumed: &Noise) -> Option<LotLag> {
    let begin = Expected {
        ln: assumed.ln_of(common(record, parts)?),
        sd: f64::INFINITY,
    };
    let fits = parts
        .iter()
        .filter_map(|it| fitted(record, it, &begin, assumed));
    let told = |it: &Fit| it.solved(&begin, assumed).variance < UNTOLD * UNTOLD;
    let kept = kept(fits.filter(told).collect(), &begin, assumed);
    let mut noise = *assumed;
    let mut found = Spread::of(&solved(&kept, &begin, &noise)?, LAG_SPREAD);
    for _ in 0..ROUNDS {
        noise = scattered(&kept, found.ln, &noise, assumed);
        found = Spread::of(&solved(&kept, &begin, &noise)?, found.sd);
    }
    Some(LotLag {
        seconds: assumed.lag_s(found.ln),
        u_s: found.u * found.ln.exp(),
        spread: found.sd,
        parts: kept.len(),
    })
}

/// Returns the lag of each part by itself; `None` without parts.
fn solved(parts: &[Fit], begin: &Expected, noise: &Noise) -> Option<Vec<Solution>> {
    let own = parts.iter().map(|it| it.solved(begin, noise));
    (!parts.is_empty()).then(|| own.collect())
}

/// Returns the parts without those whose lags are outliers.
fn kept(all: Vec<Fit>, begin: &Expected, noise: &Noise) -> Vec<Fit> {
    let lags: Vec<f64> = all.iter().map(|it| it.solved(begin, noise).ln).collect();
    let Some((middle, sd)) = robust(&lags) else {
        return all;
    };
    let limit = OUTLIER * sd.max(LAG_SPREAD);
    let is_far = |ln: &f64| (ln - middle).abs() > limit;
    let far = lags.iter().filter(|it| is_far(it)).count();
    let is_mixture = far as f64 > FEW * lags.len() as f64;
    let all = all.into_iter().zip(&lags);
    all.filter(|(_, ln)| is_mixture || !is_far(ln))
        .map(|(it, _)| it)
        .collect()
}

/// Lag and spread of parts, in logarithms of their lags behind the air.
#[derive(Debug, Clone, Copy)]
struct Spread {
    ln: f64,
    /// Standard uncertainty of `ln`.
    u: f64,
    sd: f64,
}

impl Spread {
    /// Improves a standard deviation of the lags: one step towards the greatest likelihood of lags that scatter by it and
    /// by their own uncertainties.
    fn of(own: &[Solution], sd: f64) -> Self {
        let weight = |it: &Solution| (sd * sd + it.variance).recip();
        let sum = |of: &dyn Fn(&Solution) -> f64| own.iter().map(of).sum::<f64>();
        let weights = sum(&weight);
        let ln = sum(&|it| weight(it) * it.ln) / weights;
        let unbiased = own.len() as f64 / (own.len() as f64 - 1.0).max(1.0);
        let excess = |it: &Solution| unbiased * (it.ln - ln).powi(2) - it.variance;
        let variance = sum(&|it| weight(it).powi(2) * excess(it)) / sum(&|it| weight(it).powi(2));
        Self {
            ln,
            u: weights.recip().sqrt(),
            sd: variance.max(0.0).sqrt().clamp(LAG_SPREAD, MOST_SPREAD),
        }
    }
}

/// Returns the lag, s, with which the passes of the parts agree best in the median; `None` when it lies at an end of the
/// range of lags.
fn common(record: &Record, parts: &[Switching]) -> Option<f64> {
    let switching: Vec<&[Transition]> = parts
        .iter()
        .flat_map(|part| [part.operate.as_slice(), part.reset.as_slice()])
        .filter(|all| all.len() >= 2 && all.iter().all(|it| record.covers(it.first_s)))
        .collect();
    let [low, high] = LAGS_S.map(f64::ln);
    let lag_s = |point: i32| (low + (high - low) * f64::from(point) / f64::from(POINTS)).exp();
    let mut best = (0, f64::INFINITY);
    for point in 0..=POINTS {
        let filtered = record.filtered(lag_s(point));
        let all: Vec<f64> = switching
            .iter()
            .filter_map(|it| spread(&filtered, it))
            .collect();
        let found = median(&all)?;
        if found < best.1 {
            best = (point, found);
        }
    }
    (1..POINTS).contains(&best.0).then(|| lag_s(best.0))
}

/// Returns the mean square of the temperatures of transitions about their mean, K²; `None` outside the record.
fn spread(filtered: &Filtered<'_>, all: &[Transition]) -> Option<f64> {
    let celsius = |it: &Transition| filtered.at(it.first_s).map(|at| at.celsius);
    let temperatures: Vec<f64> = all.iter().map(celsius).collect::<Option<_>>()?;
    let middle_c = mean(&temperatures);
    let squares = temperatures.iter().map(|it| (it - middle_c).powi(2));
    Some(squares.sum::<f64>() / (temperatures.len() as f64 - 1.0))
}
