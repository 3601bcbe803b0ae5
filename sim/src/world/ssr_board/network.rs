//! One node with a capacitor: what is connected to it, and a source with a current limit.
//!
//! Between two events everything is linear, so the voltage follows exponentials: while the source gives its limit,
//! towards the point at which the others take this whole current; after that towards the source.

/// Conductances, currents and capacitance at a node.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Network {
    /// Sum of the conductances to ground, siemens.
    pub siemens: f64,
    /// Current that sources other than the limited one force into the node, amperes.
    pub amps: f64,
    /// Capacitance of the node, farads.
    pub farads: f64,
}

/// A voltage source behind a resistance, with a current limit; a current source is such a source at its limit, its
/// compliance the voltage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limited {
    /// Volts without load.
    pub volts: f64,
    /// Resistance in series, ohms; 0 where the source senses the node.
    pub ohms: f64,
    /// Limit of the current in both directions, amperes.
    pub limit_a: f64,
}

impl Network {
    /// Adds a resistor to ground.
    pub fn resistor(&mut self, ohms: f64) {
        self.siemens += 1.0 / ohms;
    }

    /// Adds a voltage source without limit behind a resistance.
    pub fn source(&mut self, volts: f64, ohms: f64) {
        self.siemens += 1.0 / ohms;
        self.amps += volts / ohms;
    }

    /// Returns the voltage of the node `dt_s` after it was `volts`.
    pub fn after(&self, volts: f64, source: Option<Limited>, dt_s: f64) -> f64 {
        let Some(source) = source else {
            return self.towards(volts, self.amps, self.siemens, dt_s);
        };
        let Some(sign) = self.limiting(volts, source) else {
            return self.held(volts, source, dt_s);
        };
        // The source gives its limit until the voltage reaches the point from which it gives less.
        let amps = self.amps + sign * source.limit_a;
        let point_v = source.volts - sign * source.limit_a * source.ohms;
        let reached_s = self.reach_s(volts, point_v, amps);
        match reached_s.filter(|at_s| *at_s <= dt_s) {
            Some(at_s) => self.held(point_v, source, dt_s - at_s),
            None => self.towards(volts, amps, self.siemens, dt_s),
        }
    }

    /// Returns the current of a source into the node at a voltage, amperes.
    pub fn current(&self, volts: f64, source: Limited) -> f64 {
        match self.limiting(volts, source) {
            Some(sign) => sign * source.limit_a,
            None if source.ohms == 0.0 => self.siemens * volts - self.amps,
            None => (source.volts - volts) / source.ohms,
        }
    }

    /// Returns the sign of the limit at which the source works; `None` below the limit.
    fn limiting(&self, volts: f64, source: Limited) -> Option<f64> {
        let wanted_a = match source.ohms {
            0.0 if volts == source.volts => self.siemens * volts - self.amps,
            0.0 => f64::INFINITY.copysign(source.volts - volts),
            ohms => (source.volts - volts) / ohms,
        };
        (wanted_a.abs() > source.limit_a).then(|| wanted_a.signum())
    }

    /// Returns the voltage under a source below its limit.
    fn held(&self, volts: f64, source: Limited, dt_s: f64) -> f64 {
        match source.ohms {
            0.0 => source.volts,
            ohms => {
                let amps = self.amps + source.volts / ohms;
                self.towards(volts, amps, self.siemens + 1.0 / ohms, dt_s)
            }
        }
    }

    fn towards(&self, volts: f64, amps: f64, siemens: f64, dt_s: f64) -> f64 {
        let goal_v = amps / siemens;
        goal_v + (volts - goal_v) * (-dt_s * siemens / self.farads).exp()
    }

    /// Returns the time to another voltage, seconds; `None` when the node never comes to it.
    fn reach_s(&self, volts: f64, point_v: f64, amps: f64) -> Option<f64> {
        let goal_v = amps / self.siemens;
        let ratio = (volts - goal_v) / (point_v - goal_v);
        (ratio > 1.0 && ratio.is_finite()).then(|| ratio.ln() * self.farads / self.siemens)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NODE: Network = Network {
        siemens: 1e-4,
        amps: 0.0,
        farads: 1e-9,
    };

    fn source(volts: f64, ohms: f64, limit_a: f64) -> Option<Limited> {
        Some(Limited {
            volts,
            ohms,
            limit_a,
        })
    }

    #[test]
    fn a_node_discharges_with_its_time_constant() {
        let volts = NODE.after(60.0, None, 1e-5);
        assert!((volts - 60.0 / std::f64::consts::E).abs() < 1e-9, "{volts}");
    }

    #[test]
    fn a_limit_charges_the_node_until_the_source_holds() {
        let smu = source(8.0, 0.0, 1e-2);
        // 10 mA into 1 nF: 8 V in 0.83 us, as the 10 kohm take some.
        let early_v = NODE.after(0.0, smu, 4e-7);
        assert!((early_v - 3.92).abs() < 0.01, "{early_v}");
        assert_eq!(NODE.after(0.0, smu, 1e-6), 8.0);
        let amps = smu.map(|it| NODE.current(8.0, it));
        assert_eq!(amps, Some(8e-4));
    }

    #[test]
    fn a_limit_below_the_load_never_reaches_the_level() {
        let smu = source(8.0, 0.0, 1e-4);
        let volts = NODE.after(0.0, smu, 1.0);
        assert!((volts - 1.0).abs() < 1e-9, "{volts}");
        let from_above = NODE.after(8.0, smu, 1.0);
        assert!((from_above - 1.0).abs() < 1e-9, "{from_above}");
    }

    #[test]
    fn a_series_resistor_divides_the_voltage() {
        let smu = source(8.0, 1e3, 1.0);
        let volts = NODE.after(0.0, smu, 1.0);
        assert!((volts - 80.0 / 11.0).abs() < 1e-9, "{volts}");
    }
}
