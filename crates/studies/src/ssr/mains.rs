//! AC parts at the mains: voltage at turn-on, parts of the leakage, drop.

use super::scope::Scope;
use super::{Dice, normal, row, uniform};
use crate::figure::{Bar, Figure};
use machine::dut::ssr::wave::pulses::{Output, Pulse};
use machine::dut::ssr::wave::split::{Admittance, phasor};
use machine::dut::ssr::wave::{Channel, drop_line, mains::Mains};
use std::f64::consts::{SQRT_2, TAU};

/// Nominal voltage of the mains, V rms.
const MAINS_V: f64 = 230.0;
/// Nominal frequency of the mains, Hz.
const HZ: f64 = 50.0;
/// Amplitudes of the third and fifth harmonic, as shares of the fundamental.
const HARMONICS: (f64, f64) = (0.017, 0.01);
/// Pulses of a train. Their period makes each pulse begin at another phase of a half cycle.
const PULSES: u32 = 6;
/// Drop of the conducting output, V.
const DROP_V: f64 = 1.1;
/// Greatest voltage across an output that counts as conducting, V.
const ON_V: f64 = 3.2;
/// Voltage at which the input of the channel for the drop clamps, V.
const CLAMP_V: f64 = 10.0;
/// Time to read one sample of two channels, s.
const READ_S: f64 = 1.6e-6;

/// One line: amplitude, frequency and phase.
#[derive(Clone, Copy)]
struct Line {
    peak_v: f64,
    hz: f64,
    phase: f64,
}

impl Line {
    fn drawn(dice: &mut Dice) -> Self {
        Self {
            peak_v: MAINS_V * SQRT_2 * normal(dice, 1.0, 0.01),
            hz: normal(dice, HZ, 0.02),
            phase: uniform(dice, 0.0, TAU),
        }
    }

    /// Returns the voltage at a time, V.
    fn at(&self, at_s: f64) -> f64 {
        let turn = TAU * self.hz * at_s + self.phase;
        let (third, fifth) = HARMONICS;
        self.peak_v * (turn.sin() + third * (3.0 * turn).sin() + fifth * (5.0 * turn).sin())
    }

    /// Returns the rise of the voltage at a time, V/s.
    fn slope(&self, at_s: f64) -> f64 {
        const NEAR_S: f64 = 1e-7;
        (self.at(at_s + NEAR_S) - self.at(at_s - NEAR_S)) / (2.0 * NEAR_S)
    }

    /// Returns the first time from `from_s` on at which the voltage is within `volts` of 0. The harmonics pass through
    /// 0 together with the fundamental.
    fn below(&self, from_s: f64, volts: f64) -> f64 {
        if self.at(from_s).abs() <= volts {
            return from_s;
        }
        let (mut low_s, mut high_s) = (from_s, self.zero_after(from_s));
        for _ in 0..40 {
            let middle_s = f64::midpoint(low_s, high_s);
            match self.at(middle_s).abs() > volts {
                true => low_s = middle_s,
                false => high_s = middle_s,
            }
        }
        high_s
    }

    /// Returns the first zero after a time, s.
    fn zero_after(&self, at_s: f64) -> f64 {
        let halves = (2.0 * self.hz * at_s + self.phase / (TAU / 2.0)).floor() + 1.0;
        (halves - self.phase / (TAU / 2.0)) / (2.0 * self.hz)
    }
}

/// Returns the rows of several sampling rates and resolutions.
pub fn zero_crossings(parts: u64) -> Vec<Figure> {
    let rates = [20e3, 50e3, 100e3, 250e3, 1e6];
    let all = [12, 8]
        .into_iter()
        .flat_map(|bits| rates.map(|rate| (rate, bits)));
    all.map(|(rate, bits)| zero_crossing(parts, rate, bits))
        .collect()
}

/// Returns the errors of the voltage at turn-on, one for each pulse that turns on while the mains fall towards 0. The
/// pulses form the train that the controller uses.
fn zero_crossing(parts: u64, rate: f64, bits: i32) -> Figure {
    let mut dice = Dice::new(1);
    let scope = Scope {
        bits,
        step_s: 1.0 / rate,
    };
    let half_s = 0.5 / HZ;
    let period_s = (3.0 + 1.0 / f64::from(PULSES)) * half_s;
    let length_s = f64::from(PULSES) * period_s / 0.98;
    let mut errors = Vec::new();
    // A long record of few parts says as much as a short one of many.
    for _ in 0..parts.div_ceil(20) {
        let line = Line::drawn(&mut dice);
        let inhibit_v = normal(&mut dice, 12.0, 2.0).clamp(6.0, 18.0);
        let pulses = (0..PULSES).map(|it| {
            let rise_s = f64::from(it) * period_s;
            let fall_s = rise_s + 1.5 * half_s;
            let end_s = rise_s + period_s;
            let on_s = line.below(rise_s, inhibit_v);
            (
                Pulse {
                    rise_s,
                    fall_s,
                    end_s,
                },
                on_s,
                line.zero_after(fall_s),
            )
        });
        let pulses: Vec<(Pulse, f64, f64)> = pulses.collect();
        let output = |at_s: f64| {
            let on = pulses.iter().any(|it| (it.1..it.2).contains(&at_s));
            let volts = line.at(at_s);
            if on {
                DROP_V.min(volts.abs()).copysign(volts)
            } else {
                volts
            }
        };
        let times = (-0.02 * length_s, length_s);
        let divided = scope.record(times, 4.0, &mut dice, |at_s| output(at_s) / 100.0);
        let clamped = scope.record(times, 11.4, &mut dice, |at_s| {
            output(at_s).clamp(-CLAMP_V, CLAMP_V)
        });
        let channels = Channel::of(&divided, 100.0, 0.0).zip(Channel::of(&clamped, 1.0, 0.0));
        let Some((divided, clamped)) = channels else {
            continue;
        };
        let output = Output {
            divided,
            clamped,
            clamp_v: CLAMP_V,
            on_v: ON_V,
        };
        let Some(mains) = output.mains(HZ) else {
            continue;
        };
        for (pulse, on_s, _) in &pulses {
            let true_v = line.at(*on_s).abs();
            let answer = output.answer(&mains, *pulse);
            errors.extend(answer.on.map(|on| on.before.abs() - true_v));
        }
    }
    let seconds = length_s + READ_S * length_s * rate;
    let figure = row(
        format!("zero-cross voltage, {} kS/s, {bits} bits", rate / 1e3),
        &errors,
        "V",
        seconds,
    );
    match (rate, bits) == (100e3, 12) {
        true => figure.bar(Bar::AtMost(0.5)),
        false => figure,
    }
}

