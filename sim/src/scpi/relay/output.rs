//! A solid-state relay in its circuit, simulated step by step: light, firing, current zeros, heat.

use super::heat::Heat;
use super::light::Light;
use super::truth::{Kind, REFERENCE_C, Truth};
use crate::scpi::circuit::{Circuit, Drive, Reading, Terminal, over_resistor};
use crate::scpi::line::Line;
use crate::scpi::passive::clamped;
use crate::scpi::sources::Sources;

/// Longest time step while the line is on, microseconds; the next constant applies while it is off.
const STEP_US: u64 = 20;
const IDLE_STEP_US: u64 = 100_000;
/// Resistance of a shorted output, ohms.
const SHORT_OHM: f64 = 0.1;
/// Least voltage returning at a current zero that can fire the output again, volts.
const COMMUTATION_V: f64 = 50.0;

/// A relay with its sources and its state.
pub struct SolidState {
    truth: Truth,
    sources: Sources,
    load_ohm: f64,
    load_h: f64,
    light: Light,
    /// Sign of the half cycle that conducts, 0 while blocked.
    conducts: f64,
    /// True when the previous half cycle conducted: this one then fires at the retrigger voltage.
    again: bool,
    /// Sign of the half cycle that fires without light after a failed commutation; 0 for none.
    refire: f64,
    load_a: f64,
    heat: Heat,
}

impl SolidState {
    /// Puts a cold relay into its circuit.
    pub fn new(truth: Truth, line: Line, load_ohm: f64, load_h: f64) -> Self {
        Self {
            truth,
            sources: Sources::new(line),
            load_ohm,
            load_h,
            light: Light::default(),
            conducts: 0.0,
            again: false,
            refire: 0.0,
            load_a: 0.0,
            heat: Heat::default(),
        }
    }

    /// Returns the junction's temperature, degrees Celsius.
    pub fn temperature_c(&self) -> f64 {
        REFERENCE_C + self.heat.kelvin()
    }

    fn is_ac(&self) -> bool {
        self.truth.kind != Kind::Dc
    }

    fn has_line(&self) -> bool {
        self.sources.line.is_on()
    }

    /// Returns voltage and current at the input.
    fn at_input(&self) -> Reading {
        self.truth
            .at_input(self.sources.at_input(), self.temperature_c())
    }

    /// Moves the light towards the value of the input current; the exponential is exact for a constant input.
    fn shine(&mut self, dt_s: f64) {
        let threshold_a = self.truth.threshold_at(self.temperature_c());
        let goal = self.at_input().amps.max(0.0) / threshold_a;
        self.light.advance(goal, &self.truth, dt_s);
    }

    fn warm(&mut self, dt_s: f64) {
        let output = self.at(Terminal::Output);
        let watts = output.volts * self.through(output);
        self.heat.advance(watts, self.truth.junction_k_per_w, dt_s);
    }

    fn through(&self, output: Reading) -> f64 {
        if self.has_line() {
            self.load_a
        } else {
            output.amps
        }
    }

    /// Returns the knee voltage for the given sign of the current, volts.
    fn knee_v(&self, sign: f64) -> f64 {
        let knee_v = self.truth.knee_v[usize::from(sign < 0.0)];
        knee_v - 1.5e-3 * (self.temperature_c() - REFERENCE_C)
    }

    fn slope_ohm(&self) -> f64 {
        self.truth.slope_ohm(self.temperature_c())
    }

    /// Returns the current through the blocked output at a voltage with the given slope, amperes.
    fn leakage_a(&self, volts: f64, slope_v_per_s: f64) -> f64 {
        let junction =
            self.truth.leakage_a * 2f64.powf((self.temperature_c() - REFERENCE_C) / 10.0);
        self.truth.capacitance_f * slope_v_per_s
            + volts / self.truth.leakage_ohm
            + junction * (volts / 0.1).tanh()
    }

    /// Returns the current of the blocked output in series with the load, amperes. The capacitance charges through the
    /// load, so the output voltage lags the line by the RC time constant, which is short against a cycle.
    fn blocked_a(&self) -> f64 {
        let lag_us = self.load_ohm * self.truth.capacitance_f * 1e6;
        let line_v = |ahead_us: f64| self.sources.line.volts(ahead_us - lag_us);
        let slope_v_per_s = (line_v(0.5) - line_v(-0.5)) / 1e-6;
        self.leakage_a(line_v(0.0), slope_v_per_s)
    }

    /// Lets the triac fire, conduct or go off, and moves the load current.
    fn commutate(&mut self, dt_s: f64) {
        let line_v = self.sources.line.volts(0.0);
        if self.truth.shorted {
            self.load_a = line_v / (self.load_ohm + SHORT_OHM);
            return;
        }
        let ohms = self.slope_ohm() + self.load_ohm;
        if self.conducts != 0.0 {
            let final_a = (line_v - self.conducts * self.knee_v(self.conducts)) / ohms;
            let kept = match self.load_h > 0.0 {
                true => (-dt_s * ohms / self.load_h).exp(),
                false => 0.0,
            };
            self.load_a = final_a + (self.load_a - final_a) * kept;
            if self.load_a * self.conducts < self.truth.holding_a {
                self.again = true;
                self.conducts = 0.0;
                let fails = !self.light.is_lit() && self.fails_to_commutate(line_v);
                self.refire = if fails { line_v.signum() } else { 0.0 };
            }
        }
        if self.conducts == 0.0 {
            self.fire(line_v, ohms);
        }
        if self.conducts == 0.0 {
            self.load_a = self.blocked_a();
        }
    }

