//! True values of one solid-state relay, drawn from its seed and changed by its defect.

use rand::RngExt;
use rand_distr::StandardNormal;

use crate::module::tolerances::stream;
use crate::table::read_words;

/// Thermal voltage times emission coefficient of the input diode, volts.
const SLOPE_V: f64 = 1.8 * 0.02585;
/// Current at which the forward voltage of the diode is stated, amperes.
const STATED_A: f64 = 0.01;
/// Reverse current of the input, amperes, and the voltage at which it settles, volts.
const REVERSE_A: f64 = 1e-6;
const REVERSE_V: f64 = 0.1;
/// Reference temperature, degrees Celsius.
pub(super) const REFERENCE_C: f64 = 25.0;

/// What the instruments connect to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Resistors instead of a relay.
    Passive,
    /// DC relay with MOSFETs.
    Dc,
    /// AC relay that fires near the zero of the voltage.
    AcZeroCross,
    /// AC relay that fires at any phase.
    AcRandom,
}

read_words!(Kind {
    "passive" => Self::Passive,
    "dc" => Self::Dc,
    "ac-zero-cross" => Self::AcZeroCross,
    "ac-random" => Self::AcRandom,
});

/// Defect of a relay.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)] // `damage` says what each does.
pub enum Defect {
    ShortedOutput,
    HalfWave,
    OpenLed,
    ShortedLed,
    WrongInputCurrent,
    AgedLed,
    NoZeroCross,
    HighDrop,
    Thermal,
    StuckOn,
    SlowTurnOn,
    SlowTurnOff,
    LeakyJunction,
    WrongSnubber,
    OpenSnubber,
    WeakCommutation,
}

read_words!(Defect {
    "shorted_output" => Self::ShortedOutput,
    "half_wave" => Self::HalfWave,
    "open_led" => Self::OpenLed,
    "shorted_led" => Self::ShortedLed,
    "wrong_input_current" => Self::WrongInputCurrent,
    "aged_led" => Self::AgedLed,
    "no_zero_cross" => Self::NoZeroCross,
    "high_drop" => Self::HighDrop,
    "thermal" => Self::Thermal,
    "stuck_on" => Self::StuckOn,
    "slow_turn_on" => Self::SlowTurnOn,
    "slow_turn_off" => Self::SlowTurnOff,
    "leaky_junction" => Self::LeakyJunction,
    "wrong_snubber" => Self::WrongSnubber,
    "open_snubber" => Self::OpenSnubber,
    "weak_commutation" => Self::WeakCommutation,
});

impl Defect {
    /// Checks whether relays of a kind can have the defect.
    pub fn fits(self, kind: Kind) -> bool {
        match self {
            Self::NoZeroCross => kind == Kind::AcZeroCross,
            // An AC output waits for the line, which hides these delays.
            Self::SlowTurnOn | Self::SlowTurnOff => kind == Kind::Dc,
            Self::HalfWave | Self::WrongSnubber | Self::OpenSnubber | Self::WeakCommutation => {
                kind != Kind::Dc
            }
            Self::ShortedOutput
            | Self::OpenLed
            | Self::ShortedLed
            | Self::WrongInputCurrent
            | Self::AgedLed
            | Self::HighDrop
            | Self::Thermal
            | Self::StuckOn
            | Self::LeakyJunction => true,
        }
    }
}

