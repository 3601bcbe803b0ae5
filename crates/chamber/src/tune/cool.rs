//! Brings a warm chamber to rest before its identification: vent open until its temperature hardly falls.
//!
//! Walls that have kept heat warm or cool the air on their own. An identification would take this fading drift for
//! lasting losses. With the vent open and the fan on, the chamber falls to some kelvin above the room; the slope then
//! shows the heat left in the walls.

use super::Identified;
use crate::statistics::slope;

/// Largest rise of a cold chamber during a rest with the fan only, K: the fan lifts the air by 1 K at once, and air and
/// walls by another 1 K in three minutes.
const COLD_RISE_K: f64 = 3.2;
/// Slopes at the end of such a rest between which a chamber counts as cold, K/s: the fan alone makes 0.2 to 0.5 K/min.
const COLD_K_PER_S: [f64; 2] = [-0.1 / 60.0, 0.6 / 60.0];
/// Time over which the slope of the cooling is measured, s.
const SLOPE_S: usize = 120;
/// Slope above which the cooling ends, K/s.
const ENDS_K_PER_S: f64 = -0.3 / 60.0;
/// Longest cooling, s.
const LONGEST_S: usize = 5_400;

/// Returns true when these readings of a rest, one a second, are of a cold chamber; `drift`: slope at their end, K/s.
pub fn is_cold(rest_c: &[f64], drift: f64) -> bool {
    let rise_k = rest_c
        .last()
        .zip(rest_c.first())
        .map_or(0.0, |(end, start)| end - start);
    let [least, most] = COLD_K_PER_S;
    rise_k <= COLD_RISE_K && (least..=most).contains(&drift)
}

/// Readings of a cooling, stepped once a second.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cooling {
    readings_c: Vec<f64>,
}

/// End of a cooling with the vent open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cooled {
    /// Temperature at the end, C.
    pub end_c: f64,
    /// Slope of the temperature over the last two minutes, K/s.
    pub slope_k_per_s: f64,
}

impl Cooled {
    /// Returns the temperature around the chamber, C: the one that balances fan, losses and vent; `None` for a chamber
    /// that loses no heat.
    pub fn ambient_c(&self, chamber: &Identified) -> Option<f64> {
        let heated = chamber.fan - self.slope_k_per_s / chamber.slope_k_per_s;
        let removed_per_k = chamber.loss_per_k + chamber.vent_per_k;
        (removed_per_k > 0.0).then(|| self.end_c - heated / removed_per_k)
    }
}

impl Cooling {
    /// Takes the reading of a second, C; returns the end of the cooling once the temperature hardly falls.
    pub fn step(&mut self, measured_c: f64) -> Option<Cooled> {
        self.readings_c.push(measured_c);
        let from = self.readings_c.len().checked_sub(SLOPE_S)?;
        let slope_k_per_s = slope(&self.readings_c[from..]);
        let is_over = slope_k_per_s > ENDS_K_PER_S || self.readings_c.len() >= LONGEST_S;
        is_over.then_some(Cooled {
            end_c: measured_c,
            slope_k_per_s,
        })
    }
}
