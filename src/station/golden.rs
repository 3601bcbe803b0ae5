//! Golden parts: what the ramps indicate on relays with a certificate tells the lag of the ramps.
//!
//! The coarse lag goes on learning from every part of the lot, because it only places the fine ramp;
//! the fine lag, which enters results, comes from the certificates alone.

use super::test::{Findings, Ramp};
use crate::gauge::calibration::{Factor, Lag, Lags};
use crate::gauge::coil::{relative_per_kelvin, to_reference};
use crate::gauge::lag::{LagLine, Shown};
use crate::gauge::settings::{AccuracySettings, Certified, GoldenPart};
use crate::gauge::{Parameter, Reading};
use crate::units::Celsius;

/// The scatter of the coarse lag is never believed to be smaller, volts: one refresh of the ramp in ten.
const LEAST_SCATTER_V: f64 = 0.010;
/// Before any part was seen, volts (1 sd).
const FIRST_SCATTER_V: f64 = 0.050;
/// A golden part whose fine indication lies further from the others' lag is out of its band, volts.
const BAND_V: f64 = 0.060;

/// Running mean and scatter of coarse minus fine (Welford).
#[derive(Debug, Clone, Copy, Default)]
pub struct CoarseLag {
    n: f64,
    mean: f64,
    squares: f64,
    line: Option<LagLine>,
}

impl CoarseLag {
    /// Takes in one part that has both indications.
    pub fn learn(&mut self, ramp: Ramp) {
        let Some(fine) = ramp.fine else { return };
        let lag = (ramp.coarse - fine).0;
        if !lag.is_finite() {
            return;
        }
        self.n += 1.0;
        let step = lag - self.mean;
        self.mean += step / self.n;
        self.squares += step * (lag - self.mean);
    }

    /// The same of an operate ramp, whose lag follows the operate time; `rate_v_per_s` is that of the ramp.
    pub fn learn_with_time(&mut self, ramp: Ramp, operate_ms: Option<f64>, rate_v_per_s: f64) {
        self.learn(ramp);
        if let (Some(fine), Some(operate_ms)) = (ramp.fine, operate_ms) {
            let shown = Shown {
                operate_ms,
                seen_v: ramp.coarse.0,
            };
            self.line
                .get_or_insert_with(|| LagLine::before(rate_v_per_s))
                .learn(shown, (ramp.coarse - fine).0);
        }
    }

    /// Mean and standard deviation for the next part; a guess wins while nothing was seen.
    fn place(&self, guess: f64) -> (f64, f64) {
        if self.n < 1.0 {
            return (guess, FIRST_SCATTER_V);
        }
        (self.mean, self.uncertainty_v().max(LEAST_SCATTER_V))
    }

    /// Scatter, widened as few parts know it only badly.
    fn uncertainty_v(&self) -> f64 {
        let few = 1.0 + 2.0 / self.n;
        if self.n < 2.0 {
            return FIRST_SCATTER_V * few;
        }
        (self.squares / (self.n - 1.0)).sqrt() * few
    }

    /// Lag with the coarse part as learned so far.
    fn lag(self, fine_v: Factor, at_v: f64, guess: f64) -> Lag {
        let (coarse_v, coarse_sd_v) = self.place(guess);
        Lag {
            fine_v,
            at_v,
            coarse_v,
            coarse_sd_v,
            coarse_u_v: self.uncertainty_v(),
            coarse_n: self.n as u32,
            line: self.line,
        }
    }
}

/// Indications of one golden part in both directions, minus certificate, at the part's temperature.
#[derive(Debug, Clone)]
struct Shift {
    serial: String,
    operate: f64,
    release: f64,
}

/// What the golden parts of a run have shown so far.
#[derive(Debug, Clone, Default)]
pub struct GoldenRun {
    shifts: Vec<Shift>,
}

impl GoldenRun {
    /// Takes in a tested golden part, or says why it cannot be used.
    pub fn learn(
        &mut self,
        part: &GoldenPart,
        reference: Celsius,
        findings: &Findings,
    ) -> Result<(), String> {
        let serial = &part.serial;
        let why = |what: &str| format!("golden part {serial}: {what}");
        let track = findings.track.ok_or_else(|| why("no temperature"))?;
        let fine = |ramp: Option<Ramp>| ramp.and_then(|ramp| ramp.fine);
        let operate = fine(findings.operate).ok_or_else(|| why("no operate voltage"))?;
        let release = fine(findings.release).ok_or_else(|| why("no release voltage"))?;
        check_coil(part, findings)?;
        let at_part = |certified: Certified| certified.value / to_reference(track, reference);
        self.shifts.push(Shift {
            serial: serial.clone(),
            operate: operate.0 - at_part(part.operate_voltage_v),
            release: release.0 - at_part(part.release_voltage_v),
        });
        Ok(())
    }

