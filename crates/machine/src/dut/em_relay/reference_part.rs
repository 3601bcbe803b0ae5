//! Calibration on reference parts: indication minus certificate is the overshoot of the ramps.
//!
//! The model of the coarse overshoot also learns from every good part of the lot with both ramps; the fine overshoot,
//! which enters every result, comes from the certificates alone.

mod temperature;

use super::measure::{Observed, Ramp};
use crate::dut::TestRecord;
use crate::dut::accuracy::AccuracySettings;
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::calibration::{Overshoot, Overshoots};
use crate::dut::em_relay::coil::to_reference;
use crate::dut::em_relay::overshoot::OvershootModel;
use crate::dut::em_relay::probe_contact::Trend;
use crate::dut::em_relay::scale::Scale;
use crate::dut::em_relay::settings::{Certified, ReferencePart};
use crate::dut::em_relay::threshold::Direction;
use crate::gauge::Factor;
use texts::{Lang, Message};
use thiserror::Error;
use units::{Celsius, Ohm, Unit, Volt};

/// Greatest difference of a reference part's overshoot from the mean, for a 12 V coil; a part beyond this is an
/// outlier.
const BAND: Volt = Volt(0.060);

/// Reason why a reference part does not calibrate the rig, or disagrees with its certificate.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{}", self.message().say(Lang::En))]
pub enum Misfit {
    /// No certificate of this serial number.
    NoCertificate {
        /// Serial number of the part.
        serial: String,
    },
    /// A result is missing.
    Without {
        /// Serial number of the part.
        serial: String,
        /// Missing characteristic.
        characteristic: Parameter,
    },
    /// The temperature of the part is unknown.
    WithoutTemperature {
        /// Serial number of the part.
        serial: String,
    },
    /// The coil resistance differs from the certificate.
    OtherCoil {
        /// Serial number of the part.
        serial: String,
        /// Resistance found, ohm.
        ohm: f64,
        /// Resistance certified, ohm.
        certified_ohm: f64,
        /// Difference allowed, ohm.
        allowed_ohm: f64,
    },
    /// Too few reference parts were measured.
    TooFew {
        /// Number of reference parts measured.
        measured: usize,
    },
    /// One part is an outlier.
    Outlier {
        /// Serial number of the part.
        serial: String,
        /// Distance from the mean, mV.
        off_mv: f64,
    },
    /// A result disagrees with the certificate.
    Reads {
        /// Serial number of the part.
        serial: String,
        /// Characteristic that disagrees.
        characteristic: Parameter,
        /// Value found, in `unit`.
        found: f64,
        /// Unit of the values.
        unit: Unit,
        /// Value certified, in `unit`.
        certified: f64,
        /// Difference allowed, in `unit`.
        allowed: f64,
    },
}

impl Misfit {
    /// Returns the misfit as a text of the family `fault`, with its figures.
    pub fn message(&self) -> Message {
        let of = |code, serial| Message::new("fault", code).with("serial", serial);
        match self {
            Self::NoCertificate { serial } => of("no_certificate", serial),
            Self::Without {
                serial,
                characteristic,
            } => of("without", serial).with("characteristic", characteristic.name()),
            Self::WithoutTemperature { serial } => of("without_temperature", serial),
            Self::OtherCoil {
                serial,
                ohm,
                certified_ohm,
                allowed_ohm,
            } => of("other_coil", serial)
                .with("ohm", format!("{ohm:.2}"))
                .with("certified_ohm", format!("{certified_ohm:.2}"))
                .with("allowed_ohm", format!("{allowed_ohm:.2}")),
            Self::TooFew { measured } => {
                Message::new("fault", "too_few").with("measured", measured)
            }
            Self::Outlier { serial, off_mv } => {
                of("outlier", serial).with("off_mv", format!("{off_mv:+.1}"))
            }
            Self::Reads {
                serial,
                characteristic,
                found,
                unit,
                certified,
                allowed,
            } => of("reads_off", serial)
                .with("characteristic", characteristic.name())
                .with("found", format!("{found:.4}"))
                .with("unit", unit)
                .with("certified", format!("{certified:.4}"))
                .with("allowed", format!("{allowed:.4}")),
        }
    }
}

