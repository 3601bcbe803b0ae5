//! Sine of the mains: offset, fundamental with its frequency, third and fifth harmonic.

use super::least_squares::Sums;
use std::f64::consts::{PI, TAU};

/// Number of unknowns of the fit: offset, sine and cosine of three harmonics, change of the frequency.
const UNKNOWNS: usize = 8;
/// Orders of the fitted harmonics.
const ORDERS: [f64; 3] = [1.0, 3.0, 5.0];
/// Rounds of the fit. Each squares the relative error of the round before.
const ROUNDS: usize = 4;
/// Largest deviation from the nominal frequency, as a share of it.
const NEAR: f64 = 0.05;

/// A fitted sine with harmonics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mains {
    /// Frequency, Hz.
    pub hz: f64,
    /// Mean.
    pub offset: f64,
    /// Factors of sine and cosine of each harmonic.
    terms: [[f64; 2]; 3],
    /// Standard deviation of the samples around the fit.
    pub residual: f64,
    /// Standard uncertainty of sine or cosine of the fundamental from noise.
    pub u: f64,
}

impl Mains {
    /// Fits samples (time in s, value). Returns `None` when they do not determine frequency and harmonics, or when the
    /// frequency is more than 5 % off the nominal one.
    pub fn fit(samples: impl Iterator<Item = (f64, f64)> + Clone, nominal_hz: f64) -> Option<Self> {
        let middle_s = middle(samples.clone())?;
        let mut fit = Self {
            hz: nominal_hz,
            offset: 0.0,
            terms: [[0.0; 2]; 3],
            residual: 0.0,
            u: 0.0,
        };
        for round in 0..ROUNDS {
            fit = fit.refined(samples.clone(), middle_s, round > 0)?;
        }
        let is_near = (fit.hz / nominal_hz - 1.0).abs() < NEAR;
        (is_near && fit.amplitude() > 0.0).then_some(fit)
    }

    /// Fits the harmonics at the present frequency, and with `turns` also its change. Times count from `middle_s`, so
    /// that frequency and phase do not depend on each other; afterwards the result refers to time 0 again.
    fn refined(
        self,
        samples: impl Iterator<Item = (f64, f64)>,
        middle_s: f64,
        turns: bool,
    ) -> Option<Self> {
        let omega = TAU * self.hz;
        let local = self.shifted(middle_s);
        let [sine, cosine] = local.terms[0];
        let mut sums = Sums::<UNKNOWNS>::default();
        for (time_s, value) in samples {
            let since_s = time_s - middle_s;
            let (s1, c1) = (omega * since_s).sin_cos();
            let (s2, c2) = (2.0 * s1 * c1, c1 * c1 - s1 * s1);
            let (s3, c3) = (s2 * c1 + c2 * s1, c2 * c1 - s2 * s1);
            let (s5, c5) = (s3 * c2 + c3 * s2, c3 * c2 - s3 * s2);
            let slip = omega * since_s * (sine * c1 - cosine * s1);
            // A fit without `turns` has no change of the frequency.
            let slip = if turns { slip } else { 0.0 };
            sums.add([1.0, s1, c1, s3, c3, s5, c5, slip], value);
        }
        if !turns {
            sums.add([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 0.0);
        }
        let solution = sums.solve()?;
        let [offset, s1, c1, s3, c3, s5, c5, slip] = solution.of;
        let fitted = Self {
            hz: self.hz * (1.0 + slip),
            offset,
            terms: [[s1, c1], [s3, c3], [s5, c5]],
            residual: solution.residual,
            u: solution.u[1].max(solution.u[2]),
        };
        Some(fitted.shifted(-middle_s))
    }

    /// Returns the same curve with time zero `by_s` later.
    fn shifted(&self, by_s: f64) -> Self {
        let mut shifted = *self;
        for (term, order) in shifted.terms.iter_mut().zip(ORDERS) {
            let (sin, cos) = (TAU * self.hz * order * by_s).sin_cos();
            let [sine, cosine] = *term;
            *term = [sine * cos - cosine * sin, sine * sin + cosine * cos];
        }
        shifted
    }

    /// Returns the value at a time.
    pub fn at(&self, time_s: f64) -> f64 {
        let term = |(term, order): (&[f64; 2], f64)| {
            let (sin, cos) = (TAU * self.hz * order * time_s).sin_cos();
            term[0] * sin + term[1] * cos
        };
        self.offset + self.terms.iter().zip(ORDERS).map(term).sum::<f64>()
    }

    /// Returns the value of the fundamental alone at a time.
    pub fn fundamental(&self, time_s: f64) -> f64 {
        let (sin, cos) = (TAU * self.hz * time_s).sin_cos();
        self.terms[0][0] * sin + self.terms[0][1] * cos
    }

    /// Returns the rise per second at a time.
    pub fn slope(&self, time_s: f64) -> f64 {
        let term = |(term, order): (&[f64; 2], f64)| {
            let omega = TAU * self.hz * order;
            let (sin, cos) = (omega * time_s).sin_cos();
            omega * (term[0] * cos - term[1] * sin)
        };
        self.terms.iter().zip(ORDERS).map(term).sum()
    }

    /// Returns the same curve without its offset.
    pub fn centred(self) -> Self {
        Self {
            offset: 0.0,
            ..self
        }
    }

    /// Returns the factors of sine and cosine of the fundamental.
    pub fn phasor(&self) -> [f64; 2] {
        self.terms[0]
    }

    /// Returns the amplitude of the fundamental.
    pub fn amplitude(&self) -> f64 {
        self.terms[0][0].hypot(self.terms[0][1])
    }

    /// Returns the rms with harmonics, without the offset.
    pub fn rms(&self) -> f64 {
        let squares = self.terms.iter().flatten().map(|it| it * it);
        (squares.sum::<f64>() / 2.0).sqrt()
    }

    /// Returns half a period, s.
    pub fn half_s(&self) -> f64 {
        0.5 / self.hz
    }

    /// Returns the first zero crossing after a time, s.
    pub fn zero_after(&self, time_s: f64) -> f64 {
        let phase = (self.terms[0][1].atan2(self.terms[0][0]) + TAU * self.hz * time_s) / PI;
        let mut zero_s = time_s + (1.0 - phase.rem_euclid(1.0)) * self.half_s();
        // Harmonics and offset move the zero of the fundamental a little; three steps of Newton's method find it.
        for _ in 0..3 {
            let slope = self.slope(zero_s);
            let most_s = 0.1 * self.half_s();
            let by_s = (self.at(zero_s) / slope).clamp(-most_s, most_s);
            zero_s -= if by_s.is_finite() { by_s } else { 0.0 };
        }
        match zero_s <= time_s {
            true => zero_s + self.half_s(),
            false => zero_s,
        }
    }
}

fn middle(samples: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for (time_s, _) in samples {
        (sum, count) = (sum + time_s, count + 1.0);
    }
    (count > 0.0).then(|| sum / count)
}