/// True values of a relay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Kind of output.
    pub kind: Kind,
    /// Forward voltage of the input diode at 10 mA, volts.
    pub forward_v: f64,
    /// Series resistance of the input, ohms.
    pub series_ohm: f64,
    /// Input current at which the output turns on at 25 degrees, amperes.
    pub threshold_a: f64,
    /// Ratio of the turn-off current to the turn-on current.
    pub hysteresis: f64,
    /// Time constant of turning on, seconds.
    pub on_tau_s: f64,
    /// Time constant of turning off, seconds.
    pub off_tau_s: f64,
    /// On-state resistance of the MOSFETs, or slope resistance of the triac, ohms.
    pub on_ohm: f64,
    /// Threshold voltage of the triac for the positive and the negative half cycle, volts.
    pub knee_v: [f64; 2],
    /// Current that must flow to fire, amperes.
    pub latching_a: f64,
    /// Current below which the triac goes off, amperes.
    pub holding_a: f64,
    /// Voltage beyond which a zero-cross relay does not fire, volts.
    pub inhibit_v: f64,
    /// Voltage at which each later half cycle fires, volts.
    pub retrigger_v: f64,
    /// Capacitance over the output, farads.
    pub capacitance_f: f64,
    /// Resistance of the leakage over the output, ohms.
    pub leakage_ohm: f64,
    /// Junction leakage at 25 degrees, amperes.
    pub leakage_a: f64,
    /// Slope of the reapplied voltage that a commutation survives, volts per microsecond.
    pub commutation_v_per_us: f64,
    /// Thermal resistance from junction to case, kelvin per watt.
    pub junction_k_per_w: f64,
    /// True when the negative half cycle never fires.
    pub half_wave: bool,
    /// True for an output that always conducts.
    pub shorted: bool,
    /// True for an input without diode current.
    pub open_led: bool,
}

impl Truth {
    /// Draws a relay.
    pub fn draw(kind: Kind, defect: Option<Defect>, seed: u64) -> Self {
        let mut rng = stream(seed, "solid-state relay");
        let mut normal = || rng.sample::<f64, _>(StandardNormal).clamp(-3.0, 3.0);
        let is_dc = kind == Kind::Dc;
        let spread = |mean: f64, relative: f64, normal: f64| mean * (1.0 + relative * normal);
        let knee_v = 0.85;
        let mut truth = Self {
            kind,
            forward_v: 1.2 + 0.03 * normal(),
            series_ohm: spread(1_000.0, 0.025, normal()),
            threshold_a: spread(1.2e-3, 0.15, normal()),
            hysteresis: 0.85 + 0.03 * normal(),
            on_tau_s: if is_dc {
                spread(5e-4, 0.2, normal())
            } else {
                1e-5
            },
            off_tau_s: if is_dc {
                spread(2e-4, 0.1, normal())
            } else {
                1e-5
            },
            on_ohm: spread(if is_dc { 0.05 } else { 0.03 }, 0.1, normal()),
            knee_v: [
                spread(knee_v, 0.01, normal()),
                spread(knee_v, 0.01, normal()),
            ],
            // Light keeps the gate driven, so the small currents of the driver count: over a load of 2.3 kohm the 40 mA of
            // a power triac would not flow within the inhibit window.
            latching_a: 1e-3,
            holding_a: 6e-4,
            inhibit_v: match kind {
                Kind::AcZeroCross => 12.0 + 2.0 * normal(),
                Kind::Passive | Kind::Dc | Kind::AcRandom => f64::INFINITY,
            },
            retrigger_v: 4.0 + 0.5 * normal(),
            capacitance_f: if is_dc {
                2e-10
            } else {
                spread(2e-8, 0.05, normal())
            },
            leakage_ohm: 5e7,
            leakage_a: 5e-9 * normal().exp(),
            commutation_v_per_us: 12.0 + 2.0 * normal(),
            junction_k_per_w: 2.0,
            half_wave: false,
            shorted: false,
            open_led: false,
        };
        if let Some(defect) = defect {
            truth.damage(defect);
        }
        truth
    }