/// Indications of one reference part in both directions, minus the certified values converted to the temperature of the
/// part.
#[derive(Debug, Clone)]
struct Shift {
    serial: String,
    /// Fine indication minus certificate of each direction, V.
    fine_v: [f64; 2],
    /// Coarse minus fine indication of each direction, V; NaN without a coarse ramp.
    coarse_v: [f64; 2],
    /// Certified over found coil resistance, with the uncertainty of certificate and reading.
    coil: Factor,
}

/// Results of the reference parts of a run so far.
#[derive(Debug, Clone, Default)]
pub struct ReferenceRun {
    shifts: Vec<Shift>,
    contact: Trend,
}

impl ReferenceRun {
    /// Learns from a tested reference part; fails when the part cannot be used.
    pub fn learn<T>(
        &mut self,
        part: &ReferencePart,
        reference: Celsius,
        record: &TestRecord<T>,
        observed: &Observed,
    ) -> Result<(), Misfit> {
        let serial = &part.serial;
        let track = observed.track.ok_or_else(|| Misfit::WithoutTemperature {
            serial: serial.clone(),
        })?;
        let fine = |ramp: Option<Ramp>| ramp.and_then(|ramp| ramp.fine);
        let over = |ramp: Option<Ramp>| {
            ramp.and_then(|it| Some((it.coarse.indicated - it.fine?).0))
                .unwrap_or(f64::NAN)
        };
        let operate =
            fine(observed.operate).ok_or_else(|| without(part, Parameter::OperateVoltage))?;
        let release =
            fine(observed.release).ok_or_else(|| without(part, Parameter::ReleaseVoltage))?;
        let coil = coil(part, record)?;
        observed
            .probe_contact
            .into_iter()
            .for_each(|ohm| self.contact.add(ohm));
        let at_part = |certified: Certified| certified.value / to_reference(track, reference);
        self.shifts.push(Shift {
            serial: serial.clone(),
            fine_v: [
                operate.0 - at_part(part.operate_voltage_v),
                release.0 - at_part(part.release_voltage_v),
            ],
            coarse_v: [over(observed.operate), over(observed.release)],
            coil,
        });
        Ok(())
    }

    /// Returns the overshoots from all reference parts; fails with fewer than three, or with an outlier.
    pub fn overshoots(
        &self,
        parts: &[ReferencePart],
        accuracy: &AccuracySettings,
        coarse: (OvershootModel, OvershootModel),
    ) -> Result<Overshoots, Misfit> {
        let of = |direction, coarse| -> Result<Overshoot, Misfit> {
            let certified = parts.iter().map(|part| part.threshold(direction).value);
            Ok(Overshoot {
                fine_v: self.fine(direction, parts, accuracy)?,
                at_v: certified.sum::<f64>() / parts.len().max(1) as f64,
                at_coarse_v: self.over(direction),
                coarse,
                judges: false,
            })
        };
        Ok(Overshoots {
            operate: of(Direction::Rising, coarse.0)?,
            release: of(Direction::Falling, coarse.1)?,
        })
    }

    /// Returns the resistance of the coil's two force contacts, mean over the parts so far; 0 before the first.
    pub fn probe_contact_ohm(&self) -> f64 {
        self.contact.mean().map_or(0.0, |Ohm(ohm)| ohm)
    }

    /// Returns the mean of fine indication minus certificate over the parts so far, volts, for operate and release;
    /// `None` before the first part.
    pub fn fine_v(&self) -> Option<(f64, f64)> {
        let mean = |direction| self.mean(direction);
        (!self.shifts.is_empty()).then(|| (mean(Direction::Rising), mean(Direction::Falling)))
    }

    /// Returns the mean of fine indication minus certificate, volts; NaN without a part.
    fn mean(&self, direction: Direction) -> f64 {
        let each = self.shifts.iter().map(|it| it.fine_v[direction as usize]);
        each.sum::<f64>() / self.shifts.len() as f64
    }

