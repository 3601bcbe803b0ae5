//! Checks the calibrations: a rig accepts no lot while its factors are overdue or failed their verification.

use super::finding::{Check, Finding, Subject};
use crate::calibration::{REMEDY, date};
use history::{CalibrationRecord, Examination};
use jiff::Timestamp;
use machine::dut::Calibration;

/// Microseconds of an hour.
const HOUR_US: i64 = 3_600_000_000;
const EXPECTED: &str = "a verified calibration that has not run out";

/// Checks the newest calibration for each coil voltage. Returns no findings for the simulated rig, which calibrates
/// before each lot.
pub(super) fn check(history: &Examination, now: Timestamp) -> Vec<Finding> {
    if history.is_simulated == Some(true) {
        return Vec::new();
    }
    let mut records = history.calibrations.iter().peekable();
    if records.peek().is_none() {
        let subject = Subject::new(Check::Calibration, "rig", EXPECTED);
        let remedy = "put the reference parts into the magazine, then `relayrig calibrate`";
        return vec![subject.warning("none", remedy)];
    }
    records
        .map(|it| check_one(it, now.as_microsecond()))
        .collect()
}

fn check_one(record: &CalibrationRecord, now_us: i64) -> Finding {
    let voltage = serde_json::from_str::<Calibration>(&record.body);
    let name = match &voltage {
        Ok(calibration) => match calibration.facts().nominal_v {
            volts if volts > 0.0 => format!("{volts} V"),
            _ => "rack".to_owned(),
        },
        Err(_) => record.hash.clone(),
    };
    let subject = Subject::new(Check::Calibration, name, EXPECTED);
    if let Err(error) = voltage {
        return subject.fault(format!("factors that cannot be read: {error}"), REMEDY);
    }
    let made = date(record.made_at_us).unwrap_or_default();
    let left_h = record.due_at_us.saturating_sub(now_us) / HOUR_US;
    if record.is_overdue(now_us) {
        let found = format!("made {made}, overdue for {} h", -left_h);
        return subject.fault(found, REMEDY);
    }
    match record.verified {
        true => subject.ok(format!("made {made}, valid for {left_h} h more")),
        false => subject.fault(format!("made {made}, failed its verification"), REMEDY),
    }
}
