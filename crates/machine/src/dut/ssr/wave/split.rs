//! Resistive and capacitive part of a current, from the fundamentals of voltage and current.

use super::mains::Mains;

/// Admittance of an output from one record, siemens.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Admittance {
    /// Current in phase with the voltage, per volt.
    pub conductance: f64,
    /// Current a quarter of a period ahead of the voltage, per volt.
    pub susceptance: f64,
}

impl Admittance {
    /// Divides a current (sine and cosine) by a voltage. Both fits have the same time zero; the frequency is that of
    /// the voltage.
    pub fn of(voltage: &Mains, current: [f64; 2]) -> Self {
        let [vs, vc] = voltage.phasor();
        let square = vs * vs + vc * vc;
        let [is, ic] = current;
        Self {
            conductance: (is * vs + ic * vc) / square,
            susceptance: (ic * vs - is * vc) / square,
        }
    }

    /// Returns the quotient of two admittances; dividing by a ratio corrects gain and delay between two channels.
    pub fn over(self, by: Self) -> Self {
        let square = by.conductance.powi(2) + by.susceptance.powi(2);
        let (g, b) = (self.conductance, self.susceptance);
        Self {
            conductance: (g * by.conductance + b * by.susceptance) / square,
            susceptance: (b * by.conductance - g * by.susceptance) / square,
        }
    }

    /// Returns what remains of this admittance without `other`, which lies in parallel.
    pub fn less(self, other: Self) -> Self {
        Self {
            conductance: self.conductance - other.conductance,
            susceptance: self.susceptance - other.susceptance,
        }
    }

    /// Returns the susceptance of the same capacitance at another frequency.
    pub fn at_hz(self, from_hz: f64, to_hz: f64) -> Self {
        Self {
            susceptance: self.susceptance * to_hz / from_hz,
            ..self
        }
    }

    /// Returns the magnitude, S.
    pub fn size(self) -> f64 {
        self.conductance.hypot(self.susceptance)
    }
}

/// Fits the fundamental of samples (time in s, value) at a known frequency, with offset, third and fifth harmonic;
/// returns sine and cosine, their standard uncertainty and the mean.
pub fn phasor(samples: impl Iterator<Item = (f64, f64)>, hz: f64) -> Option<Phasor> {
    let mut sums = super::least_squares::Sums::<7>::default();
    for (time_s, value) in samples {
        let (s1, c1) = (std::f64::consts::TAU * hz * time_s).sin_cos();
        let (s2, c2) = (2.0 * s1 * c1, c1 * c1 - s1 * s1);
        let (s3, c3) = (s2 * c1 + c2 * s1, c2 * c1 - s2 * s1);
        let (s5, c5) = (s3 * c2 + c3 * s2, c3 * c2 - s3 * s2);
        sums.add([1.0, s1, c1, s3, c3, s5, c5], value);
    }
    let solution = sums.solve()?;
    Some(Phasor {
        mean: solution.of[0],
        of: [solution.of[1], solution.of[2]],
        u: solution.u[1].max(solution.u[2]),
        residual: solution.residual,
    })
}

/// Fitted fundamental at a known frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phasor {
    /// Mean of the samples.
    pub mean: f64,
    /// Sine and cosine.
    pub of: [f64; 2],
    /// Standard uncertainty of sine or cosine from noise.
    pub u: f64,
    /// Standard deviation of the samples around the fit.
    pub residual: f64,
}
