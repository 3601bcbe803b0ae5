//! Scatter of the switchings of a lot, from how much the passes of its parts disagree.

use super::fit::{Expected, Fit, fitted};
use super::{LotLag, Noise, Record, Switching};
use crate::statistics::median;

/// Largest scatter that [`lot_scatter`] finds, in multiples of the assumed one.
const MOST: f64 = 5.0;
/// Rounds in which the scatter settles.
const ROUNDS: usize = 12;
/// A part whose misfit exceeds its degrees of freedom by more than this multiple of the standard deviation of chi squared
/// is defective and does not count.
const FAR: f64 = 6.0;

/// Returns the scatter of switchings, K, that explains how much the passes of the parts of a lot disagree: at least the
/// assumed one, at most five times that. Parts that disagree far more than the others do not count, nor does a part that
/// switched only once each way.
pub fn lot_scatter(record: &Record, parts: &[Switching], lag: &LotLag, assumed: &Noise) -> f64 {
    let expected = lag.expected(assumed);
    let parts = parts.iter();
    let fits: Vec<Fit> = parts
        .filter_map(|it| fitted(record, it, &expected, assumed))
        .collect();
    let settles = |noise: Noise, _| scattered(&fits, &expected, &noise, assumed);
    (0..ROUNDS).fold(*assumed, settles).scatter_k
}

/// Returns the noise with the scatter that explains the misfits of parts under the present one.
pub(super) fn scattered(
    fits: &[Fit],
    expected: &Expected,
    noise: &Noise,
    assumed: &Noise,
) -> Noise {
    let told = fits.iter().filter(|it| it.freedom() > 0);
    let all: Vec<[f64; 2]> = told
        .map(|it| [it.solved(expected, noise).misfit, it.freedom() as f64])
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
