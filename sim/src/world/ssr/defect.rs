//! Defects of a solid-state relay with a DC output.

use super::table::SsrDefectTable;
use super::values::Values;
use crate::world::draw::Draw;
use crate::world::signal::vocabulary;

vocabulary! {
    /// A defect of the simulated lot, with its name in the truth file.
    Defect {
        /// No current flows into the input.
        OpenLed = "open_led",
        /// Only a few ohms are left of the input; the output never turns on.
        ShortedLed = "shorted_led",
        /// The resistor of the input has a wrong value.
        WrongInputCurrent = "wrong_input_current",
        /// The light is weak: turn-on voltage too high, input current as usual.
        AgedLed = "aged_led",
        /// The output always conducts.
        ShortedOutput = "shorted_output",
        /// The on-state resistance is too high.
        HighDrop = "high_drop",
        /// The die has lost its contact to the case, so that it warms too much.
        Thermal = "thermal",
        /// The output never turns off again.
        StuckOn = "stuck_on",
        /// The output turns on too late.
        SlowTurnOn = "slow_turn_on",
        /// The output turns off too late.
        SlowTurnOff = "slow_turn_off",
        /// The blocked output leaks.
        LeakyJunction = "leaky_junction",
        /// One pin is missing.
        MissingPin = "missing_pin",
        /// The relay is misoriented in the nest: two probes miss metal, the others touch wrong pins.
        Misoriented = "turned",
    }
}

/// Time constant of an output that never turns off, seconds.
const STUCK_S: f64 = 1e6;

impl Defect {
    /// Changes the true values of a part at its temperature.
    pub(super) fn damage(self, values: &mut Values, table: &SsrDefectTable, draw: &mut Draw) {
        let rated = values.rated;
        match self {
            Self::OpenLed => values.model.open_led = true,
            Self::ShortedLed => {
                values.model.forward_v = 0.0;
                values.model.series_ohm = table.shorted_led_ohm;
                values.model.threshold_a = f64::INFINITY;
            }
            Self::WrongInputCurrent => {
                let amps = draw.between(table.wrong_input_ma) * 1e-3;
                let by_resistor_v = amps * values.model.series_ohm;
                let diode_v = values.model.input_v(amps, values.celsius) - by_resistor_v;
                values.model.series_ohm = (rated.control_v - diode_v) / amps;
            }
            Self::AgedLed => {
                let v_on = draw.between(table.aged_v_on_v);
                let goal_a = values.model.input_a(v_on, 0.0, values.celsius);
                values.model.threshold_a *= goal_a / values.model.threshold_at(values.celsius);
            }
            Self::ShortedOutput => values.model.shorted = true,
            Self::HighDrop => values.model.on_ohm = draw.between(table.high_drop_mohm) * 1e-3,
            Self::Thermal => {
                let drift_v = draw.between(table.thermal_drift_mv) * 1e-3;
                // The drift is nearly in proportion to the thermal resistance.
                for _ in 0..6 {
                    values.model.junction_k_per_w *= drift_v / values.warm_up().drift_v;
                }
            }
            Self::StuckOn => values.model.off_tau_s = STUCK_S,
            Self::SlowTurnOn => {
                let wanted_s = draw.between(table.slow_turn_on_us) * 1e-6;
                values.model.on_tau_s *= wanted_s / values.turn_on_s();
            }
            Self::SlowTurnOff => {
                let wanted_s = draw.between(table.slow_turn_off_us) * 1e-6 - values.recharge_s;
                values.model.off_tau_s *= wanted_s / (values.turn_off_s() - values.recharge_s);
            }
            Self::LeakyJunction => {
                let amps = draw.between(table.leaky_ua) * 1e-6;
                let siemens = amps / rated.blocked_v - 1.0 / values.model.leakage_ohm;
                let at_stated = values.junction_siemens(values.celsius) / values.model.leakage_a;
                values.model.leakage_a = siemens / at_stated;
            }
            Self::MissingPin => values.pins.lose(draw.below(4) as usize),
            Self::Misoriented => values.misorient(),
        }
    }
}
