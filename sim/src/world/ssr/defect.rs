//! Defects of a solid-state relay.

use super::table::{SsrAcDefectTable, SsrDefectTable};
use super::values::Values;
use crate::scpi::relay::Kind;
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
        /// The output conducts in one direction only.
        HalfWave = "half_wave",
        /// The output conducts in one direction without light.
        HalfShort = "half_short",
        /// The capacitor of the snubber has no connection.
        OpenSnubber = "open_snubber",
        /// The capacitor of the snubber has a wrong value.
        WrongSnubber = "wrong_snubber",
        /// The output fires at any phase.
        NoZeroCross = "no_zero_cross",
    }
}

/// Time constant of an output that never turns off, seconds.
const STUCK_S: f64 = 1e6;

/// Values of the defects, by kind of output.
#[derive(Debug, Clone, Copy)]
pub(super) enum Damage<'a> {
    Dc(&'a SsrDefectTable),
    Ac(&'a SsrAcDefectTable),
}

/// Ranges that both kinds of output have.
struct Common {
    rate_pct: f64,
    wrong_input_ma: [f64; 2],
    shorted_led_ohm: f64,
    aged_v_on_v: [f64; 2],
    slow_turn_on_us: [f64; 2],
    slow_turn_off_us: [f64; 2],
    leaky_ua: [f64; 2],
}

macro_rules! common {
    ($table:ident) => {
        Common {
            rate_pct: $table.rate_pct,
            wrong_input_ma: $table.wrong_input_ma,
            shorted_led_ohm: $table.shorted_led_ohm,
            aged_v_on_v: $table.aged_v_on_v,
            slow_turn_on_us: $table.slow_turn_on_us,
            slow_turn_off_us: $table.slow_turn_off_us,
            leaky_ua: $table.leaky_ua,
        }
    };
}

impl Damage<'_> {
    /// Returns the share of parts that have a defect, percent.
    pub(super) fn rate_pct(self) -> f64 {
        self.common().rate_pct
    }

    fn common(self) -> Common {
        match self {
            Self::Dc(table) => common!(table),
            Self::Ac(table) => common!(table),
        }
    }
}

impl Defect {
    /// Returns the defects that a lot with this output draws, all with the same probability.
    pub fn of_output(kind: Kind) -> &'static [Self] {
        match kind {
            Kind::Dc | Kind::Passive => &Self::ALL[..Self::DC],
            Kind::AcZeroCross => Self::ALL,
            Kind::AcRandom => &Self::ALL[..Self::ALL.len() - 1],
        }
    }

    /// Number of defects that a DC output can have; they come first.
    const DC: usize = 13;

    /// Changes the true values of a part at its temperature.
    pub(super) fn damage(self, values: &mut Values, damage: Damage<'_>, draw: &mut Draw) {
        let table = damage.common();
        match self {
            Self::OpenLed => values.model.open_led = true,
            Self::ShortedLed => {
                values.model.forward_v = 0.0;
                values.model.series_ohm = table.shorted_led_ohm;
                values.model.threshold_a = f64::INFINITY;
            }
            Self::WrongInputCurrent => values.draw_input(draw.between(table.wrong_input_ma) * 1e-3),
            Self::AgedLed => {
                let v_on = draw.between(table.aged_v_on_v);
                let goal_a = values.model.input_a(v_on, 0.0, values.celsius);
                values.model.threshold_a *= goal_a / values.model.threshold_at(values.celsius);
            }
            Self::ShortedOutput => values.model.shorted = true,
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
                let siemens = amps / values.rated.blocked_v - 1.0 / values.model.leakage_ohm;
                let at_stated = values.junction_siemens(values.celsius) / values.model.leakage_a;
                values.model.leakage_a = siemens / at_stated;
            }
            Self::MissingPin => values.pins.lose(draw.below(4) as usize),
            Self::Misoriented => values.misorient(),
            Self::HighDrop
            | Self::Thermal
            | Self::HalfWave
            | Self::HalfShort
            | Self::OpenSnubber
            | Self::WrongSnubber
            | Self::NoZeroCross => match damage {
                Damage::Dc(table) => self.damage_dc(values, table, draw),
                Damage::Ac(table) => self.damage_ac(values, table, draw),
            },
        }
    }

    fn damage_dc(self, values: &mut Values, table: &SsrDefectTable, draw: &mut Draw) {
        if self == Self::HighDrop {
            values.model.on_ohm = draw.between(table.high_drop_mohm) * 1e-3;
        }
        if self == Self::Thermal {
            let drift_v = draw.between(table.thermal_drift_mv) * 1e-3;
            // The drift is almost proportional to the thermal resistance.
            for _ in 0..6 {
                values.model.junction_k_per_w *= drift_v / values.warm_up().drift_v;
            }
        }
    }

    fn damage_ac(self, values: &mut Values, table: &SsrAcDefectTable, draw: &mut Draw) {
        let model = &mut values.model;
        match self {
            Self::HighDrop => {
                let more_v = draw.between(table.high_drop_v) - values.peak_drop_v(values.celsius);
                values.model.knee_v = values.model.knee_v.map(|knee_v| knee_v + more_v);
            }
            Self::Thermal => model.junction_k_per_w *= draw.between(table.thermal_factor),
            Self::HalfWave => model.half_wave = true,
            Self::HalfShort => values.half_short = if draw.uniform() < 0.5 { 1.0 } else { -1.0 },
            Self::OpenSnubber => {
                model.capacitance_f = table.open_snubber_pf * 1e-12;
                model.commutation_v_per_us = draw.between(table.open_snubber_v_per_us);
            }
            Self::WrongSnubber => model.capacitance_f *= draw.between(table.wrong_snubber_factor),
            Self::NoZeroCross => model.inhibit_v = f64::INFINITY,
            _ => {}
        }
    }
}

impl Values {
    /// Gives the input a resistor with which it draws `amps` at the nominal control voltage.
    fn draw_input(&mut self, amps: f64) {
        let by_resistor_v = amps * self.model.series_ohm;
        let diode_v = self.model.input_v(amps, self.celsius) - by_resistor_v;
        self.model.series_ohm = (self.rated.control_v - diode_v) / amps;
    }
}
