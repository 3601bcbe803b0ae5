//! Least-squares fits of step responses, sampled once a second from the step on.

use super::{FirstOrder, doubt};

/// Least and greatest time constant that a fit tries, s.
const TIME_CONSTANTS_S: [f64; 2] = [3.0, 600.0];
/// Least and greatest delay that a fit tries, s.
const DELAYS_S: [f64; 2] = [0.0, 30.0];
/// Points of the grid along one axis.
const POINTS: i32 = 12;
/// Number of times that a search narrows its grid around the best point.
const ROUNDS: i32 = 8;

/// Step response of two parts after one delay: one settles within minutes, the other rises until the losses balance it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoPart {
    /// Gain of the settling part, K per unit of power.
    pub gain_k: f64,
    /// Time constant of the settling part, s.
    pub time_constant_s: f64,
    /// Delay, s.
    pub delay_s: f64,
    /// First slope of the rising part, K/s per unit of power.
    pub slope_k_per_s: f64,
}

/// Returns the time, s, for which the rising part would have risen at its first slope; `return_per_s`: rate at which
/// the losses take back a rise, 1/s. Without losses this is the time itself.
pub(super) fn risen(after_s: f64, return_per_s: f64) -> f64 {
    let share = return_per_s * after_s;
    match share > 1e-9 {
        true => -(-share).exp_m1() / return_per_s,
        false => after_s,
    }
}

/// Fits both parts to a response, K per unit of power, of a chamber whose losses take back a rise at `return_per_s`,
/// 1/s. Without them the slope of a usual chamber comes out a tenth too small.
pub fn two_part(response: &[f64], return_per_s: f64) -> TwoPart {
    let linear = |time_constant_s: f64, delay_s: f64| {
        let basis = |second: usize| {
            let after = (second as f64 - delay_s).max(0.0);
            [
                1.0 - (-after / time_constant_s).exp(),
                risen(after, return_per_s),
            ]
        };
        solved(response, basis)
    };
    let (time_constant_s, delay_s) = searched(|tau, delay| linear(tau, delay).1);
    let [gain_k, slope_k_per_s] = linear(time_constant_s, delay_s).0;
    TwoPart {
        gain_k,
        time_constant_s,
        delay_s,
        slope_k_per_s,
    }
}

/// Returns the standard uncertainties of a fit of both parts with the same `return_per_s`.
pub fn two_part_doubt(response: &[f64], found: &TwoPart, return_per_s: f64) -> TwoPart {
    let figures = [
        found.gain_k,
        found.time_constant_s,
        found.delay_s,
        found.slope_k_per_s,
    ];
    let model = |it: &[f64; 4], second: f64| {
        let after = (second - it[2]).max(0.0);
        it[0] * (1.0 - (-after / it[1]).exp()) + it[3] * risen(after, return_per_s)
    };
    let [gain_k, time_constant_s, delay_s, slope_k_per_s] =
        doubt::standard(response, &figures, model);
    TwoPart {
        gain_k,
        time_constant_s,
        delay_s,
        slope_k_per_s,
    }
}

/// Returns the standard uncertainties of a fit of one lag and a delay.
pub fn first_order_doubt(response: &[f64], found: &FirstOrder) -> FirstOrder {
    let figures = [found.gain_k, found.time_constant_s, found.delay_s];
    let model =
        |it: &[f64; 3], second: f64| it[0] * (1.0 - (-(second - it[2]).max(0.0) / it[1]).exp());
    let [gain_k, time_constant_s, delay_s] = doubt::standard(response, &figures, model);
    FirstOrder {
        gain_k,
        time_constant_s,
        delay_s,
    }
}

/// Fits one lag and a delay to a response, K per unit of power.
pub fn first_order(response: &[f64]) -> FirstOrder {
    let linear = |time_constant_s: f64, delay_s: f64| {
        let basis = |second: usize| {
            let after = (second as f64 - delay_s).max(0.0);
            [1.0 - (-after / time_constant_s).exp(), 0.0]
        };
        solved(response, basis)
    };
    let (time_constant_s, delay_s) = searched(|tau, delay| linear(tau, delay).1);
    let [gain_k, _] = linear(time_constant_s, delay_s).0;
    FirstOrder {
        gain_k,
        time_constant_s,
        delay_s,
    }
}

