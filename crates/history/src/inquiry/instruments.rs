//! What the rig's instruments were found to do, how well that is known, and until when it may be used; and what golden parts
//! read when they were measured last.

use super::Result;
use crate::{Archive, CalibrationRecord, Moment, Part, ReferenceCheck};
use jiff::Timestamp;
use machine::dut::Characteristic;
use machine::dut::instruments::{Certificate, factors};
use serde::Serialize;
use units::Unit;

/// Coverage factor of what is told.
const K: f64 = 2.0;

/// Everything that a measurement leans on.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Instruments {
    /// The calibration made last for each coil voltage.
    pub calibrations: Vec<CalibrationStatus>,
    /// The golden parts of the plant.
    pub golden: Vec<ReferencePartStatus>,
    /// The golden check made last.
    pub check: Option<ReferenceCheck>,
}

/// A calibration and whether it holds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationStatus {
    /// Nominal voltage whose golden parts it rests on, V.
    pub nominal_v: Option<f64>,
    /// When the factors were found.
    pub made: Moment,
    /// When they may no longer be used.
    pub due: Moment,
    /// That time is over.
    pub overdue: bool,
    /// The verification after it, if any, has passed.
    pub verified: bool,
    /// SHA-256, as runs name it.
    pub hash: String,
    /// Every factor that was measured; none when another program wrote them in a form that this one does not read.
    pub factors: Vec<ShownFactor>,
}

/// A factor as it is told.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ShownFactor {
    /// Its name.
    pub name: &'static str,
    /// Unit of the figures, `1` for a ratio.
    pub unit: Unit,
    /// Value.
    pub value: f64,
    /// Expanded uncertainty, k = 2.
    pub uncertainty: f64,
}

/// A golden part: what its certificate says and what was read last.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferencePartStatus {
    /// Serial number.
    pub serial: String,
    /// Nominal voltage of the recipes that it serves, V.
    pub nominal_v: f64,
    /// When it was measured last; none when it never was.
    pub seen: Option<Moment>,
    /// Lot and run in which.
    pub run: Option<(String, u32)>,
    /// Every certified quantity.
    pub values: Vec<CertifiedReading>,
}

/// One quantity of a golden part.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CertifiedReading {
    /// What it is.
    pub parameter: Characteristic,
    /// Of the certificate.
    pub certified: f64,
    /// Expanded uncertainty of the certificate, k = 2.
    pub certified_uncertainty: f64,
    /// Read last.
    pub value: Option<f64>,
    /// Its expanded uncertainty, k = 2.
    pub uncertainty: Option<f64>,
}

/// Of the rig, or of the simulated one, with the golden parts of the plant.
///
/// # Errors
/// Of the history.
pub fn instruments(
    archive: &Archive,
    simulated: bool,
    golden: &[Certificate],
) -> Result<Instruments> {
    let now_us = Timestamp::now().as_microsecond();
    let stored = archive.calibrations(simulated)?;
    let held = stored.into_iter().map(|it| held(it, now_us));
    let golden = golden.iter().map(|part| reference_part(archive, part));
    Ok(Instruments {
        calibrations: held.collect(),
        golden: golden.collect::<Result<_>>()?,
        check: archive.last_reference_check(simulated)?,
    })
}

fn held(record: CalibrationRecord, now_us: i64) -> CalibrationStatus {
    let body: serde_json::Value = serde_json::from_str(&record.body).unwrap_or_default();
    let nominal_v = body["nominal_v"].as_f64();
    let factors = factors(body).into_iter().map(|it| ShownFactor {
        name: it.name,
        unit: it.unit,
        value: it.factor.value,
        uncertainty: K * it.factor.u,
    });
    CalibrationStatus {
        nominal_v,
        made: Moment(record.made_at_us),
        due: Moment(record.due_at_us),
        overdue: record.due_at_us <= now_us,
        verified: record.verified,
        hash: record.hash,
        factors: factors.collect(),
    }
}

fn reference_part(archive: &Archive, part: &Certificate) -> Result<ReferencePartStatus> {
    let seen = archive.reference_part(&part.serial)?;
    let values = part.values.iter().map(|(parameter, certified)| {
        let read = seen.as_ref().and_then(|it| read(it, *parameter));
        CertifiedReading {
            parameter: *parameter,
            certified: certified.value,
            certified_uncertainty: K * certified.u,
            value: read.map(|it| it.0),
            uncertainty: read.map(|it| it.1),
        }
    });
    Ok(ReferencePartStatus {
        serial: part.serial.clone(),
        nominal_v: part.nominal_v,
        seen: seen.as_ref().map(|it| it.time),
        run: seen.as_ref().map(|it| (it.lot.clone(), it.run)),
        values: values.collect(),
    })
}

/// Value and expanded uncertainty; what has no uncertainty only teaches, and says nothing against a certificate.
fn read(part: &Part, parameter: Characteristic) -> Option<(f64, f64)> {
    let number =
        |map: &serde_json::Map<String, serde_json::Value>| map.get(parameter.key())?.as_f64();
    Some((number(&part.values)?, number(&part.uncertainty)?))
}
