//! Counter of falling edges at a digital input, with the 5 ms filter of a module's event counter.

/// Shortest low level that counts, microseconds.
const FILTER_US: u64 = 5_000;

/// Edge counter of one terminal.
#[derive(Debug, Clone, Copy, Default)]
pub struct Edges {
    low_since_us: Option<u64>,
    counted: bool,
    count: u64,
}

impl Edges {
    /// Sets the level (true: high) from now on.
    pub fn level(&mut self, high: bool, now_us: u64) {
        match (high, self.low_since_us) {
            (false, None) => {
                self.low_since_us = Some(now_us);
                self.counted = false;
            }
            (true, Some(_)) => {
                self.settle(now_us);
                self.low_since_us = None;
            }
            (false, Some(_)) | (true, None) => {}
        }
    }

    /// Returns the number of counted falling edges so far.
    pub fn count(&mut self, now_us: u64) -> u64 {
        self.settle(now_us);
        self.count
    }

    /// Sets the initial level without counting an edge.
    pub fn begin(&mut self, high: bool, now_us: u64) {
        self.low_since_us = (!high).then_some(now_us);
        self.counted = true;
    }

    fn settle(&mut self, now_us: u64) {
        let long = self
            .low_since_us
            .is_some_and(|since| now_us - since >= FILTER_US);
        if long && !self.counted {
            self.counted = true;
            self.count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_falling_part_counts_once_and_a_spike_never() {
        let mut beam = Edges::default();
        beam.begin(true, 0);
        for (t, high) in [(100, false), (9_000, true), (50_000, false), (52_000, true)] {
            beam.level(high, t);
        }
        assert_eq!(beam.count(60_000), 1);
    }

    #[test]
    fn a_lasting_low_counts_after_the_filter_time() {
        let mut input = Edges::default();
        input.begin(true, 0);
        input.level(false, 1_000);
        assert_eq!(input.count(5_999), 0);
        assert_eq!(input.count(6_000), 1);
        assert_eq!(input.count(7_000), 1);
    }
}
