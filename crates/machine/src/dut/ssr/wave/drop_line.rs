//! Fits a straight line to the drop of a conducting output over its current, one for each polarity: `v = v0 + r |i|`.

use super::least_squares::Sums;

/// Straight line of one polarity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DropLine {
    /// Drop without current, V.
    pub threshold_v: f64,
    /// Rise of the drop with the current, ohm.
    pub ohm: f64,
    /// Mean of the fitted currents, A.
    middle_a: f64,
    /// Standard uncertainty from noise of the drop at that mean, V, and of `ohm`.
    u: (f64, f64),
}

impl DropLine {
    /// Returns the drop at a current, V.
    pub fn at(&self, ampere: f64) -> f64 {
        self.threshold_v + self.ohm * ampere
    }

    /// Returns the standard uncertainty of the drop at a current from noise, V.
    pub fn u_at(&self, ampere: f64) -> f64 {
        self.u.0.hypot(self.u.1 * (ampere - self.middle_a))
    }

    /// Returns the rms of the drop for a sinusoidal current with this amplitude, V: the integral of `(v0 + r |i|)^2` in
    /// closed form.
    pub fn rms(&self, peak_a: f64) -> f64 {
        let (v0, r) = (self.threshold_v, self.ohm);
        let mixed = 2.0 * v0 * r * peak_a * 2.0 / std::f64::consts::PI;
        (v0 * v0 + mixed + r * r * peak_a * peak_a / 2.0)
            .max(0.0)
            .sqrt()
    }
}

/// Fits drops (current in A, drop in V) of one polarity, both positive; takes only currents above `least_a`.
pub fn fit(samples: impl Iterator<Item = (f64, f64)>, least_a: f64) -> Option<DropLine> {
    let mut sums = Sums::<2>::default();
    let mut sum_a = 0.0;
    for (ampere, volts) in samples.filter(|(ampere, _)| *ampere > least_a) {
        sums.add([1.0, ampere], volts);
        sum_a += ampere;
    }
    let (solution, count) = (sums.solve()?, sums.count() as f64);
    Some(DropLine {
        threshold_v: solution.of[0],
        ohm: solution.of[1],
        middle_a: sum_a / count,
        u: (solution.residual / count.sqrt(), solution.u[1]),
    })
}
