//! Estimates the switching temperatures of one part, together with the deviation of its lag from the lag of the lot.
//!
//! Each event gives an equation `F = T + g dtau + e`: `F` is the filtered record at the event, `g` its change with the
//! lag (sign reversed), `e` the scatter of the switching and the uncertain instant. The spread of lags within a lot is
//! the prior of `dtau`. The solution has three unknowns, T_operate, T_reset and dtau, with their covariance.

use super::lot::LotLag;
use super::matrix::{Matrix, inverse, product};
use super::{Filtered, Record, Switching, Transition};
use crate::statistics::median;

/// Standard deviation of lags within a lot, as a share of the lag.
pub const LAG_SPREAD: f64 = 0.15;
/// Standard uncertainty of every instant, s: the air reaches the sockets at unequal times, a lag has a shape, polls
/// take time.
const INSTANT_S: f64 = 0.5;
/// Step of the lag for the derivative `g`, as a share of the lag.
const STEP: f64 = 0.02;
/// Weight of the prior of a temperature, 1/K²: so small that it changes no result, yet large enough to keep the
/// equations of a part without event solvable.
const NOTHING: f64 = 1e-9;

/// Scatter of switchings, and delay of the sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Scatter of a switching temperature from cycle to cycle, one standard deviation, K.
    pub scatter_k: f64,
    /// Lag and delay of the reference sensor, s. A [`LotLag`] is the lag of the parts minus this lag; the spread of
    /// lags is a share of the sum of both.
    pub sensor_lag_s: f64,
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
    /// Lag of the part, s.
    pub lag_s: f64,
    /// Wider of the ranges of operate and reset temperature over the passes, K; `None` when the part switched only once
    /// each way.
    pub range_k: Option<f64>,
    /// Weighted sum of squares of the residuals (chi squared).
    pub misfit: f64,
    /// Degrees of freedom: events minus estimated temperatures.
    pub freedom: usize,
}

/// Largest scatter that [`lot_scatter`] finds, in multiples of the assumed one.
const MOST: f64 = 5.0;

/// Returns the scatter of switchings, K, that explains how much the passes of the parts of a lot disagree: at least the
/// assumed one, at most five times that. The median of the parts decides, so that a few defective ones do not count. A
/// part that switched only once each way has no vote.
pub fn lot_scatter(record: &Record, parts: &[Switching], lag: &LotLag, assumed: &Noise) -> f64 {
    let mut noise = *assumed;
    for _ in 0..8 {
        let all = parts
            .iter()
            .filter_map(|part| estimate(record, part, lag, &noise));
        let Some(ratio) = misfit(all) else { break };
        let most_k = MOST * assumed.scatter_k;
        noise.scatter_k = (noise.scatter_k * ratio.sqrt()).clamp(assumed.scatter_k, most_k);
    }
    noise.scatter_k
}

/// Returns the median ratio of a misfit to the one that the noise explains; `None` without a part that has a degree of
/// freedom.
fn misfit(parts: impl Iterator<Item = Estimate>) -> Option<f64> {
    // Median of chi squared by the approximation of Wilson and Hilferty.
    let middle = |freedom: f64| freedom * (1.0 - 2.0 / (9.0 * freedom)).powi(3);
    let told = parts.filter(|it| it.freedom > 0);
    let ratios: Vec<f64> = told
        .map(|it| it.misfit / middle(it.freedom as f64))
        .collect();
    median(&ratios)
}

/// Sums of the normal equations.
#[derive(Default)]
struct Sums {
    information: Matrix,
    right: [f64; 3],
    squares: f64,
    events: usize,
}

impl Sums {
    /// Starts with the prior: the spread of lags within the lot.
    fn prior(lag: &LotLag, noise: &Noise) -> Self {
        let mut sums = Self::default();
        let spread_s = LAG_SPREAD * (lag.seconds + noise.sensor_lag_s);
        let spread_s = spread_s.hypot(lag.u_s);
        sums.add([0.0, 0.0, 1.0], 0.0, spread_s.powi(-2));
        sums.add([1.0, 0.0, 0.0], 0.0, NOTHING);
        sums.add([0.0, 1.0, 0.0], 0.0, NOTHING);
        sums
    }

