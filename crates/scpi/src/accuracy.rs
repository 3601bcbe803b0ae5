//! How far an instrument may err, as its maker states it.

use serde::Deserialize;

/// Quantity that an instrument measures or sets; its name ends with the unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Measured voltage, V.
    VoltageV,
    /// Voltage of the source, V.
    SourceVoltageV,
    /// Measured current, A.
    CurrentA,
    /// Current of the source, A.
    SourceCurrentA,
    /// Frequency, Hz.
    FrequencyHz,
    /// Time, s.
    TimeS,
}

impl Quantity {
    /// Returns the name in profiles.
    pub const fn name(self) -> &'static str {
        match self {
            Self::VoltageV => "voltage_v",
            Self::SourceVoltageV => "source_voltage_v",
            Self::CurrentA => "current_a",
            Self::SourceCurrentA => "source_current_a",
            Self::FrequencyHz => "frequency_hz",
            Self::TimeS => "time_s",
        }
    }
}

/// Errors of one quantity in one range, in the unit of the quantity.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
pub struct Accuracy {
    /// The quantity.
    pub quantity: Quantity,
    /// End of the range.
    pub full_scale: f64,
    /// Error as a share of the reading, %, half width.
    pub reading_pct: f64,
    /// Error that does not depend on the reading, half width.
    pub offset: f64,
    /// Standard deviation of a reading averaged over one period of the mains; 0 where the profile states none.
    #[serde(default)]
    pub noise: f64,
}

impl Accuracy {
    /// Returns the half width of the error proportional to the reading, at `value`.
    pub fn gain(&self, value: f64) -> f64 {
        self.reading_pct / 100.0 * value.abs()
    }

    /// Returns the standard deviation of a reading averaged over `periods` of the mains, above 0.
    pub fn noise_over(&self, periods: f64) -> f64 {
        self.noise / periods.sqrt()
    }
}

/// Returns the errors in the smallest range of `quantity` that holds `value`; `None` when no range does.
pub fn range(all: &[Accuracy], quantity: Quantity, value: f64) -> Option<Accuracy> {
    let holds = |it: &&Accuracy| it.quantity == quantity && value.abs() <= it.full_scale;
    let fitting = all.iter().filter(holds).copied();
    fitting.min_by(|one, other| one.full_scale.total_cmp(&other.full_scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn current(full_scale: f64) -> Accuracy {
        Accuracy {
            quantity: Quantity::CurrentA,
            full_scale,
            reading_pct: 0.02,
            offset: 600e-9,
            noise: 30e-9,
        }
    }

    #[test]
    fn the_smallest_range_that_holds_a_value_counts() {
        let all = [current(1.0), current(0.01)];
        let full = |value| range(&all, Quantity::CurrentA, value).map(|it| it.full_scale);
        assert_eq!(full(-0.01), Some(0.01));
        assert_eq!(full(0.0101), Some(1.0));
        assert_eq!(full(1.1), None);
        assert_eq!(range(&all, Quantity::VoltageV, 0.0), None);
    }

    #[test]
    fn averaging_over_four_periods_halves_the_noise() {
        assert!((current(0.01).noise_over(4.0) - 15e-9).abs() < 1e-18);
        assert!((current(0.01).gain(-0.005) - 1e-6).abs() < 1e-18);
    }
}
