//! Scatter of the switchings of a lot, from how much the passes of its parts disagree.
//!
//! Two things make passes at different rates disagree: the scatter, and a lag other than the one that a part has. So each
//! part gets its own lag here, whatever the spread of the lot: a spread that is found too wide would else explain some
//! of the scatter.

use super::fit::{Expected, Fit, fitted};
use super::lot::MOST_SPREAD;
use super::{LotLag, Noise, Record, Switching};
use crate::statistics::median;

/// Degrees of freedom below which the passes of a part tell nothing of its scatter.
const LEAST_FREEDOM: f64 = 0.5;
/// Largest scatter that [`lot_scatter`] finds, in multiples of the assumed one.
const MOST: f64 = 5.0;
/// Rounds in which the scatter settles.
const ROUNDS: usize = 12;
/// A part whose misfit exceeds its degrees of freedom by more than this multiple of the standard deviation of chi squared
/// is defective and does not count. In two passes, which leave one degree of freedom, a sound part does so once in 10,000
/// times; were it more often, the scatter would come out too low.
const FAR: f64 = 10.0;

/// Returns the scatter of switchings, K, that explains how much the passes of the parts of a lot disagree: at least the
/// assumed one, at most five times that. Parts that disagree far more than the others do not count, nor does a part that
/// switched only once each way.
pub fn lot_scatter(record: &Record, parts: &[Switching], lag: &LotLag, assumed: &Noise) -> f64 {
    let expected = Expected {
        sd: MOST_SPREAD,
        ..lag.expected(assumed)
    };
    let parts = parts.iter();
    let fits: Vec<Fit> = parts
        .filter_map(|it| fitted(record, it, &expected, assumed))
        .collect();
    let settles = |noise: Noise, _| scattered(&fits, expected.ln, &noise, assumed);
    (0..ROUNDS).fold(*assumed, settles).scatter_k
}

/// Returns the noise with the scatter that explains the misfits of parts under the present one; `ln`: logarithm of the
/// lag of the lot behind the air, s.
pub(super) fn scattered(fits: &[Fit], ln: f64, noise: &Noise, assumed: &Noise) -> Noise {
    let sd = MOST_SPREAD;
    let solved = fits.iter().map(|it| it.solved(&Expected { ln, sd }, noise));
    let all: Vec<[f64; 2]> = solved
        .filter(|it| it.freedom > LEAST_FREEDOM)
        .map(|it| [it.misfit, it.freedom])
        .collect();
    let found_k = noise.scatter_k * ratio(&all).unwrap_or(0.0).sqrt();
    Noise {
        scatter_k: found_k.clamp(assumed.scatter_k, MOST * assumed.scatter_k),
        ..*assumed
    }
}

/// Returns the ratio of misfits to the ones that the noise explains, each part with its degrees of freedom: the pooled ratio
/// of the sound parts, or the median while fewer than half of the parts are sound.
fn ratio(all: &[[f64; 2]]) -> Option<f64> {
    let is_sound = |[misfit, freedom]: &&[f64; 2]| *misfit < freedom + FAR * (2.0 * freedom).sqrt();
    let sound = all.iter().filter(is_sound);
    if 2 * sound.clone().count() > all.len() {
        let [misfit, freedom] = sound.fold([0.0; 2], |sum, it| [sum[0] + it[0], sum[1] + it[1]]);
        return Some(misfit / freedom);
    }
    // Median of chi squared by the approximation of Wilson and Hilferty.
    let middle = |freedom: f64| freedom * (1.0 - 2.0 / (9.0 * freedom)).powi(3);
    let ratios: Vec<f64> = all
        .iter()
        .map(|[misfit, freedom]| misfit / middle(*freedom))
        .collect();
    median(&ratios)
}
