//! Checks the calibrations: a rig accepts no lot while its factors are overdue or failed their verification.

use super::finding::{Check, Finding, Subject};
use crate::calibration::{self, REMEDY, date};
use config::{Folder, Plant, load_recipe, recipe_names};
use history::{CalibrationRecord, Examination};
use jiff::Timestamp;
use machine::dut::Calibration;

/// Microseconds of an hour.
const HOUR_US: i64 = 3_600_000_000;
const EXPECTED: &str = "a verified calibration that has not run out";

/// Returns the calibration that the certificate of the plant gives; `None` without one, or without a recipe that needs it.
pub(super) fn of_plant(folder: &Folder, plant: &Plant) -> Option<Calibration> {
    let names = recipe_names(folder);
    let mut recipes = names.iter().filter_map(|it| load_recipe(folder, it).ok());
    recipes.find_map(|it| calibration::of_plant(plant, &it.device, false))
}

/// Checks the newest calibration for each coil voltage; `certified` is the one that the certificate of the plant gives.
/// Returns no findings for the simulated rig, which calibrates before each lot.
pub(super) fn check(
    history: &Examination,
    certified: Option<&Calibration>,
    now: Timestamp,
) -> Vec<Finding> {
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
        .map(|it| check_one(it, certified, now.as_microsecond()))
        .collect()
}

fn check_one(record: &CalibrationRecord, certified: Option<&Calibration>, now_us: i64) -> Finding {
    let stored = serde_json::from_str::<Calibration>(&record.body);
    let name = match &stored {
        Ok(calibration) => match calibration.facts().nominal_v {
            volts if volts > 0.0 => format!("{volts} V"),
            _ => "rack".to_owned(),
        },
        Err(_) => record.hash.clone(),
    };
    let subject = Subject::new(Check::Calibration, name, EXPECTED);
    let stored = match stored {
        Ok(stored) => stored,
        Err(error) => {
            return subject.fault(format!("factors that cannot be read: {error}"), REMEDY);
        }
    };
    let made = date(record.made_at_us).unwrap_or_default();
    let left_h = record.due_at_us.saturating_sub(now_us) / HOUR_US;
    if record.is_overdue(now_us) {
        let found = format!("made {made}, overdue for {} h", -left_h);
        return subject.fault(found, REMEDY);
    }
    let differs = certified.is_some_and(|it| {
        let same_parts = it.facts().nominal_v == stored.facts().nominal_v;
        same_parts && !stored.has_certificate_of(it)
    });
    match (record.verified, differs) {
        (true, false) => subject.ok(format!("made {made}, valid for {left_h} h more")),
        (true, true) => subject.fault(format!("made {made}, from another certificate"), REMEDY),
        (false, _) => subject.fault(format!("made {made}, failed its verification"), REMEDY),
    }
}
