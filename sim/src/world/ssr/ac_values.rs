//! Derives the figures of an AC relay from its true values, by the definitions of the truth file.
//!
//! Drop, offset, half-wave share and distortion hold for the rated current from a loop of low voltage; leakage and
//! times hold for the nominal line.

use std::f64::consts::{FRAC_2_PI, SQRT_2, TAU};

use super::values::{DRIFT_MS, Values, WarmUp};
use crate::scpi::relay::{Heat, Kind};

/// Temperature coefficient of the threshold voltage, volts per kelvin.
const KNEE_V_PER_K: f64 = -1.5e-3;
/// Number of points of the computed cycle of the on-state. The output jumps when it fires, between two of them; at 720
/// points the distortion of a part that fires at 4 V would err by up to 2 %.
const POINTS: u32 = 36_000;

/// One computed cycle of the conducting output at the rated current.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct OnCycle {
    /// Mean voltage over the output, volts.
    pub offset_v: f64,
    /// Rms of the voltage over the output without its fundamental, volts.
    pub distortion_v: f64,
    /// Difference of the charges of both half cycles over their sum.
    pub halfwave: f64,
}

impl Values {
    /// Returns the threshold voltages of the conducting output, volts: positive and negative direction.
    pub fn knee_v(&self, celsius: f64) -> [f64; 2] {
        let change_v = KNEE_V_PER_K * (celsius - 25.0);
        self.model.knee_v.map(|knee_v| knee_v + change_v)
    }

    /// Returns the mean threshold voltage of both directions, volts.
    fn mean_knee_v(&self, celsius: f64) -> f64 {
        let [positive, negative] = self.knee_v(celsius);
        0.5 * (positive + negative)
    }

    fn peak_a(&self) -> f64 {
        SQRT_2 * self.rated.load_a
    }

    /// Returns the peak of the drop at the rated current, the mean of both directions, volts.
    pub fn peak_drop_v(&self, celsius: f64) -> f64 {
        self.mean_knee_v(celsius) + self.model.slope_ohm(celsius) * self.peak_a()
    }

    /// Returns the rms drop at the rated current, volts. The wait for firing at the beginning of each half cycle does
    /// not count.
    pub fn rms_drop_v(&self, celsius: f64) -> f64 {
        let slope_v = self.model.slope_ohm(celsius) * self.peak_a();
        let squared = |knee_v: f64| {
            knee_v * knee_v + 2.0 * knee_v * FRAC_2_PI * slope_v + 0.5 * slope_v * slope_v
        };
        let [positive, negative] = self.knee_v(celsius).map(squared);
        (0.5 * (positive + negative)).sqrt()
    }

    /// Returns the mean power at the rated current, watts.
    fn on_watts(&self, celsius: f64) -> f64 {
        let peak_a = self.peak_a();
        let by_slope_w = 0.5 * self.model.slope_ohm(celsius) * peak_a * peak_a;
        self.mean_knee_v(celsius) * FRAC_2_PI * peak_a + by_slope_w
    }

    /// Computes how the rated current warms the cold part.
    pub fn ac_warm_up(&self) -> WarmUp {
        let mut heat = Heat::default();
        let celsius = |heat: &Heat| self.celsius + heat.kelvin();
        let mut first_v = f64::NAN;
        for ms in 1..=DRIFT_MS[1] {
            let watts = self.on_watts(celsius(&heat));
            heat.advance(watts, self.model.junction_k_per_w, 1e-3);
            if ms == DRIFT_MS[0] {
                first_v = self.peak_drop_v(celsius(&heat));
            }
        }
        WarmUp {
            drift_v: self.peak_drop_v(celsius(&heat)) - first_v,
            junction_c: celsius(&heat),
        }
    }

