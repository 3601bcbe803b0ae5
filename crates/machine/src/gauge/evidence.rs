//! Evidence against a promised standard deviation: pooled residuals, tested anew after each of them.
//!
//! The promised variance of a residual is the sum of the promised variance of the term under test and the variances of
//! all other terms. If the standard deviation of the term is `f` times the promised one, the likelihood of the residual
//! changes by a known ratio. The evidence is the mean of these ratios over the factors `f` in [`FACTORS`]. While the
//! promise holds, the expectation of the evidence never grows, so the evidence reaches `1 / rate` in a share of at most
//! `rate` of all lots, however often it is tested (Ville's inequality). A smaller scatter than promised is no evidence.

use super::factor::Deviation;
use super::repetition::student;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Multiples of the promised standard deviation that the evidence compares it with.
const FACTORS: [f64; 5] = [1.25, 1.5, 2.0, 3.0, 5.0];

/// Probability on either side of the interval in [`Evidence::seen`].
const TAIL: f64 = 0.025;

/// Returns the degrees of freedom of a standard deviation that is known to `u_pct` percent (GUM G.4.2).
pub fn freedom_of(u_pct: f64) -> f64 {
    0.5 * (100.0 / u_pct).powi(2)
}

/// Residuals with the variance that was promised for each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Residuals {
    /// Sum of squares, in the unit of the variances.
    pub squares: f64,
    /// Degrees of freedom.
    pub freedom: u32,
    /// Promised variance of the term under test.
    pub own: f64,
    /// Variance of all other terms.
    pub others: f64,
}

impl Residuals {
    /// Returns the deviations of values from their mean; `None` below two values or for one that is not a number.
    pub fn about_mean(values: &[f64], own: f64, others: f64) -> Option<Self> {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|it| (it - mean).powi(2)).sum();
        let freedom = u32::try_from(values.len().checked_sub(1)?).ok()?;
        (freedom > 0 && squares.is_finite()).then_some(Self {
            squares,
            freedom,
            own,
            others,
        })
    }
}

/// Evidence about one promised standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Evidence {
    /// Sum of the squared residuals, each divided by its promised variance.
    squares: f64,
    freedom: f64,
    /// Sum of the term's share of the promised variance, over the degrees of freedom.
    shares: f64,
    /// Logarithm of the likelihood ratio at each of [`FACTORS`].
    logarithms: [f64; FACTORS.len()],
}

/// A standard deviation that residuals show, as multiples of the promised one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Estimate; 0 when the other terms explain all of the scatter.
    pub value: f64,
    /// Ends of the 95 % interval of `value`.
    pub interval: (f64, f64),
    /// Degrees of freedom.
    pub freedom: f64,
}

impl Evidence {
    /// Adds residuals; ignores those without a promised variance above zero.
    pub fn add(&mut self, of: Residuals) {
        let promised = of.own + of.others;
        let (squares, freedom) = (of.squares / promised, f64::from(of.freedom));
        if !squares.is_finite() || of.own <= 0.0 {
            return;
        }
        let share = of.own / promised;
        self.squares += squares;
        self.freedom += freedom;
        self.shares += share * freedom;
        for (sum, factor) in self.logarithms.iter_mut().zip(FACTORS) {
            let ratio = 1.0 + share * (factor * factor - 1.0);
            *sum += (squares * (1.0 - 1.0 / ratio) - freedom * ratio.ln()) / 2.0;
        }
    }

    /// Returns true when the residuals disprove the promise. A promise that holds is disproved in a share of at most
    /// `rate` of all lots.
    pub fn disproves(&self, rate: f64) -> bool {
        let greatest = self.logarithms.into_iter().fold(f64::MIN, f64::max);
        let sum: f64 = self.logarithms.iter().map(|it| (it - greatest).exp()).sum();
        greatest + (sum / FACTORS.len() as f64).ln() >= -rate.ln()
    }

    /// Returns the standard deviation that the residuals show; `None` without any.
    pub fn seen(&self) -> Option<Seen> {
        let chi = ChiSquared::new(self.freedom).ok()?;
        let of = |expected: f64| self.multiple(self.squares / expected);
        Some(Seen {
            value: of(self.freedom),
            interval: (of(chi.inverse_cdf(1.0 - TAIL)), of(chi.inverse_cdf(TAIL))),
            freedom: self.freedom,
        })
    }

    /// Returns the standard deviation that budgets should use, as a multiple of the promised one: the estimate widened
    /// by Student's t, at least 1.
    pub fn covering(&self) -> f64 {
        if self.freedom < 1.0 {
            return 1.0;
        }
        let widened = student(self.freedom as usize).powi(2) * self.squares / self.freedom;
        self.multiple(widened).max(1.0)
    }

    /// Returns the pooled standard deviation, as a multiple of the promised one. The promise counts as much as
    /// residuals with `promise` degrees of freedom.
    pub fn pooled(&self, promise: f64) -> Deviation {
        let freedom = promise + self.freedom;
        Deviation {
            value: self.multiple((promise + self.squares) / freedom),
            freedom,
        }
    }

    /// Returns the multiple of the promised standard deviation at which the variance of all terms together is `ratio`
    /// times the promised one.
    fn multiple(&self, ratio: f64) -> f64 {
        let share = match self.freedom > 0.0 {
            true => self.shares / self.freedom,
            false => 1.0,
        };
        (1.0 + (ratio - 1.0) / share).max(0.0).sqrt()
    }
}

#[cfg(test)]
mod tests;
