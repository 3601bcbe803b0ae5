//! A solid-state relay in its circuit, stepped through time: light, firing, current zeros, heat.

use super::truth::{Kind, REFERENCE_C, Truth};
use crate::scpi::circuit::{Circuit, Drive, Reading, Terminal, over_resistor};
use crate::scpi::passive::{Line, pulse_volts};

/// Longest step while the line is on, microseconds.
const STEP_US: u64 = 20;
/// Time constants of junction and case, seconds, and the resistance of the case, kelvin per watt.
const JUNCTION_S: f64 = 0.02;
const CASE_S: f64 = 20.0;
const CASE_K_PER_W: f64 = 8.0;
/// Resistance of a shorted output, ohms.
const SHORT_OHM: f64 = 0.1;
/// Resistance of the snubber, ohms.
const SNUBBER_OHM: f64 = 39.0;

/// A relay with its sources and its state.
pub struct SolidState {
    truth: Truth,
    line: Line,
    load_ohm: f64,
    load_h: f64,
    input: Drive,
    pulse: Drive,
    pulse_from_us: u64,
    output: Drive,
    has_line: bool,
    now_us: u64,
    /// Light over threshold: fires from 1 up, falls off below the hysteresis.
    light: f64,
    lit: bool,
    /// Sign of the half cycle that conducts, 0 while blocked.
    conducts: f64,
    /// True when the half cycle before conducted, so that this one fires at the retrigger voltage.
    again: bool,
    /// Half cycle that fires without light after a failed commutation.
    refire: f64,
    sign: f64,
    load_a: f64,
    junction_k: f64,
    case_k: f64,
}

impl SolidState {
    /// Puts a cold relay into its circuit.
    pub fn new(truth: Truth, line: Line, load_ohm: f64, load_h: f64) -> Self {
        Self {
            truth,
            line,
            load_ohm,
            load_h,
            input: Drive::Open,
            pulse: Drive::Open,
            pulse_from_us: 0,
            output: Drive::Open,
            has_line: false,
            now_us: 0,
            light: 0.0,
            lit: false,
            conducts: 0.0,
            again: false,
            refire: 0.0,
            sign: 0.0,
            load_a: 0.0,
            junction_k: 0.0,
            case_k: 0.0,
        }
    }

    /// Returns the junction's temperature, degrees Celsius.
    pub fn temperature_c(&self) -> f64 {
        REFERENCE_C + self.junction_k + self.case_k
    }

    fn is_ac(&self) -> bool {
        self.truth.kind != Kind::Dc
    }

    fn pulse_v(&self) -> Option<f64> {
        pulse_volts(self.pulse, (self.now_us - self.pulse_from_us) as f64)
    }

    /// Returns voltage and current at the input.
    fn at_input(&self) -> Reading {
        let volts_at = |volts: f64| Reading {
            volts,
            amps: self.truth.input_a(volts, self.temperature_c()),
        };
        match self.input {
            Drive::Voltage { volts, limit_a } => {
                let free = volts_at(volts);
                match free.amps.abs() > limit_a {
                    true => Reading {
                        volts: self.truth.input_v(limit_a),
                        amps: limit_a,
                    },
                    false => free,
                }
            }
            Drive::Current { amps, limit_v } if amps > 0.0 => {
                let volts = if self.truth.open_led {
                    limit_v
                } else {
                    self.truth.input_v(amps)
                };
                if volts >= limit_v {
                    volts_at(limit_v)
                } else {
                    Reading { volts, amps }
                }
            }
            Drive::Current { limit_v, .. } => volts_at(-limit_v),
            Drive::Open | Drive::Sine { .. } | Drive::Pulses(_) => match self.pulse_v() {
                Some(volts) => volts_at(volts),
                None => Reading::default(),
            },
        }
    }

    /// Moves the light towards the input current; the exponential is exact for a constant input.
    fn shine(&mut self, dt_s: f64) {
        let threshold_a =
            self.truth.threshold_a * (1.0 + 5e-3 * (self.temperature_c() - REFERENCE_C));
        let goal = self.at_input().amps.max(0.0) / threshold_a;
        let tau_s = if goal > self.light {
            self.truth.on_tau_s
        } else {
            self.truth.off_tau_s
        };
        self.light = goal + (self.light - goal) * (-dt_s / tau_s).exp();
        self.lit = self.light >= if self.lit { self.truth.hysteresis } else { 1.0 };
    }

