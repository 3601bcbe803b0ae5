//! Uncertainty of a resistance, computed from the makers' accuracies, since the kind has no calibration.

use super::recipe::ResistorRecipe;
use crate::dut::accuracy::{AccuracySettings, FULL_SCALE_V, LSB_V, READABLE_V};
use crate::gauge::Budget;
use crate::gauge::budget::{rectangular, resolution};

/// Greatest difference between the temperature of the part and the reference temperature, K.
const TEMPERATURE_K: f64 = 10.0;
/// Resistance of both probe contacts in series, ohm (half width).
const PROBES_OHM: f64 = 0.2;

/// Accuracies of the only channel that the test reads.
#[derive(Debug, Clone, Copy)]
pub struct ChannelAccuracy {
    /// Accuracies of the makers.
    pub accuracy: AccuracySettings,
    /// Volts at the terminal per ampere.
    pub volt_per_ampere: f64,
}

impl ChannelAccuracy {
    fn offset_v(&self) -> f64 {
        self.accuracy.ai_offset_pct_of_range / 100.0 * FULL_SCALE_V
    }

    fn noise_v(&self) -> f64 {
        (self.accuracy.ai_noise_lsb * LSB_V).hypot(resolution(LSB_V))
    }

    /// Returns the current below which a reading counts as an open circuit, A.
    pub fn no_current_ampere(&self) -> f64 {
        (self.offset_v() + 3.0 * self.noise_v()) / self.volt_per_ampere
    }

    /// Returns the greatest current that the channel reads, A.
    pub fn most_ampere(&self) -> f64 {
        READABLE_V / self.volt_per_ampere
    }

    /// Returns the uncertainty budget of a resistance, ohm.
    pub fn budget(&self, resistor: &ResistorRecipe, ohm: f64) -> Budget {
        let (promised, level_v) = (&self.accuracy, resistor.test.level_v);
        let terminal_v = level_v / ohm * self.volt_per_ampere;
        let level = (promised.ao_gain_pct / 100.0).hypot(promised.ao_offset_mv / 1e3 / level_v);
        let readings = f64::from(resistor.test.readings);
        let kelvin = resistor.part.tcr_ppm_per_k.abs() * 1e-6 * TEMPERATURE_K;
        Budget::default()
            .with("level", ohm * rectangular(level))
            .with("gain", ohm * rectangular(promised.ai_gain_pct / 100.0))
            .with("offset", ohm * rectangular(self.offset_v() / terminal_v))
            .with("temperature", ohm * rectangular(kelvin))
            .with("probe contact", rectangular(PROBES_OHM))
            .with_random("noise", ohm * self.noise_v() / terminal_v / readings.sqrt())
    }
}
