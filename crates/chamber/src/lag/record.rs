//! The record of the reference sensor, and its first-order low-pass.

/// Longest gap that a straight line replaces, s. The rate of the set point changes by at most 20 K/min within a minute,
/// so the line is off by 0.011 K at most.
const SHORT_GAP_S: usize = 3;
/// Time after a gap longer than [`SHORT_GAP_S`] during which the record gives no temperature, in lengths of the gap.
/// Afterwards at most 7 % of the error of the gap remains in a low-pass, whatever its lag.
const FORGETS: usize = 5;

/// Readings of the reference sensor, one a second.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    start_s: f64,
    parts_c: f64,
    readings_c: Vec<f64>,
    /// Number of readings missing since the last one.
    missing: usize,
    /// Stretches without a temperature, in seconds since the start: from the last reading before a gap until the
    /// low-pass has forgotten the gap.
    void: Vec<[f64; 2]>,
}

impl Record {
    /// Starts an empty record at an instant, s, with the temperature that the parts have then: that of the room if a
    /// person has just loaded them.
    pub const fn new(start_s: f64, parts_c: f64) -> Self {
        Self {
            start_s,
            parts_c,
            readings_c: Vec::new(),
            missing: 0,
            void: Vec::new(),
        }
    }

    /// Appends the reading of the next second, C; one that is not finite is missing. A straight line replaces missing
    /// readings; the first reading replaces those missing before it. The record gives no temperature in a gap of more
    /// than 3 s, nor in one at the start.
    pub fn push(&mut self, reading_c: f64) {
        if !reading_c.is_finite() {
            self.missing += 1;
            return;
        }
        let gap = std::mem::take(&mut self.missing);
        let last_c = self.readings_c.last().copied();
        let steps = gap as f64 + 1.0;
        let from_c = last_c.unwrap_or(reading_c);
        if gap > SHORT_GAP_S || (gap > 0 && last_c.is_none()) {
            let [from, to] = [self.readings_c.len() as f64 - 1.0, (FORGETS * gap) as f64];
            self.void.push([from, from + steps + to]);
        }
        let filled = (1..=gap).map(|it| from_c + (reading_c - from_c) * it as f64 / steps);
        self.readings_c.extend(filled);
        self.readings_c.push(reading_c);
    }

    /// Returns the number of seconds, missing readings included.
    pub fn seconds(&self) -> usize {
        self.readings_c.len() + self.missing
    }

    /// Returns true for an instant, s, at which the record gives a temperature: between two readings, away from gaps.
    pub fn covers(&self, instant_s: f64) -> bool {
        let place = instant_s - self.start_s;
        let is_void = self
            .void
            .iter()
            .any(|[from, to]| *from < place && place < *to);
        let last = self.readings_c.len() as f64 - 1.0;
        !is_void && (0.0..last).contains(&place)
    }

    /// Returns the record, filtered by a first-order low-pass with a lag, s.
    pub fn filtered(&self, lag_s: f64) -> Filtered<'_> {
        let lag_s = lag_s.max(1e-3);
        let second = Share::of(1.0, lag_s);
        let mut state = State {
            celsius: self.parts_c,
            per_lag_k_per_s: 0.0,
        };
        let mut states = Vec::with_capacity(self.readings_c.len());
        states.push(state);
        for pair in self.readings_c.windows(2) {
            state = state.moved([pair[0], pair[1]], &second);
            states.push(state);
        }
        Filtered {
            record: self,
            lag_s,
            states,
        }
    }
}

/// Part of a second, s, with what remains of the state of a low-pass after it.
struct Share {
    s: f64,
    lag_s: f64,
    remains: f64,
}

impl Share {
    fn of(s: f64, lag_s: f64) -> Self {
        let remains = (-s / lag_s).exp();
        Self { s, lag_s, remains }
    }
}

/// State of the low-pass.
#[derive(Debug, Clone, Copy, PartialEq)]
struct State {
    celsius: f64,
    /// Change of the temperature with the lag, K/s: the low-pass of its rate, sign reversed.
    per_lag_k_per_s: f64,
}

impl State {
    /// Returns the state after a part of a second, while the input moves linearly from one reading to the next.
    fn moved(self, [from, to]: [f64; 2], share: &Share) -> Self {
        let Share { s, lag_s, remains } = *share;
        let slope = to - from;
        let behind = self.celsius - from + slope * lag_s;
        let turns = self.per_lag_k_per_s + slope + behind * s / (lag_s * lag_s);
        Self {
            celsius: from + slope * (s - lag_s) + behind * remains,
            per_lag_k_per_s: turns * remains - slope,
        }
    }
}

/// A record, filtered with a lag.
#[derive(Debug, Clone, PartialEq)]
pub struct Filtered<'a> {
    record: &'a Record,
    lag_s: f64,
    states: Vec<State>,
}

/// The filtered record at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Temperature, C.
    pub celsius: f64,
    /// Rate, K/s.
    pub rate_k_per_s: f64,
    /// Change of the temperature with the lag of the filter, K/s.
    pub per_lag_k_per_s: f64,
}

impl Filtered<'_> {
    /// Returns the filtered temperature at an instant of the record, s; `None` where the record does not cover it.
    pub fn at(&self, instant_s: f64) -> Option<Sample> {
        if !self.record.covers(instant_s) {
            return None;
        }
        let place = instant_s - self.record.start_s;
        let second = place.floor() as usize;
        let readings = self.record.readings_c.get(second..second + 2)?;
        let ends = [readings[0], readings[1]];
        let share_s = place - place.floor();
        let before = *self.states.get(second)?;
        let now = before.moved(ends, &Share::of(share_s, self.lag_s));
        let input_c = ends[0] + (ends[1] - ends[0]) * share_s;
        Some(Sample {
            celsius: now.celsius,
            rate_k_per_s: (input_c - now.celsius) / self.lag_s,
            per_lag_k_per_s: now.per_lag_k_per_s,
        })
    }
}