/// Returns the factors of two basis functions, and the sum of squares of the residuals; a basis of zeros gets factor 0.
fn solved(response: &[f64], basis: impl Fn(usize) -> [f64; 2]) -> ([f64; 2], f64) {
    let mut normal = [[0.0; 2]; 2];
    let mut right = [0.0; 2];
    for (second, found) in response.iter().enumerate() {
        let [a, b] = basis(second);
        normal[0][0] += a * a;
        normal[0][1] += a * b;
        normal[1][1] += b * b;
        right[0] += a * found;
        right[1] += b * found;
    }
    let determinant = normal[0][0] * normal[1][1] - normal[0][1] * normal[0][1];
    let factors = if determinant > 1e-9 * normal[0][0] * normal[1][1] {
        let first = right[0] * normal[1][1] - right[1] * normal[0][1];
        let second = right[1] * normal[0][0] - right[0] * normal[0][1];
        [first / determinant, second / determinant]
    } else if normal[0][0] > 0.0 {
        [right[0] / normal[0][0], 0.0]
    } else {
        [0.0; 2]
    };
    let residual = |(second, found): (usize, &f64)| {
        let [a, b] = basis(second);
        (found - factors[0] * a - factors[1] * b).powi(2)
    };
    (factors, response.iter().enumerate().map(residual).sum())
}

/// Searches time constant and delay, s, of the least cost, by a grid that narrows around its best point.
fn searched(cost: impl Fn(f64, f64) -> f64) -> (f64, f64) {
    let [mut tau, mut delay] = [TIME_CONSTANTS_S.map(f64::ln), DELAYS_S];
    let mut best = (f64::INFINITY, TIME_CONSTANTS_S[0], DELAYS_S[0]);
    for _ in 0..ROUNDS {
        let along = |ends: [f64; 2], point: i32| {
            ends[0] + (ends[1] - ends[0]) * f64::from(point) / f64::from(POINTS)
        };
        for i in 0..=POINTS {
            for j in 0..=POINTS {
                let (tau_s, delay_s) = (along(tau, i).exp(), along(delay, j));
                let found = cost(tau_s, delay_s);
                if found < best.0 {
                    best = (found, tau_s, delay_s);
                }
            }
        }
        tau = narrowed(tau, best.1.ln(), TIME_CONSTANTS_S.map(f64::ln));
        delay = narrowed(delay, best.2, DELAYS_S);
    }
    (best.1, best.2)
}

/// Returns an interval of half the length of `ends`, centred on `around` and cut off at the outer ends.
fn narrowed(ends: [f64; 2], around: f64, outer: [f64; 2]) -> [f64; 2] {
    let quarter = (ends[1] - ends[0]) / 4.0;
    [
        (around - quarter).max(outer[0]),
        (around + quarter).min(outer[1]),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_made_up_response_returns_its_figures() {
        for return_per_s in [0.0, 6e-4] {
            let made = |second: i32| {
                let after = (f64::from(second) - 6.7).max(0.0);
                let risen_s = match return_per_s > 0.0 {
                    true => (1.0 - (-return_per_s * after).exp()) / return_per_s,
                    false => after,
                };
                30.6 * (1.0 - (-after / 21.9).exp()) + 0.264 * risen_s
            };
            let response: Vec<f64> = (0..420).map(made).collect();
            let found = two_part(&response, return_per_s);
            assert!((found.gain_k - 30.6).abs() < 0.3, "{found:?}");
            assert!((found.time_constant_s - 21.9).abs() < 0.5, "{found:?}");
            assert!((found.delay_s - 6.7).abs() < 0.2, "{found:?}");
            assert!((found.slope_k_per_s - 0.264).abs() < 0.003, "{found:?}");
        }
    }

    #[test]
    fn one_lag_returns_its_figures() {
        let made = |second: i32| 65.0 * (1.0 - (-(f64::from(second) - 4.5).max(0.0) / 52.0).exp());
        let response: Vec<f64> = (0..120).map(made).collect();
        let found = first_order(&response);
        assert!((found.gain_k - 65.0).abs() < 1.0, "{found:?}");
        assert!((found.time_constant_s - 52.0).abs() < 1.5, "{found:?}");
        assert!((found.delay_s - 4.5).abs() < 0.2, "{found:?}");
    }
}