    fn warm(&mut self, dt_s: f64) {
        let output = self.at(Terminal::Output);
        let watts = output.volts * self.through(output);
        let towards =
            |from: f64, goal: f64, tau_s: f64| goal + (from - goal) * (-dt_s / tau_s).exp();
        self.junction_k = towards(
            self.junction_k,
            watts * self.truth.junction_k_per_w,
            JUNCTION_S,
        );
        self.case_k = towards(self.case_k, watts * CASE_K_PER_W, CASE_S);
    }

    fn through(&self, output: Reading) -> f64 {
        if self.has_line {
            self.load_a
        } else {
            output.amps
        }
    }

    fn knee_v(&self) -> f64 {
        let knee_v = self.truth.knee_v[usize::from(self.sign < 0.0)];
        knee_v - 1.5e-3 * (self.temperature_c() - REFERENCE_C)
    }

    fn slope_ohm(&self) -> f64 {
        let kelvin = self.temperature_c() - REFERENCE_C;
        match self.truth.kind {
            Kind::Dc => self.truth.on_ohm * ((298.15 + kelvin) / 298.15).powf(1.9),
            Kind::Passive | Kind::AcZeroCross | Kind::AcRandom => {
                self.truth.on_ohm * (1.0 + 3e-3 * kelvin)
            }
        }
    }

    /// Returns the current of the blocked output at a voltage with its slope, amperes.
    fn leakage_a(&self, volts: f64, slope_v_per_s: f64) -> f64 {
        let junction =
            self.truth.leakage_a * 2f64.powf((self.temperature_c() - REFERENCE_C) / 10.0);
        self.truth.capacitance_f * slope_v_per_s
            + volts / self.truth.leakage_ohm
            + junction * (volts / 0.1).tanh()
    }

    /// Lets the triac fire, conduct or go off, and moves the load current.
    fn commutate(&mut self, dt_s: f64) {
        let line_v = self.line.volts(0.0);
        let sign = line_v.signum();
        let (knee_v, ohms) = (self.knee_v(), self.slope_ohm() + self.load_ohm);
        if self.truth.shorted {
            self.conducts = sign;
            self.load_a = line_v / (self.load_ohm + SHORT_OHM);
            return;
        }
        if self.conducts != 0.0 {
            let drop_v = self.conducts * knee_v;
            self.load_a = match self.load_h > 0.0 {
                true => {
                    let final_a = (line_v - drop_v) / ohms;
                    final_a + (self.load_a - final_a) * (-dt_s * ohms / self.load_h).exp()
                }
                false => (line_v - drop_v) / ohms,
            };
            if self.load_a * self.conducts < self.truth.holding_a {
                self.again = true;
                self.load_a = 0.0;
                self.conducts = 0.0;
                let slope = line_v.abs() / (SNUBBER_OHM * self.truth.capacitance_f) * 1e-9;
                let fails = slope > self.truth.commutation_v_per_us && line_v.abs() > 50.0;
                self.refire = if fails && !self.lit { sign } else { 0.0 };
            }
        }
        self.sign = sign;
        if self.conducts == 0.0 {
            self.fire(line_v, ohms);
        }
        if self.conducts == 0.0 {
            let slope = (line_v - self.line.volts(-0.5)) / 0.5e-6;
            self.load_a = self.leakage_a(line_v, slope);
        }
    }

    fn fire(&mut self, line_v: f64, ohms: f64) {
        if !self.lit {
            self.again &= self.refire != 0.0;
            if self.refire == 0.0 || self.refire != self.sign {
                self.refire = 0.0;
                return;
            }
        }
        if self.truth.half_wave && self.sign < 0.0 {
            return;
        }
        let amps = (line_v.abs() - self.knee_v()) / ohms;
        let least_v = if self.again {
            self.truth.retrigger_v
        } else {
            0.0
        };
        // A half cycle after conduction starts below the inhibit voltage, so that only the first one meets it.
        let enabled = line_v.abs() < self.truth.inhibit_v || self.again;
        if enabled && amps > self.truth.latching_a && line_v.abs() >= least_v {
            self.conducts = self.sign;
            self.again = true;
            self.load_a = if self.load_h > 0.0 {
                self.truth.latching_a * self.sign
            } else {
                amps * self.sign
            };
        }
    }

