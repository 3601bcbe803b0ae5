//! Fits an exponential to a value that changes while a current warms the part, beginning with the cold part. Each given
//! value is a mean over an interval; the intervals are equal and leave no gaps. The time constant is that of the
//! junction.

/// Least ratio that the fit tries. The ratio is the distance of a mean from the final value, divided by that of the
/// mean before.
const LEAST: f64 = 0.02;
/// Greatest ratio that the fit tries.
const MOST: f64 = 0.9;
/// Number of ratios that the fit tries.
const TRIED: u32 = 45;
/// Fewest values of a fit.
const FEWEST: usize = 5;

/// Returns the best course through the values; none for fewer than five values.
pub fn course(values: &[f64]) -> Option<Course> {
    if values.len() < FEWEST {
        return None;
    }
    let tried = (0..TRIED).map(|it| LEAST + (MOST - LEAST) * f64::from(it) / f64::from(TRIED - 1));
    let best = tried.map(|ratio| fitted(values, ratio));
    let best = best.min_by(|one, other| one.squares.total_cmp(&other.squares))?;
    best.at(0.0).is_finite().then_some(best)
}

/// A value that approaches its final value exponentially.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course {
    end: f64,
    /// Distance from the final value at the begin of the first interval.
    rest: f64,
    /// Factor by which the distance from the final value changes in each interval.
    ratio: f64,
    squares: f64,
    count: usize,
}

impl Course {
    /// Returns the standard deviation of the values around the course.
    pub fn residual(&self) -> f64 {
        // The fit has three parameters.
        (self.squares / (self.count - 3) as f64).sqrt()
    }

    /// Returns the value after this number of intervals; 0 is the cold part.
    pub fn at(&self, times: f64) -> f64 {
        self.end + self.rest * self.ratio.powf(times)
    }

    /// Returns the share of a warming that is left after its end: the mean over an interval that begins `after`
    /// intervals later.
    pub fn left(&self, after: f64) -> f64 {
        self.ratio.powf(after) * (1.0 - self.ratio) / -self.ratio.ln()
    }
}

/// Fits final value and first distance by least squares, for a distance that changes by the factor `ratio` in each
/// interval.
fn fitted(values: &[f64], ratio: f64) -> Course {
    let count = values.len() as f64;
    // The mean of the exponential over the first interval, as a share of its value at the begin.
    let first = (1.0 - ratio) / -ratio.ln();
    let shares: Vec<f64> = (0..values.len())
        .map(|it| first * ratio.powi(it as i32))
        .collect();
    let mean = |all: &[f64]| all.iter().sum::<f64>() / count;
    let (middle, share) = (mean(values), mean(&shares));
    let (mut mixed, mut own) = (0.0, 0.0);
    for (value, it) in values.iter().zip(&shares) {
        mixed += (value - middle) * (it - share);
        own += (it - share).powi(2);
    }
    let rest = mixed / own;
    let end = middle - rest * share;
    let off = values
        .iter()
        .zip(&shares)
        .map(|(value, it)| value - end - rest * it);
    Course {
        end,
        rest,
        ratio,
        squares: off.map(|it| it * it).sum(),
        count: values.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns means over 20 ms of a value that goes from 1.2 by -5e-3 with this time constant, ms.
    fn warming(tau_ms: f64) -> Vec<f64> {
        let left = |at_ms: f64| (-at_ms / tau_ms).exp();
        let mean = |it: u32| {
            let from_ms = 20.0 * f64::from(it);
            let share = tau_ms / 20.0 * (left(from_ms) - left(from_ms + 20.0));
            1.2 - 5e-3 * (1.0 - share)
        };
        (0..10).map(mean).collect()
    }

    #[test]
    fn the_cold_value_is_found_for_any_time_constant() {
        for tau_ms in [6.0, 10.0, 20.0, 40.0, 100.0] {
            let found = course(&warming(tau_ms)).expect("ten values");
            for at_ms in [0.0, 10.0, 200.0] {
                let truth = 1.2 - 5e-3 * (1.0 - f64::exp(-at_ms / tau_ms));
                let error = found.at(at_ms / 20.0) - truth;
                assert!(error.abs() < 2e-4, "{tau_ms} ms, at {at_ms} ms: {error}");
            }
        }
    }

    #[test]
    fn a_constant_value_stays_and_few_are_refused() {
        let found = course(&[1.5; 8]).expect("eight values");
        assert!((found.at(0.0) - 1.5).abs() < 1e-12);
        assert_eq!(course(&[1.5; 4]), None);
    }
}
