//! Estimates the switching temperatures of one part together with its lag. The lag of the lot, and the spread of lags
//! within it, say what to expect of the lag.

use super::fit::{Mean, fitted};
use super::lot::LotLag;
use super::{Record, Switching};

/// Scatter of switchings, and delay of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Scatter of a switching temperature from cycle to cycle, one standard deviation, K.
    pub scatter_k: f64,
    /// Lag and delay of the reference sensor, s. A [`LotLag`] is the lag of the parts minus this lag; the spread of
    /// lags is a share of the sum of both.
    pub sensor_lag_s: f64,
}

impl Noise {
    /// Returns the logarithm of the lag behind the air, s, from the lag behind the reference sensor, s.
    pub(super) fn ln_of(&self, lag_s: f64) -> f64 {
        (lag_s + self.sensor_lag_s).ln()
    }

    /// Returns the lag behind the reference sensor, s, from the logarithm of that behind the air.
    pub(super) fn lag_s(&self, ln: f64) -> f64 {
        ln.exp() - self.sensor_lag_s
    }

    /// Returns the weight of an event whose instant leaves this uncertainty of its temperature, K.
    pub(super) fn weight(&self, instant_k: f64) -> f64 {
        self.scatter_k.hypot(instant_k).powi(-2)
    }
}

/// A temperature with its standard uncertainty from the fit, without the terms of chain and map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// Temperature, C, or difference, K.
    pub value: f64,
    /// Standard uncertainty of the fit, K.
    pub u_k: f64,
}

/// Switching temperatures of one part, from all its events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Operate temperature; `None` for a part that never operated.
    pub operate: Option<Value>,
    /// Reset temperature; `None` for a part that never reset.
    pub reset: Option<Value>,
    /// Operate less reset temperature; `None` without both.
    pub differential: Option<Value>,
    /// Lag of the part behind the reference sensor, s.
    pub lag_s: f64,
    /// Wider of the ranges of operate and reset temperature over the passes, K, at the lag of the part; `None` when the
    /// part switched only once each way.
    pub range_k: Option<f64>,
}

/// Estimates a part; `None` for a part without event, or with one that the record does not cover.
pub fn estimate(
    record: &Record,
    part: &Switching,
    lag: &LotLag,
    noise: &Noise,
) -> Option<Estimate> {
    let expected = lag.expected(noise);
    let events = fitted(record, part, &expected, noise)?;
    let found = events.solved(&expected, noise);
    // Mean and variance of a lag whose logarithm is normal, in units of the lag: a lag may be far above its median, not below.
    let ratio = (found.variance / 2.0).exp();
    let (shift, variance_of_lag) = (ratio - 1.0, ratio * ratio * found.variance.exp_m1());
    let value = |value: f64, variance: f64, gradient_k: f64| Value {
        value: value + gradient_k * shift,
        u_k: (variance + gradient_k * gradient_k * variance_of_lag).sqrt(),
    };
    let [operate, reset] = found.means;
    let both = operate.zip(reset);
    let one = |it: Mean| value(it.celsius, it.variance, it.gradient_k);
    Some(Estimate {
        operate: operate.map(one),
        reset: reset.map(one),
        differential: both.map(|(a, b)| {
            let variance = a.variance + b.variance;
            value(a.celsius - b.celsius, variance, a.gradient_k - b.gradient_k)
        }),
        lag_s: noise.lag_s(found.ln),
        range_k: events.range_k(),
    })
}