    /// Returns the longest step from now: to the next edge of the pulses, and short while the line is on.
    fn step_us(&self) -> u64 {
        let by_line = if self.has_line && self.is_ac() {
            STEP_US
        } else {
            100_000
        };
        let Drive::Pulses(pulses) = self.pulse else {
            return by_line;
        };
        let since_us = (self.now_us - self.pulse_from_us) as f64;
        let within_us = since_us.rem_euclid(pulses.period_us);
        let edge_us = if within_us < pulses.width_us {
            pulses.width_us
        } else {
            pulses.period_us
        };
        by_line.min(((edge_us - within_us).ceil() as u64).max(1))
    }
}

impl Circuit for SolidState {
    fn advance(&mut self, t_us: u64) {
        while self.now_us < t_us {
            let dt_us = self.step_us().min(t_us - self.now_us);
            let dt_s = dt_us as f64 * 1e-6;
            self.shine(dt_s);
            self.now_us += dt_us;
            self.line.advance(self.now_us);
            if self.has_line && self.is_ac() {
                self.commutate(dt_s);
            }
            self.warm(dt_s);
        }
    }

    fn drive(&mut self, terminal: Terminal, drive: Drive) {
        match terminal {
            Terminal::Input => self.input = drive,
            Terminal::Pulse => {
                self.pulse = drive;
                self.pulse_from_us = self.now_us;
            }
            Terminal::Output => self.output = drive,
            Terminal::Line => {
                self.has_line = matches!(drive, Drive::Sine { .. });
                self.line.drive(drive, self.now_us);
                if !self.has_line {
                    (self.conducts, self.again, self.load_a) = (0.0, false, 0.0);
                }
            }
            Terminal::Load | Terminal::Clamped => {}
        }
    }

    fn at(&mut self, terminal: Terminal) -> Reading {
        match terminal {
            Terminal::Input | Terminal::Pulse => self.at_input(),
            Terminal::Output if self.has_line => {
                let volts = match (self.truth.shorted, self.conducts) {
                    (true, _) => SHORT_OHM * self.load_a,
                    (false, 0.0) => self.line.volts(0.0) - self.load_a * self.load_ohm,
                    (false, sign) => sign * self.knee_v() + self.slope_ohm() * self.load_a,
                };
                Reading {
                    volts,
                    amps: self.load_a,
                }
            }
            Terminal::Output => {
                let closed = self.truth.shorted || self.lit && !self.is_ac();
                let ohms = if self.truth.shorted {
                    SHORT_OHM
                } else {
                    self.slope_ohm()
                };
                match (closed, self.output) {
                    (true, drive) => over_resistor(drive, ohms),
                    (false, Drive::Voltage { volts, limit_a }) => {
                        let amps = self.leakage_a(volts, 0.0).clamp(-limit_a, limit_a);
                        Reading { volts, amps }
                    }
                    (false, Drive::Current { amps, limit_v }) => {
                        let volts = limit_v.copysign(amps);
                        Reading {
                            volts,
                            amps: self.leakage_a(volts, 0.0),
                        }
                    }
                    (false, Drive::Open | Drive::Sine { .. } | Drive::Pulses(_)) => {
                        Reading::default()
                    }
                }
            }
            Terminal::Clamped => {
                let output = self.at(Terminal::Output);
                Reading {
                    volts: output.volts.clamp(-10.0, 10.0),
                    ..output
                }
            }
            Terminal::Line => Reading {
                volts: self.line.volts(0.0),
                amps: self.load_a,
            },
            Terminal::Load => {
                let output = self.at(Terminal::Output);
                let amps = self.through(output);
                Reading {
                    volts: amps * self.load_ohm,
                    amps,
                }
            }
        }
    }
}
