//! Line voltage from an AC source, with drift and distortion.

use std::f64::consts::{SQRT_2, TAU};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::circuit::Drive;
use crate::module::tolerances::stream;

/// Time constant of the slow drift, seconds.
const DRIFT_S: f64 = 5.0;
/// Interval between two draws of the drift, microseconds.
const DRIFT_STEP_US: u64 = 20_000;

/// Line that feeds the load circuit.
pub struct Line {
    drive: Drive,
    since_us: u64,
    rng: ChaCha8Rng,
    /// Relative deviation of the amplitude; the next field is the deviation of the frequency in hertz.
    amplitude: f64,
    deviation_hz: f64,
    phase_rad: f64,
    drawn_us: u64,
    real: bool,
}

impl Line {
    /// Creates a line without voltage; with `real` the voltage drifts by 1 % and has 2 % of third and fifth harmonics.
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
        if let Drive::Sine {
            phase_deg: Some(phase_deg),
            ..
        } = drive
        {
            self.phase_rad = phase_deg.to_radians();
        }
        self.drive = drive;
        self.since_us = now_us;
    }

    /// Checks whether a source is connected.
    pub fn is_on(&self) -> bool {
        matches!(self.drive, Drive::Sine { .. })
    }

    /// Advances phase and drift to `to_us`.
    pub fn advance(&mut self, to_us: u64) {
        let dt_s = (to_us - self.since_us) as f64 * 1e-6;
        self.since_us = to_us;
        if !self.is_on() {
            return;
        }
        self.phase_rad += self.omega() * dt_s;
        while self.real && self.drawn_us + DRIFT_STEP_US <= to_us {
            self.drawn_us += DRIFT_STEP_US;
            let keep = (-(DRIFT_STEP_US as f64) * 1e-6 / DRIFT_S).exp();
            let fresh = (1.0 - keep * keep).sqrt();
            let mut normal = || self.rng.sample::<f64, _>(StandardNormal);
            self.amplitude = keep * self.amplitude + fresh * 0.01 * normal();
            self.deviation_hz = keep * self.deviation_hz + fresh * 0.02 * normal();
        }
    }

    /// Returns the present phase, 0 to 360 degrees.
    pub fn phase_deg(&self) -> f64 {
        self.phase_rad.to_degrees().rem_euclid(360.0)
    }

    /// Returns the volts at `ahead_us` microseconds after the present instant; a negative time lies before it.
    pub fn volts(&self, ahead_us: f64) -> f64 {
        let Drive::Sine { rms_v, .. } = self.drive else {
            return 0.0;
        };
        let phase = self.phase_rad + self.omega() * ahead_us * 1e-6;
        let shape = match self.real {
            true => phase.sin() + 0.017 * (3.0 * phase).sin() + 0.01 * (5.0 * phase).sin(),
            false => phase.sin(),
        };
        SQRT_2 * rms_v * (1.0 + self.amplitude) * shape
    }

    /// Returns the angular frequency, radians per second.
    fn omega(&self) -> f64 {
        match self.drive {
            Drive::Sine { hz, .. } => TAU * (hz + self.deviation_hz),
            Drive::Open | Drive::Voltage { .. } | Drive::Current { .. } | Drive::Pulses(_) => 0.0,
        }
    }
}