    fn damage(&mut self, defect: Defect) {
        match defect {
            Defect::ShortedOutput => self.shorted = true,
            Defect::HalfWave => self.half_wave = true,
            Defect::OpenLed => self.open_led = true,
            Defect::ShortedLed => {
                self.forward_v = 0.0;
                self.series_ohm = 5.0;
                self.threshold_a = f64::INFINITY;
            }
            Defect::WrongInputCurrent => self.series_ohm *= 0.6,
            Defect::AgedLed => self.threshold_a /= 0.4,
            Defect::NoZeroCross => self.inhibit_v = f64::INFINITY,
            Defect::HighDrop => {
                self.on_ohm *= 4.0;
                self.knee_v = self.knee_v.map(|knee_v| knee_v * 1.5);
            }
            Defect::Thermal => self.junction_k_per_w *= 4.0,
            Defect::StuckOn => self.off_tau_s = 0.2,
            Defect::SlowTurnOn => self.on_tau_s *= 10.0,
            Defect::SlowTurnOff => self.off_tau_s *= 10.0,
            Defect::LeakyJunction => match self.kind {
                Kind::Dc => self.leakage_a = 2e-4,
                Kind::Passive | Kind::AcZeroCross | Kind::AcRandom => self.leakage_ohm = 4e5,
            },
            Defect::WrongSnubber => self.capacitance_f *= 5.0,
            Defect::OpenSnubber => {
                self.capacitance_f = 2e-10;
                self.commutation_v_per_us = 2.0;
            }
            Defect::WeakCommutation => self.commutation_v_per_us = 0.01,
        }
    }

    /// Returns the input current at the voltage of a source with a series resistance, amperes.
    pub fn input_a(&self, volts: f64, source_ohm: f64, temperature_c: f64) -> f64 {
        if self.open_led {
            return 0.0;
        }
        if volts <= 0.0 {
            return -REVERSE_A * (1.0 - (volts / REVERSE_V).exp());
        }
        let series_ohm = self.series_ohm + source_ohm;
        let forward_v = self.forward_at(temperature_c);
        let stated = STATED_A.ln();
        // Both the resistor alone and the diode alone draw more than the two in series; from there Newton's method
        // falls monotonically to the current, in the logarithm of the current.
        let by_resistor = (volts / series_ohm).ln();
        let mut log_a = by_resistor.min(stated + (volts - forward_v) / SLOPE_V);
        for _ in 0..6 {
            let amps = log_a.exp();
            let excess_v = series_ohm * amps + forward_v + SLOPE_V * (log_a - stated) - volts;
            log_a -= excess_v / (series_ohm * amps + SLOPE_V);
        }
        log_a.exp()
    }

    /// Returns the input voltage of a current, volts; infinite where no voltage drives so much.
    pub fn input_v(&self, amps: f64, temperature_c: f64) -> f64 {
        if amps == 0.0 {
            0.0
        } else if self.open_led {
            f64::INFINITY.copysign(amps)
        } else if amps < 0.0 {
            // The logarithm is not a number below the reverse current.
            REVERSE_V * (1.0 + amps / REVERSE_A).max(0.0).ln()
        } else {
            let forward_v = self.forward_at(temperature_c);
            (self.series_ohm * amps + forward_v + SLOPE_V * (amps / STATED_A).ln()).max(0.0)
        }
    }

    fn forward_at(&self, temperature_c: f64) -> f64 {
        self.forward_v - 1.8e-3 * (temperature_c - REFERENCE_C)
    }

    /// Returns the input current at which the output turns on, amperes.
    pub fn threshold_at(&self, celsius: f64) -> f64 {
        self.threshold_a * (1.0 + 5e-3 * (celsius - REFERENCE_C))
    }

    /// Returns the on-state resistance of MOSFETs, or the slope resistance of a triac, ohms.
    pub fn slope_ohm(&self, celsius: f64) -> f64 {
        let kelvin = celsius - REFERENCE_C;
        match self.kind {
            Kind::Dc => self.on_ohm * ((298.15 + kelvin) / 298.15).powf(1.9),
            Kind::Passive | Kind::AcZeroCross | Kind::AcRandom => {
                self.on_ohm * (1.0 + 3e-3 * kelvin)
            }
        }
    }

    /// Returns the voltage at and above which the output turns on at 25 degrees, volts.
    pub fn v_on(&self) -> f64 {
        self.input_v(self.threshold_a, REFERENCE_C)
    }

    /// Returns the voltage below which the output turns off at 25 degrees, volts.
    pub fn v_off(&self) -> f64 {
        self.input_v(self.threshold_a * self.hysteresis, REFERENCE_C)
    }
}
