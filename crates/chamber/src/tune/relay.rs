//! Relay auto-tune: the power jumps between two values around a temperature, and the oscillation gives the settings.

use super::Settings;
use crate::statistics::mean;

/// Height of a jump of the power to either side of its mean, 1 = full heater.
const JUMP: f64 = 0.15;
/// Distance from the target at which the power jumps, K.
const BAND_K: f64 = 0.15;
/// Cycles before the measured ones, in which the tuning adjusts the mean power towards halves of equal length.
const SETTLING: usize = 6;
/// Cycles that the tuning measures.
const MEASURED: usize = 6;
/// Longest half of a cycle, s.
const LONGEST_S: u32 = 1800;

/// Why an auto-tune gives no settings.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RelayError {
    /// The temperature does not cross the band.
    #[error("found no crossing of {target_c:.1} C within {LONGEST_S} s")]
    NoOscillation {
        /// Centre of the band, C.
        target_c: f64,
    },
    /// The oscillation is no wider than the band.
    #[error("found an amplitude of {found_k:.2} K, expected more than {BAND_K} K")]
    TooSmall {
        /// Amplitude, K.
        found_k: f64,
    },
}

/// The oscillation that an auto-tune found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillation {
    /// Ultimate gain, 1/K.
    pub ultimate_per_k: f64,
    /// Standard uncertainty of the ultimate gain, from the scatter of the cycles, 1/K.
    pub u_ultimate_per_k: f64,
    /// Period, s.
    pub period_s: f64,
    /// Standard uncertainty of the period, from the scatter of the cycles, s.
    pub u_period_s: f64,
}

impl Oscillation {
    /// Returns the settings of the controller by the rule of [`Settings::from_oscillation`].
    pub fn settings(&self) -> Settings {
        Settings::from_oscillation(self.ultimate_per_k, self.period_s)
    }
}

/// Outcome of one second of an auto-tune.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// Signed power until the next second, for the split range.
    Go(f64),
    /// The oscillation is known.
    Done(Oscillation),
}

/// State of an auto-tune, stepped once a second.
#[derive(Debug, Clone, PartialEq)]
pub struct RelayTune {
    target_c: f64,
    mean: f64,
    high: bool,
    /// Seconds in the present half of a cycle, and in the one before.
    halves_s: [u32; 2],
    range_c: [f64; 2],
    cycles: Vec<Cycle>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Cycle {
    period_s: f64,
    amplitude_k: f64,
}

impl RelayTune {
    /// Starts in a chamber below or near `target_c`; `holding` is the power that about holds this temperature, 1 = full
    /// heater.
    pub fn new(target_c: f64, holding: f64) -> Self {
        Self {
            target_c,
            mean: holding,
            high: true,
            halves_s: [0; 2],
            range_c: [f64::INFINITY, f64::NEG_INFINITY],
            cycles: Vec::new(),
        }
    }

    /// Takes the reading of this second, C, and returns the power until the next one.
    ///
    /// # Errors
    /// Fails when the temperature does not oscillate; the caller switches off.
    pub fn step(&mut self, measured_c: f64) -> Result<Step, RelayError> {
        self.halves_s[0] += 1;
        if self.halves_s[0] > LONGEST_S {
            return Err(RelayError::NoOscillation {
                target_c: self.target_c,
            });
        }
        self.range_c = [
            self.range_c[0].min(measured_c),
            self.range_c[1].max(measured_c),
        ];
        let off = measured_c - self.target_c;
        if self.high && off > BAND_K || !self.high && off < -BAND_K {
            self.turn();
        }
        if self.cycles.len() == SETTLING + MEASURED {
            return self.oscillation().map(Step::Done);
        }
        let jump = if self.high { JUMP } else { -JUMP };
        Ok(Step::Go(self.mean + jump))
    }

    fn turn(&mut self) {
        self.high = !self.high;
        let [this, before] = self.halves_s;
        self.halves_s = [0, this];
        if !self.high {
            return;
        }
        // The half that ends here was low, the one before high.
        let period_s = f64::from(this + before);
        let amplitude_k = (self.range_c[1] - self.range_c[0]) / 2.0;
        self.cycles.push(Cycle {
            period_s,
            amplitude_k,
        });
        self.range_c = [f64::INFINITY, f64::NEG_INFINITY];
        if self.cycles.len() <= SETTLING {
            self.mean += 0.5 * JUMP * (f64::from(before) - f64::from(this)) / period_s;
        }
    }

    fn oscillation(&self) -> Result<Oscillation, RelayError> {
        let found = |of: fn(&Cycle) -> f64| {
            let all: Vec<f64> = self.cycles[SETTLING..].iter().map(of).collect();
            let middle = mean(&all);
            let squares: f64 = all.iter().map(|it| (it - middle).powi(2)).sum();
            let count = all.len() as f64;
            (middle, (squares / (count - 1.0) / count).sqrt())
        };
        let (found_k, u_k) = found(|it| it.amplitude_k);
        let (period_s, u_period_s) = found(|it| it.period_s);
        if found_k <= BAND_K {
            return Err(RelayError::TooSmall { found_k });
        }
        let swing_k = (found_k * found_k - BAND_K * BAND_K).sqrt();
        let ultimate_per_k = 4.0 * JUMP / (std::f64::consts::PI * swing_k);
        Ok(Oscillation {
            ultimate_per_k,
            u_ultimate_per_k: ultimate_per_k * found_k * u_k / (swing_k * swing_k),
            period_s,
            u_period_s,
        })
    }
}
