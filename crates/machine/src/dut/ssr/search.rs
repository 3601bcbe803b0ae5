//! Search of a threshold of the control voltage, from an interval that holds it to a narrow one.
//!
//! An AC part takes staircases ([`super::wave::staircase`]), which divide the interval into many levels at once. For a DC
//! part, without expectation each step halves the interval. With one, the first step tries the expected voltage and the next
//! ones go from there towards the threshold, each twice as far, until both ends have been tried; then steps halve.

/// Direction in which the control voltage passes the threshold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Upwards: the output begins to conduct.
    Rising,
    /// Downwards: the output ceases to conduct.
    Falling,
}

/// Threshold expected from earlier parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expected {
    /// Expected voltage, V.
    pub at_v: f64,
    /// Distance of the second voltage to try from the first one, V, above 0.
    pub reach_v: f64,
}

/// Interval of control voltages, V, that holds a threshold: the output blocks at `low_v` and conducts at `high_v`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// Lower end, V.
    pub low_v: f64,
    /// Upper end, V.
    pub high_v: f64,
    /// Number of voltages tried.
    pub tried: u32,
    expected: Option<Expected>,
    /// True when the output conducted at the last voltage; `None` before the first one.
    conducted: Option<bool>,
    /// True once the lower and the upper end are voltages that this search has tried.
    tried_ends: [bool; 2],
}

impl Search {
    /// Begins with the interval from `low_v` to `high_v`.
    pub fn between(low_v: f64, high_v: f64, expected: Option<Expected>) -> Self {
        Self {
            low_v,
            high_v,
            tried: 0,
            expected,
            conducted: None,
            tried_ends: [false; 2],
        }
    }

    /// Returns the middle of the interval, the best estimate of the threshold, V.
    pub fn middle_v(&self) -> f64 {
        f64::midpoint(self.low_v, self.high_v)
    }

    /// Returns the width of the interval, V.
    pub fn width_v(&self) -> f64 {
        self.high_v - self.low_v
    }

    /// Returns the voltage to try next, V.
    pub fn next_v(&self) -> f64 {
        let aim_v = self.expected.and_then(|it| match self.tried_ends {
            [false, false] => Some(it.at_v),
            [true, false] => Some(self.low_v + it.reach_v),
            [false, true] => Some(self.high_v - it.reach_v),
            [true, true] => None,
        });
        let inside = |volts: &f64| self.low_v < *volts && *volts < self.high_v;
        aim_v.filter(inside).unwrap_or_else(|| self.middle_v())
    }

    /// Narrows the interval: the output conducts at [`Self::next_v`], or it does not.
    pub fn narrow(&mut self, conducts: bool) {
        let volts = self.next_v();
        if let Some(expected) = &mut self.expected
            && self.tried > 0
        {
            expected.reach_v *= 2.0;
        }
        match conducts {
            true => (self.high_v, self.tried_ends[1]) = (volts, true),
            false => (self.low_v, self.tried_ends[0]) = (volts, true),
        }
        self.tried += 1;
        self.conducted = Some(conducts);
    }

    /// Returns the voltages between which a staircase looks for the threshold: around the expected one at first, then the
    /// whole interval.
    pub fn window(&self) -> (f64, f64) {
        let expected = self.expected.filter(|_| self.tried == 0);
        let around = expected.map(|it| (it.at_v - it.reach_v, it.at_v + it.reach_v));
        let (low_v, high_v) = around.unwrap_or((self.low_v, self.high_v));
        let window = (low_v.max(self.low_v), high_v.min(self.high_v));
        match window.0 < window.1 {
            true => window,
            false => (self.low_v, self.high_v),
        }
    }

    /// Narrows the interval to levels of a staircase: the output blocks at `low_v` and conducts at `high_v`.
    pub fn narrow_to(&mut self, low_v: Option<f64>, high_v: Option<f64>) {
        self.low_v = low_v.map_or(self.low_v, |it| it.max(self.low_v));
        self.high_v = high_v.map_or(self.high_v, |it| it.min(self.high_v));
        self.tried += 1;
    }

    /// Returns true when the last step has left the output as each step must find it: blocked for a rising search,
    /// conducting for a falling one.
    pub fn is_ready(&self, direction: Direction) -> bool {
        match direction {
            Direction::Rising => self.conducted == Some(false),
            Direction::Falling => self.conducted == Some(true),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Searches until the interval is at most 20 mV wide; returns it.
    fn found(threshold_v: f64, expected: Option<Expected>) -> Search {
        let mut search = Search::between(1.0, 3.5, expected);
        while search.width_v() > 0.02 {
            search.narrow(search.next_v() >= threshold_v);
            assert!(search.tried < 20, "{search:?}");
        }
        assert!(
            (search.low_v..=search.high_v).contains(&threshold_v),
            "{search:?}"
        );
        search
    }

    #[test]
    fn halved_steps_close_in_on_a_threshold() {
        for threshold_v in [1.0001, 1.9, 2.5, 3.4999] {
            let search = found(threshold_v, None);
            assert_eq!(search.tried, 7);
            assert!((search.width_v() - 2.5 / 128.0).abs() < 1e-12);
        }
    }

    #[test]
    fn an_expected_threshold_takes_fewer_steps() {
        let expected = Expected {
            at_v: 2.1,
            reach_v: 0.14,
        };
        for threshold_v in [1.97, 2.05, 2.1, 2.12, 2.23] {
            assert_eq!(found(threshold_v, Some(expected)).tried, 5, "{threshold_v}");
        }
    }

    #[test]
    fn a_wrong_expectation_only_costs_steps() {
        for at_v in [0.5, 1.0, 2.1, 3.5, 9.0] {
            for threshold_v in [1.001, 1.4, 2.8, 3.499] {
                let expected = Expected {
                    at_v,
                    reach_v: 0.01,
                };
                assert!(found(threshold_v, Some(expected)).tried <= 16);
            }
        }
    }
}