    /// Adds an event of one temperature: 0 is operate, 1 is reset.
    fn take(&mut self, which: usize, event: &Event, origin_c: f64, noise: &Noise) {
        let mut row = [0.0, 0.0, -event.gradient];
        row[which] = 1.0;
        let u_k = noise.scatter_k.hypot(event.rate_k_per_s * INSTANT_S);
        self.add(row, event.celsius - origin_c, u_k.powi(-2));
        self.events += 1;
    }

    /// Returns the weighted sum of squares of the residuals of a solution.
    fn misfit(&self, solution: &[f64; 3]) -> f64 {
        let explained: f64 = self.right.iter().zip(solution).map(|(a, b)| a * b).sum();
        (self.squares - explained).max(0.0)
    }

    fn add(&mut self, row: [f64; 3], found: f64, weight: f64) {
        self.squares += weight * found * found;
        for i in 0..3 {
            self.right[i] += weight * row[i] * found;
            for j in 0..3 {
                self.information[i][j] += weight * row[i] * row[j];
            }
        }
    }
}

/// Estimates a part; `None` for a part without event, or with one that the record does not cover.
pub fn estimate(
    record: &Record,
    part: &Switching,
    lag: &LotLag,
    noise: &Noise,
) -> Option<Estimate> {
    let Gathered {
        sums,
        origin_c,
        range_k,
    } = gathered(record, part, lag, noise)?;
    let covariance = inverse(&sums.information)?;
    let [operate, reset, departure] = product(&covariance, &sums.right);
    let [has_operated, has_reset] = [&part.operate, &part.reset].map(|it| !it.is_empty());
    let value = |known: bool, value: f64, variance: f64| {
        let u_k = variance.sqrt();
        known.then_some(Value { value, u_k })
    };
    let variance = covariance[0][0] + covariance[1][1] - 2.0 * covariance[0][1];
    Some(Estimate {
        operate: value(has_operated, origin_c + operate, covariance[0][0]),
        reset: value(has_reset, origin_c + reset, covariance[1][1]),
        differential: value(has_operated && has_reset, operate - reset, variance),
        lag_s: lag.seconds + departure,
        range_k,
        misfit: sums.misfit(&[operate, reset, departure]),
        freedom: sums.events - usize::from(has_operated) - usize::from(has_reset),
    })
}

/// The events of a part as normal equations.
struct Gathered {
    sums: Sums,
    /// Temperature that the equations take as zero, C: differences keep more digits.
    origin_c: f64,
    range_k: Option<f64>,
}

fn gathered(record: &Record, part: &Switching, lag: &LotLag, noise: &Noise) -> Option<Gathered> {
    let steps = [1.0 - STEP, 1.0, 1.0 + STEP].map(|it| record.filtered(it * lag.seconds));
    let first_s = part.operate.iter().chain(&part.reset).next()?.first_s;
    let origin_c = steps[1].at(first_s)?.celsius;
    let mut sums = Sums::prior(lag, noise);
    let mut range_k: Option<f64> = None;
    for (which, all) in [&part.operate, &part.reset].into_iter().enumerate() {
        let mut temperatures = Vec::with_capacity(all.len());
        for transition in all {
            let event = Event::at(&steps, transition, lag)?;
            sums.take(which, &event, origin_c, noise);
            temperatures.push(event.celsius);
        }
        range_k = range(&temperatures).map_or(range_k, |it| Some(range_k.unwrap_or(0.0).max(it)));
    }
    Some(Gathered {
        sums,
        origin_c,
        range_k,
    })
}

/// The filtered record at an event.
struct Event {
    celsius: f64,
    rate_k_per_s: f64,
    /// Change of the temperature with the lag, K/s.
    gradient: f64,
}

impl Event {
    fn at(steps: &[Filtered<'_>; 3], transition: &Transition, lag: &LotLag) -> Option<Self> {
        let [below, at, above] = steps.each_ref().map(|it| it.at(transition.first_s));
        let (below, at, above) = (below?, at?, above?);
        Some(Self {
            celsius: at.celsius,
            rate_k_per_s: at.rate_k_per_s,
            gradient: (above.celsius - below.celsius) / (2.0 * STEP * lag.seconds),
        })
    }
}

/// Returns highest minus lowest value; `None` for fewer than two.
fn range(all: &[f64]) -> Option<f64> {
    let high = all.iter().copied().fold(f64::MIN, f64::max);
    let low = all.iter().copied().fold(f64::MAX, f64::min);
    (all.len() >= 2).then_some(high - low)
}
