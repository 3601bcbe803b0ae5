//! The AC output of a solid-state relay: when it fires, and what it needs to go on conducting.

use super::Ssr;
use crate::scpi::relay::Kind;

/// Voltage above its threshold at which a half short conducts, volts.
const LEAST_OVER_V: f64 = 0.01;

impl Ssr {
    /// Checks whether the output is that of an AC relay.
    pub fn is_ac(&self) -> bool {
        self.values.model.kind != Kind::Dc
    }

    /// Returns the threshold voltage of the conducting output in a direction, volts.
    pub fn knee_v(&self, sign: f64) -> f64 {
        self.at.knee_v[usize::from(sign < 0.0)]
    }

    /// Returns the slope resistance of the conducting output, ohms.
    pub fn slope_ohm(&self) -> f64 {
        self.at.slope_ohm
    }

    /// Returns the current below which the output goes off, amperes; 0 in the direction of a half short.
    pub fn holding_a(&self, sign: f64) -> f64 {
        match self.values.half_short == sign {
            true => 0.0,
            false => self.values.model.holding_a,
        }
    }

    /// Returns the greatest slope of a returning voltage at which the output still blocks, volts per microsecond.
    pub fn commutation_v_per_us(&self) -> f64 {
        self.values.model.commutation_v_per_us
    }

    /// Returns the least and the greatest voltage over the output at which it fires in a direction behind a load,
    /// volts; `None` when it cannot fire. `again`: the half cycle before has conducted. `refires`: a failed commutation
    /// fires it without light.
    pub fn window(
        &self,
        sign: f64,
        again: bool,
        refires: bool,
        load_ohm: f64,
    ) -> Option<(f64, f64)> {
        let model = &self.values.model;
        let knee_v = self.knee_v(sign);
        if self.values.half_short == sign {
            return Some((knee_v + LEAST_OVER_V, f64::INFINITY));
        }
        let is_triggered = self.is_lit() || refires;
        if !is_triggered || model.half_wave && sign < 0.0 {
            return None;
        }
        let latching_v = knee_v + model.latching_a * (load_ohm + self.slope_ohm());
        Some(match again {
            true => (latching_v.max(model.retrigger_v), f64::INFINITY),
            false => (latching_v, model.inhibit_v),
        })
    }
}