/// Returns the rows of the resistive part of a leakage by two methods: the split of the record into both parts, and the
/// rms value without the current of the nominal snubber.
pub fn leakages(parts: u64) -> Vec<Figure> {
    let mut rows = Vec::new();
    for periods in [1.0, 3.0, 10.0] {
        let (split, whole) = leakage(parts, periods);
        let seconds = periods / HZ + READ_S * 4e3;
        let named = |how: &str| format!("{how}, {periods} periods");
        rows.push(match periods == 3.0 {
            true => row(named("split"), &split, "uA", seconds).bar(Bar::AtMost(3.0)),
            false => row(named("split"), &split, "uA", seconds),
        });
        rows.push(row(named("rms"), &whole, "uA", seconds));
    }
    rows
}

/// Returns the errors of both methods, microamperes. The resistive parts are 5 to 100 uA, beside the 1.45 mA of a
/// snubber of 20 nF whose capacitance scatters by 3.5 %.
fn leakage(parts: u64, periods: f64) -> (Vec<f64>, Vec<f64>) {
    const SNUBBER_F: f64 = 20e-9;
    let mut dice = Dice::new(1);
    let scope = Scope {
        bits: 12,
        step_s: periods / HZ / 4e3,
    };
    let (mut split, mut whole) = (Vec::new(), Vec::new());
    for _ in 0..parts {
        let line = Line::drawn(&mut dice);
        let farads = SNUBBER_F * normal(&mut dice, 1.0, 0.035);
        let siemens = uniform(&mut dice, 5e-6, 100e-6) / MAINS_V;
        let times = (0.0, periods / HZ);
        let volts = scope.record(times, 4.0, &mut dice, |at_s| line.at(at_s) / 100.0);
        let ampere = scope.record(times, 4e-3, &mut dice, |at_s| {
            farads * line.slope(at_s) + siemens * line.at(at_s)
        });
        let channels = Channel::of(&volts, 100.0, 0.0).zip(Channel::of(&ampere, 1.0, 0.0));
        let Some((volts, ampere)) = channels else {
            continue;
        };
        let mains = Mains::fit(volts.pairs(0, volts.len(), 4), HZ);
        let fitted = mains.and_then(|it| {
            let current = phasor(ampere.pairs(0, ampere.len(), 1), it.hz)?;
            Some((Admittance::of(&it, current.of), it.hz))
        });
        let Some((admittance, hz)) = fitted else {
            continue;
        };
        let nominal = admittance.at_hz(hz, HZ);
        let true_ua = 1e6 * siemens * MAINS_V;
        split.push(1e6 * nominal.conductance * MAINS_V - true_ua);
        let rms_a = nominal.size() * MAINS_V;
        let snubber_a = TAU * HZ * SNUBBER_F * MAINS_V;
        let rest_a = (rms_a.powi(2) - snubber_a.powi(2)).max(0.0).sqrt();
        whole.push(1e6 * rest_a - true_ua);
    }
    (split, whole)
}

/// Returns the rows of the drop at the peak of the current, read from a straight line through the samples of one
/// polarity.
pub fn drops(parts: u64) -> Vec<Figure> {
    [1, 2, 10].map(|periods| drop(parts, periods)).to_vec()
}

fn drop(parts: u64, periods: u32) -> Figure {
    const PEAK_A: f64 = 5.0 * SQRT_2;
    const SHUNT_OHM: f64 = 0.01;
    let mut dice = Dice::new(1);
    let scope = Scope {
        bits: 12,
        step_s: 21.6e-6,
    };
    let length_s = f64::from(periods) / HZ;
    let mut errors = Vec::new();
    for _ in 0..parts {
        let (knee_v, ohm) = (
            normal(&mut dice, 0.85, 0.02),
            normal(&mut dice, 0.045, 0.003),
        );
        let ampere = |at_s: f64| PEAK_A * (TAU * HZ * at_s).sin();
        let times = (0.0, length_s);
        let volts = scope.record(times, 2.2, &mut dice, |at_s| {
            let ampere = ampere(at_s);
            knee_v.copysign(ampere) + ohm * ampere
        });
        let shunt = scope.record(times, 0.1, &mut dice, |at_s| SHUNT_OHM * ampere(at_s));
        let samples = volts.volts.iter().zip(&shunt.volts);
        let samples = samples.map(|(v, a)| (f64::from(*a) / SHUNT_OHM, f64::from(*v)));
        let line = drop_line::fit(samples, 0.3 * PEAK_A);
        errors.extend(line.map(|it| 1e3 * (it.at(PEAK_A) - knee_v - ohm * PEAK_A)));
    }
    let figure = row(
        format!("drop, {periods} periods"),
        &errors,
        "mV",
        length_s + READ_S * length_s / scope.step_s,
    );
    figure.bar(Bar::AtMost(3.0))
}
