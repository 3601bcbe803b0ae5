//! Chooses the passes of a batch: rates by the number of the batch, begin of the slow rate by the temperatures seen, a slow
//! repeat near limits.

use crate::program::{Pass, Window};
use crate::statistics::robust;

/// Standard deviations on either side of the middle that a narrowed window keeps.
const KEPT_SD: f64 = 3.0;
/// Least half width of a narrowed window, K.
const LEAST_HALF_K: f64 = 0.5;
/// Least number of temperatures that narrow a window.
const LEAST_SHOWN: usize = 5;

/// Rates of the passes, K/min.
#[derive(Debug, Clone, PartialEq)]
pub struct Strategy {
    /// Of the first batch of a lot, and of each batch that measures the lag again. Only two or more different rates
    /// determine the lag.
    pub learning: Vec<f64>,
    /// Of all other batches.
    pub known: Vec<f64>,
    /// Number of batches from one that measures the lag to the next.
    pub every: usize,
    /// Of the slow repeat.
    pub repeat: f64,
}

impl Strategy {
    /// Measures the lag at 5 and 2 K/min in every fifth batch; runs one pass at 2 K/min in the others; repeats at 1
    /// K/min.
    pub fn usual() -> Self {
        Self {
            learning: vec![5.0, 2.0],
            known: vec![2.0],
            every: 5,
            repeat: 1.0,
        }
    }

    /// Returns true for a batch, from 0, that measures the lag.
    pub fn learns(&self, batch: usize, lag_is_known: bool) -> bool {
        !lag_is_known || batch.is_multiple_of(self.every.max(1))
    }

    /// Returns the passes of a batch, from 0; `lag_is_known` tells whether the lot has a lag.
    pub fn passes(
        &self,
        batch: usize,
        lag_is_known: bool,
        operate: Window,
        reset: Window,
    ) -> Vec<Pass> {
        let rates = match self.learns(batch, lag_is_known) {
            true => &self.learning,
            false => &self.known,
        };
        let pass = |rate: &f64| Pass {
            rate_k_per_min: *rate,
            operate,
            reset,
        };
        rates.iter().map(pass).collect()
    }

    /// Returns the slow repeat for parts near a limit: the temperatures at which they operated and reset; `None`
    /// without such a part.
    pub fn repeat(&self, near: &[[f64; 2]], u_k: f64) -> Option<Pass> {
        let window = |which: usize| {
            let all = near.iter().map(|it| it[which]);
            let low_c = all.clone().fold(f64::INFINITY, f64::min) - u_k;
            let high_c = all.fold(f64::NEG_INFINITY, f64::max) + u_k;
            Window { low_c, high_c }
        };
        (!near.is_empty()).then(|| Pass {
            rate_k_per_min: self.repeat,
            operate: window(0),
            reset: window(1),
        })
    }
}

/// Returns true when a limit lies within the uncertainty of a value: the part needs a slow repeat.
pub fn is_near_limit(value: f64, u_k: f64, limits: &[f64]) -> bool {
    limits.iter().any(|limit| (value - limit).abs() < u_k)
}

/// Returns the window of the temperatures that a pass has shown: three standard deviations to either side of their
/// median, inside the expected window. Returns the expected window when there are fewer than five temperatures, or when
/// they lie outside it.
pub fn narrowed(shown_c: &[f64], expected: Window) -> Window {
    let Some(shown) = spanned(shown_c) else {
        return expected;
    };
    let inside = Window {
        low_c: shown.low_c.max(expected.low_c),
        high_c: shown.high_c.min(expected.high_c),
    };
    match inside.low_c < inside.high_c {
        true => inside,
        false => expected,
    }
}

/// Returns the window of three standard deviations to either side of the median of temperatures; `None` for fewer than
/// five.
fn spanned(shown_c: &[f64]) -> Option<Window> {
    if shown_c.len() < LEAST_SHOWN {
        return None;
    }
    let (middle_c, sd_k) = robust(shown_c)?;
    let half_k = (KEPT_SD * sd_k).max(LEAST_HALF_K);
    Some(Window {
        low_c: middle_c - half_k,
        high_c: middle_c + half_k,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDE: Window = Window {
        low_c: 75.0,
        high_c: 95.0,
    };

    #[test]
    fn the_first_and_every_fifth_batch_learn() {
        let strategy = Strategy::usual();
        let counts: Vec<usize> = (0..11)
            .map(|batch| strategy.passes(batch, true, WIDE, WIDE).len())
            .collect();
        assert_eq!(counts, [2, 1, 1, 1, 1, 2, 1, 1, 1, 1, 2]);
        assert_eq!(strategy.passes(3, false, WIDE, WIDE).len(), 2);
    }

    #[test]
    fn a_wild_part_does_not_widen_the_window() {
        let mut shown: Vec<f64> = (0..39).map(|i| 83.0 + 0.1 * f64::from(i)).collect();
        shown.push(120.0);
        let found = narrowed(&shown, WIDE);
        assert!(found.low_c > 79.0 && found.high_c < 91.0, "{found:?}");
        assert_eq!(narrowed(&shown[..4], WIDE), WIDE);
    }

    #[test]
    fn only_parts_near_a_limit_are_repeated() {
        assert!(is_near_limit(87.7, 0.42, &[82.0, 88.0]));
        assert!(!is_near_limit(87.5, 0.42, &[82.0, 88.0]));
        let strategy = Strategy::usual();
        assert_eq!(strategy.repeat(&[], 0.4), None);
        let pass = strategy.repeat(&[[87.8, 66.0], [82.1, 61.0]], 0.4);
        let pass = pass.map(|it| (it.operate.low_c, it.reset.high_c, it.rate_k_per_min));
        assert_eq!(pass, Some((82.1 - 0.4, 66.4, 1.0)));
    }

    #[test]
    fn parts_outside_the_expected_window_leave_it_alone() {
        for shown_c in [70.0, 99.0] {
            assert_eq!(narrowed(&[shown_c; 6], WIDE), WIDE);
        }
    }
}