    /// Returns the mean of coarse minus fine indication over the parts that have both, volts; 0 when no part has both.
    fn over(&self, direction: Direction) -> f64 {
        let both = || {
            let each = self
                .shifts
                .iter()
                .map(|shift| shift.coarse_v[direction as usize]);
            each.filter(|it| it.is_finite())
        };
        both().sum::<f64>() / both().count().max(1) as f64
    }

    fn fine(
        &self,
        direction: Direction,
        parts: &[ReferencePart],
        accuracy: &AccuracySettings,
    ) -> Result<Factor, Misfit> {
        let n = self.shifts.len() as f64;
        if self.shifts.len() < 3 {
            return Err(Misfit::TooFew {
                measured: self.shifts.len(),
            });
        }
        let shift = |it: &Shift| it.fine_v[direction as usize];
        let mean = self.mean(direction);
        let nominal_v = parts.first().map_or(f64::NAN, |part| part.nominal_v);
        let scale = Scale::new(nominal_v, 1.0);
        let band = scale.of_coil(BAND);
        if let Some(odd) = self
            .shifts
            .iter()
            .find(|one| (shift(one) - mean).abs() > band.0)
        {
            return Err(Misfit::Outlier {
                serial: odd.serial.clone(),
                off_mv: (shift(odd) - mean) * 1e3,
            });
        }
        let (_, others) = temperature::variances(parts, direction, accuracy);
        Ok(Factor::new(mean, (others / n).sqrt()))
    }
}

fn without(part: &ReferencePart, characteristic: Parameter) -> Misfit {
    Misfit::Without {
        serial: part.serial.clone(),
        characteristic,
    }
}

/// Returns certified over found coil resistance; fails when they differ so much that the part must be another.
fn coil<T>(part: &ReferencePart, record: &TestRecord<T>) -> Result<Factor, Misfit> {
    let coil = record.result(Parameter::CoilResistance);
    let coil = coil.ok_or_else(|| without(part, Parameter::CoilResistance))?;
    let certified = part.coil_resistance_ohm;
    let allowed = 2.0 * coil.budget.combined().hypot(certified.u) * 2.0;
    if (coil.value - certified.value).abs() > allowed {
        return Err(Misfit::OtherCoil {
            serial: part.serial.clone(),
            ohm: coil.value,
            certified_ohm: certified.value,
            allowed_ohm: allowed,
        });
    }
    let u = coil.budget.random().hypot(certified.u) / certified.value;
    Ok(Factor::new(certified.value / coil.value, u))
}

/// Greatest difference of a result from the certificate, in standard deviations. With three results per part, one good
/// part in 120 exceeds it.
const CHECK_K: f64 = 3.0;

/// Compares the results of a reference part with its certificate; fails with the one that is missing or disagrees.
pub fn check<T>(part: &ReferencePart, record: &TestRecord<T>) -> Result<(), Misfit> {
    let [operate, release, coil] = part.certified();
    for (parameter, certified) in [coil, operate, release] {
        let found = record.usable(parameter);
        let found = found.ok_or_else(|| without(part, parameter))?;
        let allowed = CHECK_K * found.budget.combined().hypot(certified.u);
        let off = found.value - certified.value;
        let within = off.abs() <= allowed;
        if !within {
            return Err(Misfit::Reads {
                serial: part.serial.clone(),
                characteristic: parameter,
                found: found.value,
                unit: found.unit,
                certified: certified.value,
                allowed,
            });
        }
    }
    Ok(())
}

/// Returns the overshoot to use before the reference parts are complete. It only places ramps: its uncertainty is
/// infinite.
pub fn interim(coarse: OvershootModel, fine_v: f64) -> Overshoot {
    Overshoot {
        fine_v: Factor::new(fine_v, f64::INFINITY),
        at_v: 0.0,
        at_coarse_v: 0.0,
        coarse,
        judges: false,
    }
}

#[cfg(test)]
mod tests;
