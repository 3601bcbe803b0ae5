//! A passive circuit: a resistor, an open or a short between the terminals, and a line with drift and distortion.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::circuit::{Circuit, Drive, Reading, Terminal, over_resistor};
use crate::module::tolerances::stream;

/// Time constant of the slow drift of a line, seconds.
const DRIFT_S: f64 = 5.0;
/// Interval at which the drift is drawn, microseconds.
const DRIFT_STEP_US: u64 = 20_000;

/// Voltage of an AC source with drift and distortion.
pub struct Line {
    drive: Drive,
    since_us: u64,
    rng: ChaCha8Rng,
    /// Relative deviation of the amplitude, and of the frequency in hertz.
    amplitude: f64,
    deviation_hz: f64,
    phase_rad: f64,
    drawn_us: u64,
    real: bool,
}

impl Line {
    /// Creates a line without voltage; a real one drifts by 1 % and has 2 % of third and fifth harmonic.
    pub fn new(seed: u64, real: bool) -> Self {
        Self {
            drive: Drive::Open,
            since_us: 0,
            rng: stream(seed, "line"),
            amplitude: 0.0,
            deviation_hz: 0.0,
            phase_rad: 0.0,
            drawn_us: 0,
            real,
        }
    }

    /// Connects a source at `now_us`.
    pub fn drive(&mut self, drive: Drive, now_us: u64) {
        if let Drive::Sine { phase_deg, .. } = drive {
            self.phase_rad = phase_deg.to_radians();
        }
        self.drive = drive;
        self.since_us = now_us;
    }

    /// Advances phase and drift to `to_us`.
    pub fn advance(&mut self, to_us: u64) {
        let Drive::Sine { hz, .. } = self.drive else {
            self.since_us = to_us;
            return;
        };
        let dt_s = (to_us - self.since_us) as f64 * 1e-6;
        self.since_us = to_us;
        self.phase_rad += std::f64::consts::TAU * (hz + self.deviation_hz) * dt_s;
        while self.real && self.drawn_us + DRIFT_STEP_US <= to_us {
            self.drawn_us += DRIFT_STEP_US;
            let keep = (-(DRIFT_STEP_US as f64) * 1e-6 / DRIFT_S).exp();
            let fresh = (1.0 - keep * keep).sqrt();
            let mut normal = || self.rng.sample::<f64, _>(StandardNormal);
            self.amplitude = keep * self.amplitude + fresh * 0.01 * normal();
            self.deviation_hz = keep * self.deviation_hz + fresh * 0.02 * normal();
        }
    }

    /// Returns angular frequency, radians per second.
    pub fn omega(&self) -> f64 {
        match self.drive {
            Drive::Sine { hz, .. } => std::f64::consts::TAU * (hz + self.deviation_hz),
            _ => 0.0,
        }
    }

    /// Returns the volts `ahead_us` after the present instant.
    pub fn volts(&self, ahead_us: f64) -> f64 {
        let Drive::Sine { rms_v, .. } = self.drive else {
            return 0.0;
        };
        let phase = self.phase_rad + self.omega() * ahead_us * 1e-6;
        let shape = match self.real {
            true => phase.sin() + 0.017 * (3.0 * phase).sin() + 0.01 * (5.0 * phase).sin(),
            false => phase.sin(),
        };
        std::f64::consts::SQRT_2 * rms_v * (1.0 + self.amplitude) * shape
    }
}

/// One resistance at the input, one at the output, one in the load circuit.
pub struct Passive {
    /// Resistance between the input terminals, ohms.
    pub input_ohm: f64,
    /// Resistance between the output terminals, ohms.
    pub output_ohm: f64,
    /// Resistance of the load, ohms.
    pub load_ohm: f64,
    line: Line,
    input: Drive,
    pulse: Drive,
    output: Drive,
    pulse_from_us: u64,
    now_us: u64,
}

impl Passive {
    /// Creates a circuit; infinity means open, 0 a short.
    pub fn new(input_ohm: f64, output_ohm: f64, load_ohm: f64, line: Line) -> Self {
        Self {
            input_ohm,
            output_ohm,
            load_ohm,
            line,
            input: Drive::Open,
            pulse: Drive::Open,
            output: Drive::Open,
            pulse_from_us: 0,
            now_us: 0,
        }
    }

    fn line_current(&self) -> f64 {
        self.line.volts(0.0) / (self.load_ohm + self.output_ohm)
    }
}

impl Circuit for Passive {
    fn advance(&mut self, t_us: u64) {
        self.now_us = t_us;
        self.line.advance(t_us);
    }

    fn drive(&mut self, terminal: Terminal, drive: Drive) {
        match terminal {
            Terminal::Input => self.input = drive,
            Terminal::Pulse => {
                self.pulse = drive;
                self.pulse_from_us = self.now_us;
            }
            Terminal::Output => self.output = drive,
            Terminal::Line => self.line.drive(drive, self.now_us),
            Terminal::Load | Terminal::Clamped => {}
        }
    }

    fn at(&mut self, terminal: Terminal) -> Reading {
        let amps = self.line_current();
        match terminal {
            Terminal::Input => over_resistor(self.input, self.input_ohm),
            Terminal::Pulse => {
                let since_us = (self.now_us - self.pulse_from_us) as f64;
                let volts = pulse_volts(self.pulse, since_us).unwrap_or(0.0);
                Reading {
                    volts,
                    amps: volts / self.input_ohm,
                }
            }
            Terminal::Output => match self.output {
                Drive::Open => Reading {
                    volts: across(amps, self),
                    amps,
                },
                drive => over_resistor(drive, self.output_ohm),
            },
            Terminal::Clamped => Reading {
                volts: across(amps, self).clamp(-10.0, 10.0),
                amps,
            },
            Terminal::Line => Reading {
                volts: self.line.volts(0.0),
                amps,
            },
            Terminal::Load => Reading {
                volts: amps * self.load_ohm,
                amps,
            },
        }
    }
}

/// Returns the voltage over the output; an open output carries the whole line.
fn across(amps: f64, circuit: &Passive) -> f64 {
    match circuit.output_ohm.is_finite() {
        true => amps * circuit.output_ohm,
        false => circuit.line.volts(0.0),
    }
}

/// Returns the volts of a pulse source; `None` while it is not connected.
pub(super) fn pulse_volts(drive: Drive, since_us: f64) -> Option<f64> {
    match drive {
        Drive::Pulses(pulses) => Some(pulses.volts(since_us)),
        Drive::Voltage { volts, .. } => Some(volts),
        Drive::Open | Drive::Current { .. } | Drive::Sine { .. } => None,
    }
}
