//! Standard uncertainties of the figures of an identification.

use super::{DRIFT_S, FIRST_ORDER_S, Identification, LENGTHS_S};
use crate::statistics::mean;
use crate::tune::{Identified, fit};

impl Identification {
    /// Returns the standard uncertainties of the figures of a run that is over.
    ///
    /// The uncertainties of gain, time constant, delay and slope follow from the misfit of the model. Loss, fan and
    /// vent come from slopes of the reading over stretches of some minutes; their uncertainties follow from the noise
    /// of the reading and from the uncertainty of the slope of the model.
    pub fn doubt(&self, found: &Identified) -> Identified {
        let (response, drift, start_c) = self.response();
        let return_per_s = self.return_per_s(drift, start_c);
        let parts = fit::TwoPart {
            gain_k: found.gain_k,
            time_constant_s: found.time_constant_s,
            delay_s: found.delay_s,
            slope_k_per_s: found.slope_k_per_s,
        };
        let (parts, early) = (
            fit::two_part_doubt(&response, &parts, return_per_s),
            fit::first_order_doubt(&response[..=FIRST_ORDER_S], &found.first_order),
        );
        let share = parts.slope_k_per_s / found.slope_k_per_s;
        let drift = self.noise_k() * (12.0 / (DRIFT_S as f64).powi(3)).sqrt();
        let power = std::f64::consts::SQRT_2 * drift / found.slope_k_per_s;
        let excess_k = (self.coast_excess_k()).abs().max(1.0);
        Identified {
            gain_k: parts.gain_k,
            time_constant_s: parts.time_constant_s,
            delay_s: parts.delay_s,
            slope_k_per_s: parts.slope_k_per_s,
            loss_per_k: (power / excess_k).hypot(found.loss_per_k * share),
            fan: power.hypot(found.fan * share),
            vent_per_k: found.vent_per_k * share.hypot(parts.gain_k / found.gain_k),
            first_order: early,
        }
    }

    /// Returns the noise of a reading, K: from the differences of readings at rest.
    fn noise_k(&self) -> f64 {
        let rest = &self.readings_c[..LENGTHS_S[0]];
        let squares: Vec<f64> = rest.windows(2).map(|it| (it[1] - it[0]).powi(2)).collect();
        (mean(&squares) / 2.0).sqrt()
    }

    /// Returns by how much the coast is hotter than the rest, K.
    fn coast_excess_k(&self) -> f64 {
        let end: usize = LENGTHS_S[..3].iter().sum();
        let rest = LENGTHS_S[0];
        mean(&self.readings_c[end - DRIFT_S..=end]) - mean(&self.readings_c[rest - 4..=rest])
    }
}