    /// Lags from all golden parts; an error names the part that does not fit.
    pub fn lags(
        &self,
        sets: &[GoldenPart],
        accuracy: &AccuracySettings,
        coarse: (CoarseLag, CoarseLag),
    ) -> Result<Lags, String> {
        let operate = self.fine(
            |shift| shift.operate,
            |part| part.operate_voltage_v,
            sets,
            accuracy,
        )?;
        let release = self.fine(
            |shift| shift.release,
            |part| part.release_voltage_v,
            sets,
            accuracy,
        )?;
        Ok(Lags {
            operate: place(operate, mean(sets, |part| part.operate_voltage_v), coarse.0),
            release: place(release, mean(sets, |part| part.release_voltage_v), coarse.1),
        })
    }

    fn fine(
        &self,
        shift: fn(&Shift) -> f64,
        certified: fn(&GoldenPart) -> Certified,
        parts: &[GoldenPart],
        accuracy: &AccuracySettings,
    ) -> Result<Factor, String> {
        let n = self.shifts.len() as f64;
        if self.shifts.len() < 3 {
            return Err(format!(
                "{} golden parts were measured, at least 3 are needed",
                self.shifts.len()
            ));
        }
        let mean = self.shifts.iter().map(shift).sum::<f64>() / n;
        if let Some(odd) = self
            .shifts
            .iter()
            .find(|one| (shift(one) - mean).abs() > BAND_V)
        {
            let off = (shift(odd) - mean) * 1e3;
            return Err(format!(
                "golden part {} is {off:+.1} mV away from the others",
                odd.serial
            ));
        }
        let of_part = |part: &GoldenPart| {
            let value = certified(part);
            let kelvin =
                value.value * accuracy.part_minus_track_k * relative_per_kelvin(Celsius(23.0));
            value.u.powi(2) + kelvin.powi(2) + (accuracy.operation_scatter_mv / 1e3).powi(2)
        };
        let promised = parts.iter().map(of_part).sum::<f64>() / parts.len().max(1) as f64;
        Ok(Factor::new(mean, (promised / n).sqrt()))
    }
}

fn mean(parts: &[GoldenPart], certified: fn(&GoldenPart) -> Certified) -> f64 {
    parts.iter().map(|part| certified(part).value).sum::<f64>() / parts.len().max(1) as f64
}

fn check_coil(part: &GoldenPart, findings: &Findings) -> Result<(), String> {
    let serial = &part.serial;
    let coil = findings
        .result(Parameter::CoilResistance)
        .ok_or_else(|| format!("golden part {serial}: no coil resistance"))?;
    let certified = part.coil_resistance_ohm;
    let allowed = 2.0 * coil.budget.combined().hypot(certified.u) * 2.0;
    if (coil.value - certified.value).abs() > allowed {
        return Err(format!(
            "golden part {serial}: coil reads {:.2} ohm, certificate {:.2} +- {allowed:.2}. Is it the part named?",
            coil.value, certified.value
        ));
    }
    Ok(())
}

/// How far a golden part may read from its certificate, standard deviations: of three results one good part in 120 is
/// outside, and the slow strategy has narrowed them.
const CHECK_K: f64 = 3.0;

/// Compares what was measured on a golden part with its certificate; an error says what does not agree.
pub fn check(part: &GoldenPart, findings: &Findings) -> Result<(), String> {
    let certified = [
        (Parameter::CoilResistance, part.coil_resistance_ohm, "ohm"),
        (Parameter::OperateVoltage, part.operate_voltage_v, "V"),
        (Parameter::ReleaseVoltage, part.release_voltage_v, "V"),
    ];
    let serial = &part.serial;
    for (parameter, certified, unit) in certified {
        let name = parameter.name();
        let found = findings
            .result(parameter)
            .filter(Reading::is_usable)
            .ok_or_else(|| format!("golden part {serial}: no {name}"))?;
        let allowed = CHECK_K * found.budget.combined().hypot(certified.u);
        let off = found.value - certified.value;
        let within = off.abs() <= allowed;
        if !within {
            return Err(format!(
                "golden part {serial}: {name} reads {:.4} {unit}, certificate {:.4} +- {allowed:.4}",
                found.value, certified.value
            ));
        }
    }
    Ok(())
}

/// Lag with the coarse part as learned so far.
pub fn place(fine: Factor, at_v: f64, coarse: CoarseLag) -> Lag {
    coarse.lag(fine, at_v, 0.0)
}

/// Lag while golden parts are being run: no fine correction yet, the coarse one as far as learned.
pub fn interim(guess: Lag, coarse: CoarseLag) -> Lag {
    coarse.lag(Factor::new(0.0, f64::INFINITY), 0.0, guess.coarse_v)
}
