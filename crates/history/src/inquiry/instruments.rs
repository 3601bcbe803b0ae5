//! Calibration factors of the rig with uncertainty and due date, and the latest readings of its reference parts.

use super::Result;
use crate::{Archive, CalibrationRecord, Moment, Part, ReferenceCheck};
use jiff::Timestamp;
use machine::dut::Characteristic;
use machine::dut::instruments::{Certificate, factors};
use serde::Serialize;
use units::Unit;
use utoipa::ToSchema;

/// Coverage factor of all expanded uncertainties in [`Instruments`].
const K: f64 = 2.0;

/// Calibrations and reference parts of a rig.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Instruments {
    /// Newest calibration for each coil voltage.
    pub calibrations: Vec<CalibrationStatus>,
    /// Reference parts of the plant.
    pub golden: Vec<ReferencePartStatus>,
    /// Latest reference check.
    pub check: Option<ReferenceCheck>,
}

/// A calibration, and until when it is valid.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct CalibrationStatus {
    /// Nominal coil voltage of the reference parts, V; `None` for a rack of sockets, whose parts have no coil.
    pub nominal_v: Option<f64>,
    /// Time of the calibration.
    pub made: Moment,
    /// Time at which the calibration expires.
    pub due: Moment,
    /// True once the calibration has expired.
    pub overdue: bool,
    /// False after a failed verification, else true.
    pub verified: bool,
    /// SHA-256 by which runs name this calibration.
    pub hash: String,
    /// Measured factors; empty when this program cannot read them.
    pub factors: Vec<ShownFactor>,
}

/// A calibration factor with its expanded uncertainty.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
pub struct ShownFactor {
    /// Name of the factor.
    pub name: &'static str,
    /// Unit of value and uncertainty, `1` for a ratio.
    #[schema(value_type = String)]
    pub unit: Unit,
    /// Value of the factor.
    pub value: f64,
    /// Expanded uncertainty, k = 2.
    pub uncertainty: f64,
}

/// A reference part, with its certificate and latest readings.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct ReferencePartStatus {
    /// Serial number of the reference part.
    pub serial: String,
    /// Nominal coil voltage of the recipes that use the part, V.
    pub nominal_v: f64,
    /// Time of the last test of the reference part, if any.
    pub seen: Option<Moment>,
    /// Lot and run of the last test of the reference part.
    pub run: Option<(String, u32)>,
    /// Certified quantities, each with its latest reading.
    pub values: Vec<CertifiedReading>,
}

/// A certified quantity, with its latest reading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, ToSchema)]
pub struct CertifiedReading {
    /// Characteristic that is certified.
    #[schema(value_type = String)]
    pub parameter: Characteristic,
    /// Certified value.
    pub certified: f64,
    /// Expanded uncertainty of the certificate, k = 2.
    pub certified_uncertainty: f64,
    /// Latest reading; `None` without one.
    pub value: Option<f64>,
    /// Expanded uncertainty of the reading, k = 2.
    pub uncertainty: Option<f64>,
}

/// Collects calibrations and readings of a rig; `reference_parts` are the certificates of the plant.
///
/// # Errors
/// Fails when the history cannot be read.
pub fn instruments(
    archive: &Archive,
    simulated: bool,
    reference_parts: &[Certificate],
) -> Result<Instruments> {
    let now_us = Timestamp::now().as_microsecond();
    let stored = archive.calibrations(simulated)?;
    let held = stored.into_iter().map(|it| held(it, now_us));
    let parts = reference_parts.iter();
    let parts = parts.map(|part| reference_part(archive, part));
    Ok(Instruments {
        calibrations: held.collect(),
        golden: parts.collect::<Result<_>>()?,
        check: archive.last_reference_check(simulated)?,
    })
}

fn held(record: CalibrationRecord, now_us: i64) -> CalibrationStatus {
    let body: serde_json::Value = serde_json::from_str(&record.body).unwrap_or_default();
    let nominal_v = body["nominal_v"].as_f64().filter(|it| *it > 0.0);
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
        overdue: record.is_overdue(now_us),
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

/// Returns value and expanded uncertainty of a parameter; `None` for a value without uncertainty, which only serves to
/// compute a calibration.
fn read(part: &Part, parameter: Characteristic) -> Option<(f64, f64)> {
    let number =
        |map: &serde_json::Map<String, serde_json::Value>| map.get(parameter.key())?.as_f64();
    Some((number(&part.values)?, number(&part.uncertainty)?))
}
