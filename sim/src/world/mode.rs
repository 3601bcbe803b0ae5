//! The unstable mode of an armature under a coil voltage that stands still for a while.
//!
//! Flux and armature follow the voltage `u` through two lags; what arrives, `v`, drives the mode:
//!
//! ```text
//! v1' = (u - v1) / lag1        v' = (v1 - v) / lag2        z' = z / growth + gain (v - v_th) / v_th
//! ```
//!
//! Everything is a sum of exponentials, so any instant is reached in closed form. A constant
//! voltage gives `t = a + growth ln(1 / (V - V_th))`, a ramp the lag `r (a - growth ln r)`: the
//! laws of a threshold that sits at a fold. The sign of `gain` is negative for a release.

/// Constants of one direction, in milliseconds.
#[derive(Debug, Clone, Copy)]
pub struct Laws {
    /// Flux behind voltage.
    pub coil_lag: f64,
    /// Armature behind flux.
    pub armature_lag: f64,
    /// Time in which the mode grows by e.
    pub growth: f64,
    /// Drive per relative excess over the threshold, 1/ms; negative for a release.
    pub gain: f64,
}

/// What has arrived of the voltage at an instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Lagged {
    /// Behind the first lag, volts.
    pub flux: f64,
    /// Behind both, volts.
    pub armature: f64,
}

/// A stretch of constant voltage from a known state.
#[derive(Debug, Clone, Copy)]
pub struct Stretch {
    laws: Laws,
    u: f64,
    a: f64,
    b: f64,
    amp_a: f64,
    amp_b: f64,
}

impl Stretch {
    /// Starts at `state` under voltage `u`.
    pub fn new(laws: Laws, state: Lagged, u: f64) -> Self {
        let (a, b) = (1.0 / laws.coil_lag, 1.0 / laws.armature_lag);
        let amp_a = (state.flux - u) * b / (b - a);
        Self {
            laws,
            u,
            a,
            b,
            amp_a,
            amp_b: state.armature - u - amp_a,
        }
    }

    /// State after `dt` milliseconds.
    pub fn at(&self, dt: f64) -> Lagged {
        let slow = self.amp_a * (-self.a * dt).exp();
        let fast = self.amp_b * (-self.b * dt).exp();
        let flux = self.u + slow * (self.b - self.a) / self.b;
        Lagged {
            flux,
            armature: self.u + slow + fast,
        }
    }

    /// Excess over the threshold in the direction of the mode, volts.
    pub fn excess(&self, dt: f64, threshold: f64) -> f64 {
        (self.at(dt).armature - threshold) * self.laws.gain.signum()
    }

    /// The mode after `dt`, from `z0` at the start of the stretch.
    pub fn mode(&self, dt: f64, z0: f64, threshold: f64) -> f64 {
        let s = 1.0 / self.laws.growth;
        let k = self.laws.gain / threshold;
        let still = -k * (self.u - threshold) / s;
        let (slow, fast) = (
            -k * self.amp_a / (self.a + s),
            -k * self.amp_b / (self.b + s),
        );
        (z0 - still - slow - fast) * (s * dt).exp()
            + still
            + slow * (-self.a * dt).exp()
            + fast * (-self.b * dt).exp()
    }

    /// The stretch that begins `dt` later.
    pub fn later(&self, dt: f64) -> Self {
        Self::new(self.laws, self.at(dt), self.u)
    }
}

/// Where `f` changes from below zero to zero or more between `lo` and `hi`, to 1 ns (milliseconds).
pub fn crossing(mut lo: f64, mut hi: f64, f: impl Fn(f64) -> f64) -> f64 {
    while hi - lo > 1e-6 {
        let middle = 0.5 * (lo + hi);
        if f(middle) < 0.0 {
            lo = middle
        } else {
            hi = middle
        }
    }
    hi
}

/// Time from a step `from` to `to` until the mode is complete, ms; `None` if it never starts.
pub fn step_time(laws: Laws, from: f64, to: f64, threshold: f64) -> Option<f64> {
    if (to - threshold) * laws.gain <= 0.0 {
        return None;
    }
    let stretch = Stretch::new(
        laws,
        Lagged {
            flux: from,
            armature: from,
        },
        to,
    );
    let start = crossing(0.0, 200.0, |t| stretch.excess(t, threshold));
    let grown = stretch.later(start);
    Some(start + crossing(0.0, 200.0, |t| grown.mode(t, 0.0, threshold) - 1.0))
}
