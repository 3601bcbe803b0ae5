//! Line voltage from an AC source, with drift and distortion.
//!
//! Amplitude, frequency and length of a cycle change at the beginning of the cycle, where the voltage is 0. Inside a
//! cycle the voltage has a closed form.

use std::f64::consts::{SQRT_2, TAU};

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::circuit::Drive;
use crate::module::tolerances::stream;

/// Deviations of a line from a sine; standard deviations unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unrest {
    /// Slow relative deviation of the amplitude.
    pub amplitude: f64,
    /// Slow deviation of the frequency, hertz.
    pub hz: f64,
    /// Time constant of the slow deviations of amplitude and frequency, seconds.
    pub slow_s: f64,
    /// Third and fifth harmonic, relative to the fundamental, in phase with it.
    pub harmonics: [f64; 2],
    /// Phase noise from cycle to cycle, microseconds.
    pub jitter_us: f64,
}

impl Unrest {
    /// A perfect sine.
    pub const NONE: Self = Self {
        amplitude: 0.0,
        hz: 0.0,
        slow_s: 5.0,
        harmonics: [0.0; 2],
        jitter_us: 0.0,
    };
    /// A usual line: 1 % of drift, 2 % of distortion.
    pub const USUAL: Self = Self {
        amplitude: 0.01,
        hz: 0.02,
        slow_s: 5.0,
        harmonics: [0.017, 0.01],
        jitter_us: 10.0,
    };
    /// Limit of a deviation, in standard deviations.
    const MOST: f64 = 2.5;
}

/// One cycle of the line, from its rising zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cycle {
    /// Instant of the zero at which the cycle begins, microseconds.
    pub zero_us: f64,
    /// Angular frequency, radians per microsecond; 0 without voltage.
    pub omega: f64,
    /// Peak of the fundamental, volts.
    pub peak_v: f64,
    /// Third and fifth harmonic, relative to the fundamental.
    pub harmonics: [f64; 2],
}

impl Cycle {
    /// A line without voltage.
    const NONE: Self = Self {
        zero_us: 0.0,
        omega: 0.0,
        peak_v: 0.0,
        harmonics: [0.0; 2],
    };

    /// Returns the volts at an instant, microseconds.
    pub fn volts(&self, t_us: f64) -> f64 {
        let sin = self.phase_rad(t_us).sin();
        let squared = sin * sin;
        let third = 3.0 - 4.0 * squared;
        let fifth = 5.0 - squared * (20.0 - 16.0 * squared);
        self.peak_v * sin * (1.0 + self.harmonics[0] * third + self.harmonics[1] * fifth)
    }

    /// Returns the phase at an instant, radians since the beginning of the cycle.
    pub fn phase_rad(&self, t_us: f64) -> f64 {
        self.omega * (t_us - self.zero_us)
    }

    /// Returns the instant at which the cycle ends, microseconds; infinite without voltage.
    pub fn end_us(&self) -> f64 {
        match self.omega > 0.0 {
            true => self.zero_us + TAU / self.omega,
            false => f64::INFINITY,
        }
    }
}

/// Line that feeds the load circuit.
#[derive(Debug, Clone)]
pub struct Line {
    drive: Drive,
    unrest: Unrest,
    rng: ChaCha8Rng,
    now_us: f64,
    cycle: Cycle,
    /// Phase at which the last source was disconnected, radians.
    rest_rad: f64,
    /// Present deviation of the amplitude (relative); the next fields are those of frequency (hertz) and phase
    /// (microseconds).
    amplitude: f64,
    deviation_hz: f64,
    jitter_us: f64,
}

impl Line {
    /// Creates a line without voltage.
    pub fn new(seed: u64, unrest: Unrest) -> Self {
        let mut line = Self {
            drive: Drive::Open,
            unrest,
            rng: stream(seed, "line"),
            now_us: 0.0,
            cycle: Cycle::NONE,
            rest_rad: 0.0,
            amplitude: 0.0,
            deviation_hz: 0.0,
            jitter_us: 0.0,
        };
        line.amplitude = unrest.amplitude * line.normal();
        line.deviation_hz = unrest.hz * line.normal();
        line
    }

    fn normal(&mut self) -> f64 {
        let drawn = self.rng.sample::<f64, _>(StandardNormal);
        drawn.clamp(-Unrest::MOST, Unrest::MOST)
    }

    /// Connects a source at `now_us`; the phase continues unless the source sets it.
    pub fn drive(&mut self, drive: Drive, now_us: f64) {
        self.advance(now_us);
        let phase_rad = self.phase_rad();
        (self.drive, self.rest_rad) = (drive, phase_rad);
        self.cycle = match drive {
            Drive::Sine { phase_deg, .. } => {
                let phase_rad = phase_deg.map_or(phase_rad, f64::to_radians);
                let mut cycle = self.cycle_at(now_us);
                cycle.zero_us = now_us - phase_rad.rem_euclid(TAU) / cycle.omega;
                cycle
            }
            Drive::Open | Drive::Voltage { .. } | Drive::Current { .. } | Drive::Pulses(_) => {
                Cycle::NONE
            }
        };
    }

