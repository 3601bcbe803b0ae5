//! Slope over a sliding minute, for tests whose standard limits the rate.

use super::lasting::Recent;

/// Length of the window, s.
const WINDOW_S: usize = 60;

/// Least-squares slope of a sensor over a sliding minute, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct SlidingSlope {
    recent: Recent,
}

impl Default for SlidingSlope {
    fn default() -> Self {
        Self {
            recent: Recent::of(WINDOW_S),
        }
    }
}

impl SlidingSlope {
    /// Takes a reading, C, and returns the slope of the last minute, K/min; `None` in the first minute, and in the
    /// minute after a reading that is not finite.
    pub fn step(&mut self, reading_c: f64) -> Option<f64> {
        if !reading_c.is_finite() {
            self.recent.clear();
            return None;
        }
        self.recent.push(reading_c);
        self.recent.slope().map(|it| it * 60.0)
    }
}
