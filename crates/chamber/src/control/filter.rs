//! Building blocks of controllers: filtered slope, delay of whole seconds.

use std::collections::VecDeque;

/// Slope of a signal that is sampled once a second, smoothed by a first-order low-pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Slope {
    time_constant_s: f64,
    last: Option<f64>,
    per_s: f64,
}

impl Slope {
    /// Makes a slope with the time constant of its low-pass, s.
    pub const fn smoothed_over(time_constant_s: f64) -> Self {
        Self {
            time_constant_s,
            last: None,
            per_s: 0.0,
        }
    }

    /// Takes the next sample and returns the slope per second; zero for the first sample.
    pub fn step(&mut self, sample: f64) -> f64 {
        if let Some(last) = self.last.replace(sample) {
            self.per_s += (sample - last - self.per_s) / (self.time_constant_s + 1.0);
        }
        self.per_s
    }
}

/// A signal as it was some whole seconds ago.
#[derive(Debug, Clone, PartialEq)]
pub struct Delay {
    seconds: usize,
    past: VecDeque<f64>,
}

impl Delay {
    /// Makes a delay, rounded to whole seconds.
    pub fn of(delay_s: f64) -> Self {
        Self {
            seconds: delay_s.max(0.0).round() as usize,
            past: VecDeque::new(),
        }
    }

    /// Takes the sample of this second and returns the delayed one; the oldest one while no sample is old enough.
    pub fn step(&mut self, sample: f64) -> f64 {
        self.past.push_back(sample);
        if self.past.len() > self.seconds + 1 {
            self.past.pop_front();
        }
        self.past.front().copied().unwrap_or(sample)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_settles_at_the_rate_of_a_ramp() {
        let mut slope = Slope::smoothed_over(4.0);
        let found = (0..60)
            .map(|second| slope.step(f64::from(second) * 0.5))
            .last();
        assert!((found.unwrap_or(0.0) - 0.5).abs() < 1e-4);
    }

    #[test]
    fn a_delay_returns_the_sample_of_seven_seconds_ago() {
        let mut delay = Delay::of(6.7);
        let found: Vec<f64> = (0..10)
            .map(|second| delay.step(f64::from(second)))
            .collect();
        assert_eq!(found[..8], [0.0; 8]);
        assert_eq!(found[9], 2.0);
    }
}