    /// Checks whether a source is connected.
    pub fn is_on(&self) -> bool {
        matches!(self.drive, Drive::Sine { .. })
    }

    /// Advances to `to_us`; each cycle that begins draws its deviations.
    pub fn advance(&mut self, to_us: f64) {
        self.now_us = to_us;
        while self.cycle.end_us() <= to_us {
            let zero_us = self.cycle.end_us();
            self.drift(1e-6 * (zero_us - self.cycle.zero_us));
            self.cycle = self.cycle_at(zero_us);
            let jitter_us = self.unrest.jitter_us * self.normal();
            let longer_us = jitter_us - std::mem::replace(&mut self.jitter_us, jitter_us);
            self.cycle.omega = TAU / (TAU / self.cycle.omega + longer_us);
        }
    }

    fn drift(&mut self, dt_s: f64) {
        let keep = (-dt_s / self.unrest.slow_s).exp();
        let fresh = (1.0 - keep * keep).sqrt();
        self.amplitude = keep * self.amplitude + fresh * self.unrest.amplitude * self.normal();
        self.deviation_hz = keep * self.deviation_hz + fresh * self.unrest.hz * self.normal();
        let most_hz = Unrest::MOST * self.unrest.hz;
        self.deviation_hz = self.deviation_hz.clamp(-most_hz, most_hz);
    }

    /// Returns a cycle that begins at an instant, with the present source and deviations.
    fn cycle_at(&self, zero_us: f64) -> Cycle {
        let Drive::Sine { rms_v, hz, .. } = self.drive else {
            return Cycle::NONE;
        };
        Cycle {
            zero_us,
            omega: TAU * (hz + self.deviation_hz) * 1e-6,
            peak_v: SQRT_2 * rms_v * (1.0 + self.amplitude),
            harmonics: self.unrest.harmonics,
        }
    }

    /// Returns the present cycle.
    pub fn cycle(&self) -> Cycle {
        self.cycle
    }

    fn phase_rad(&self) -> f64 {
        match self.is_on() {
            true => self.cycle.phase_rad(self.now_us),
            false => self.rest_rad,
        }
    }

    /// Returns the present phase, 0 to 360 degrees.
    pub fn phase_deg(&self) -> f64 {
        self.phase_rad().to_degrees().rem_euclid(360.0)
    }

    /// Returns the volts at `ahead_us` microseconds after the present instant; a negative time lies before it.
    pub fn volts(&self, ahead_us: f64) -> f64 {
        self.cycle.volts(self.now_us + ahead_us)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SINE: Drive = Drive::Sine {
        rms_v: 230.0,
        hz: 50.0,
        phase_deg: Some(0.0),
    };

    #[test]
    fn a_quiet_line_is_a_sine() {
        let mut line = Line::new(1, Unrest::NONE);
        line.drive(SINE, 0.0);
        for (t_us, volts) in [
            (5_000.0, 325.269),
            (45_000.0, 325.269),
            (55_000.0, -325.269),
        ] {
            line.advance(t_us);
            assert!((line.volts(0.0) - volts).abs() < 1e-3, "{t_us}");
        }
    }

    #[test]
    fn an_unquiet_line_stays_continuous_and_near_its_rating() {
        let mut line = Line::new(1, Unrest::USUAL);
        line.drive(SINE, 0.0);
        let (mut peaks, mut lengths, mut zero_us) = (Vec::new(), Vec::new(), 0.0);
        for n in 1..=50_000u32 {
            line.advance(f64::from(n) * 2_000.0);
            let cycle = line.cycle();
            if cycle.zero_us > zero_us {
                lengths.push(cycle.zero_us - zero_us);
                peaks.push(cycle.peak_v);
                assert!(cycle.volts(cycle.zero_us).abs() < 1e-9);
                zero_us = cycle.zero_us;
            }
        }
        let n = peaks.len() as f64;
        let (mean_v, mean_us) = (
            peaks.iter().sum::<f64>() / n,
            lengths.iter().sum::<f64>() / n,
        );
        assert!((mean_v / 325.27 - 1.0).abs() < 0.005, "{mean_v}");
        assert!((mean_us - 20_000.0).abs() < 10.0, "{mean_us}");
        let furthest = lengths.iter().map(|us| (us - mean_us).abs());
        let furthest_us = furthest.fold(0.0, f64::max);
        assert!((20.0..75.0).contains(&furthest_us), "{furthest_us}");
    }
}