    /// Returns the cycle at the rated current through a loop of this resistance, ohms.
    pub fn on_cycle(&self, loop_ohm: f64) -> OnCycle {
        let (knees_v, slope_ohm) = (
            self.knee_v(self.celsius),
            self.model.slope_ohm(self.celsius),
        );
        let peak_v = self.peak_a() * (loop_ohm + slope_ohm) + self.mean_knee_v(self.celsius);
        let (mut sum, mut sine, mut cosine, mut squares) = (0.0, 0.0, 0.0, 0.0);
        let mut charges = [0.0; 2];
        for n in 0..POINTS {
            let (sin, cos) = (TAU * (f64::from(n) + 0.5) / f64::from(POINTS)).sin_cos();
            let (line_v, place) = (peak_v * sin, usize::from(n >= POINTS / 2));
            let amps = (line_v.abs() - knees_v[place]) / (loop_ohm + slope_ohm);
            let rises = (n % (POINTS / 2)) < POINTS / 4;
            let waits = rises && line_v.abs() < self.model.retrigger_v;
            let blocks = amps < self.model.holding_a || waits;
            let blocks = blocks || self.model.half_wave && place == 1;
            let volts = match blocks {
                true => line_v,
                false => (knees_v[place] + slope_ohm * amps).copysign(line_v),
            };
            charges[place] += if blocks { 0.0 } else { amps };
            sum += volts;
            sine += volts * sin;
            cosine += volts * cos;
            squares += volts * volts;
        }
        let mean = |sum: f64| sum / f64::from(POINTS);
        let fundamental = 2.0 * (mean(sine).powi(2) + mean(cosine).powi(2));
        OnCycle {
            offset_v: mean(sum),
            distortion_v: (mean(squares) - fundamental).max(0.0).sqrt(),
            halfwave: (charges[0] - charges[1]).abs() / (charges[0] + charges[1]),
        }
    }

    /// Returns the capacitive part of the leakage at the nominal line, amperes rms.
    pub fn capacitive_a(&self) -> f64 {
        TAU * self.rated.hz * self.model.capacitance_f * self.rated.blocked_v
    }

    /// Returns the resistive part of the leakage at the nominal line, amperes rms.
    pub fn resistive_a(&self, celsius: f64) -> f64 {
        self.blocked_siemens(celsius) * self.rated.blocked_v
    }

    /// Returns the whole leakage at the nominal line, amperes rms.
    pub fn leakage_a(&self, celsius: f64) -> f64 {
        self.resistive_a(celsius).hypot(self.capacitive_a())
    }

    /// Returns the highest voltage over the output at which it can turn on, volts.
    pub fn zero_cross_v(&self) -> f64 {
        self.model.inhibit_v.min(SQRT_2 * self.rated.blocked_v)
    }

    /// Returns the turn-on time, seconds. For an output that fires at any phase, it counts from the control edge. For a
    /// zero-cross relay, the control edge comes at the peak of the blocked voltage, and the time counts from the first
    /// zero after it; negative before that zero.
    pub fn ac_turn_on_s(&self) -> f64 {
        let delay_s = self.turn_on_s();
        if self.model.kind == Kind::AcRandom {
            return delay_s;
        }
        let quarter_s = 0.25 / self.rated.hz;
        if self.model.inhibit_v.is_infinite() {
            return delay_s - quarter_s;
        }
        let window = (self.model.inhibit_v / (SQRT_2 * self.rated.blocked_v)).min(1.0);
        let early_s = window.asin() / (TAU * self.rated.hz);
        self.half_cycles(delay_s - quarter_s + early_s) - early_s
    }

    /// Returns the turn-off time, seconds: the control pulse ends at the peak of the current, and the time counts from
    /// the first current zero after that to the end of the current.
    pub fn ac_turn_off_s(&self) -> f64 {
        self.half_cycles(self.turn_off_s() - 0.25 / self.rated.hz)
    }

    /// Rounds a time up to whole half cycles, seconds.
    fn half_cycles(&self, after_s: f64) -> f64 {
        let half_s = 0.5 / self.rated.hz;
        (after_s / half_s).ceil().max(0.0) * half_s
    }
}
