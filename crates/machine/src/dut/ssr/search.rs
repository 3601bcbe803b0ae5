//! Search of a threshold by halved steps.

/// Direction in which the control voltage passes the threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Upwards: the output begins to conduct.
    Rising,
    /// Downwards: the output ceases to conduct.
    Falling,
}

/// Interval of control voltages, V, that holds a threshold: the output blocks at `low` and conducts at `high`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// Lower end, V.
    pub low_v: f64,
    /// Upper end, V.
    pub high_v: f64,
    /// Steps done.
    pub done: u32,
}

impl Search {
    /// Begins with the interval from `low_v` to `high_v`.
    pub fn between(low_v: f64, high_v: f64) -> Self {
        Self {
            low_v,
            high_v,
            done: 0,
        }
    }

    /// Returns the voltage to try next, which is also the best estimate of the threshold, V.
    pub fn middle_v(&self) -> f64 {
        f64::midpoint(self.low_v, self.high_v)
    }

    /// Returns the width of the interval, V.
    pub fn width_v(&self) -> f64 {
        self.high_v - self.low_v
    }

    /// Halves the interval: the output conducts at [`Self::middle_v`], or it does not.
    pub fn halve(&mut self, conducts: bool) {
        let middle_v = self.middle_v();
        match conducts {
            true => self.high_v = middle_v,
            false => self.low_v = middle_v,
        }
        self.done += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halved_steps_close_in_on_a_threshold() {
        for threshold_v in [1.0001, 1.9, 2.5, 3.4999] {
            let mut search = Search::between(1.0, 3.5);
            for _ in 0..8 {
                search.halve(search.middle_v() >= threshold_v);
            }
            assert_eq!(search.done, 8);
            assert!((search.width_v() - 2.5 / 256.0).abs() < 1e-12);
            assert!((search.low_v..=search.high_v).contains(&threshold_v));
        }
    }
}
