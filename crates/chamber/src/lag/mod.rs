//! Finds switching temperatures from the instants at which contacts switch, and corrects them for the lag of the parts.
//!
//! A part follows the air with a lag. Filtered by a first-order low-pass with that lag, the record of the reference
//! sensor is the temperature of the part, so its value at an event is the switching temperature. This holds for any
//! profile; it needs neither a soak nor a constant rate. [`lot_lag`] finds the lag of each part as the one with which the
//! part has the same temperature in fast and slow passes, and from these the lag of the lot and the spread of lags within
//! it; [`estimate()`] finds the temperatures of one part together with its own lag.
//!
//! ```
//! use chamber::lag::{Noise, Record, Transition, Switching, lot_lag};
//! // Two ramps, 5 and 2 K/min, each from 40 C; a part with a lag of 40 s operates at 60 C.
//! let mut record = Record::new(0.0, 40.0);
//! for _ in 0..600 { record.push(40.0); }
//! for second in 0..360 { record.push(40.0 + 5.0 / 60.0 * f64::from(second)); }
//! for _ in 0..900 { record.push(40.0); }
//! for second in 0..900 { record.push(40.0 + 2.0 / 60.0 * f64::from(second)); }
//! let filtered = record.filtered(40.0);
//! let reaches = |from: i32| (from..2760).find(|second| filtered.at(f64::from(*second)).is_some_and(|it| it.celsius >= 60.0));
//! let [fast, slow] = [reaches(600), reaches(1860)].map(|it| f64::from(it.unwrap_or(0)));
//! let part = Switching { operate: vec![Transition::at(fast), Transition::at(slow)], reset: Vec::new() };
//! let noise = Noise { scatter_k: 0.15, sensor_lag_s: 0.0 };
//! let found = lot_lag(&record, &[part], &noise).unwrap();
//! assert!((found.seconds - 40.0).abs() < 2.0);
//! ```

mod estimate;
mod fit;
mod lot;
mod record;
mod scatter;

pub use estimate::{Estimate, Noise, Value, estimate};
pub use lot::{LAG_SPREAD, LotLag, lot_lag};
pub use record::{Filtered, Record, Sample};
pub use scatter::lot_scatter;

/// A change of a contact, as the polls have seen it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// First edge, s of the record: the middle of the polls around it.
    pub first_s: f64,
    /// Last edge, s of the record; equal to the first for a clean snap.
    pub last_s: f64,
    /// Number of edges; 1 for a clean snap.
    pub edges: u32,
}

impl Transition {
    /// Makes a transition of one edge, a clean snap.
    pub const fn at(instant_s: f64) -> Self {
        Self {
            first_s: instant_s,
            last_s: instant_s,
            edges: 1,
        }
    }
}

/// Transitions of one part in the passes of a batch, in order of time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Switching {
    /// Transitions on rising temperature.
    pub operate: Vec<Transition>,
    /// Transitions on falling temperature.
    pub reset: Vec<Transition>,
}

#[cfg(test)]
mod tests;