    /// Checks whether the voltage that returns at a current zero rises too fast for the triac to block. An inductive
    /// load and the capacitance over the output make it swing up; over a resistive load it returns with the line.
    fn fails_to_commutate(&self, line_v: f64) -> bool {
        let swing_s = (self.load_h * self.truth.capacitance_f).sqrt();
        line_v.abs() > COMMUTATION_V
            && line_v.abs() * 1e-6 > self.truth.commutation_v_per_us * swing_s
    }

    fn fire(&mut self, line_v: f64, ohms: f64) {
        let sign = line_v.signum();
        if !self.light.is_lit() && self.refire != sign {
            (self.again, self.refire) = (false, 0.0);
            return;
        }
        if self.truth.half_wave && sign < 0.0 {
            return;
        }
        let amps = (line_v.abs() - self.knee_v(sign)) / ohms;
        let least_v = if self.again {
            self.truth.retrigger_v
        } else {
            0.0
        };
        // After a conducting half cycle the line starts below the inhibit voltage: only the first half cycle meets this
        // limit.
        let enabled = line_v.abs() < self.truth.inhibit_v || self.again;
        if enabled && amps > self.truth.latching_a && line_v.abs() >= least_v {
            self.conducts = sign;
            self.again = true;
            self.load_a = if self.load_h > 0.0 {
                self.truth.latching_a * sign
            } else {
                amps * sign
            };
        }
    }

    /// Returns the longest permitted time step, microseconds: up to the next edge of the pulses, and short while the
    /// line is on.
    fn step_us(&self) -> u64 {
        let by_line = if self.has_line() && self.is_ac() {
            STEP_US
        } else {
            IDLE_STEP_US
        };
        self.sources.edge_us().unwrap_or(by_line).min(by_line)
    }

    /// Returns the operating point of the output while no line feeds it.
    fn without_line(&self) -> Reading {
        let source = self.sources.output;
        if self.truth.shorted {
            return over_resistor(source, SHORT_OHM);
        }
        if self.light.is_lit() && !self.is_ac() {
            return over_resistor(source, self.slope_ohm());
        }
        match source {
            Drive::Voltage { volts, limit_a, .. } => {
                let amps = self.leakage_a(volts, 0.0).clamp(-limit_a, limit_a);
                Reading { volts, amps }
            }
            Drive::Current { amps, limit_v } => {
                // Below the leakage at the voltage limit, voltage and current decrease in proportion.
                let limit_v = limit_v.copysign(amps);
                let leakage_a = self.leakage_a(limit_v, 0.0);
                let part = (amps / leakage_a).min(1.0);
                Reading {
                    volts: part * limit_v,
                    amps: part * leakage_a,
                }
            }
            Drive::Open | Drive::Sine { .. } | Drive::Pulses(_) => Reading::default(),
        }
    }
}

impl Circuit for SolidState {
    fn advance(&mut self, t_us: u64) {
        while self.sources.now_us < t_us {
            let from_us = self.sources.now_us;
            let dt_us = self.step_us().min(t_us - from_us);
            let dt_s = dt_us as f64 * 1e-6;
            self.shine(dt_s);
            self.sources.advance(from_us + dt_us);
            if self.has_line() && self.is_ac() {
                self.commutate(dt_s);
            }
            self.warm(dt_s);
        }
    }

    fn drive(&mut self, terminal: Terminal, drive: Drive) {
        self.sources.connect(terminal, drive);
        if !self.has_line() {
            (self.conducts, self.again) = (0.0, false);
            (self.refire, self.load_a) = (0.0, 0.0);
        }
    }

    fn at(&self, terminal: Terminal) -> Reading {
        let amps = self.load_a;
        let line_v = self.sources.line.volts(0.0);
        match terminal {
            Terminal::Input | Terminal::Pulse => self.at_input(),
            Terminal::Output | Terminal::Socket if self.has_line() => {
                let volts = match (self.truth.shorted, self.conducts) {
                    (true, _) => SHORT_OHM * amps,
                    (false, 0.0) => line_v - amps * self.load_ohm,
                    (false, sign) => sign * self.knee_v(sign) + self.slope_ohm() * amps,
                };
                Reading { volts, amps }
            }
            Terminal::Output | Terminal::Socket => self.without_line(),
            Terminal::Clamped => {
                let output = self.at(Terminal::Output);
                Reading {
                    volts: clamped(output.volts),
                    ..output
                }
            }
            Terminal::Line => Reading {
                volts: line_v,
                amps,
            },
            Terminal::Load | Terminal::Shunt => {
                let amps = self.through(self.at(Terminal::Output));
                Reading {
                    volts: amps * self.load_ohm,
                    amps,
                }
            }
        }
    }

    fn line_deg(&self) -> f64 {
        self.sources.line.phase_deg()
    }
}
