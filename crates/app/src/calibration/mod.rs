//! Determines the calibration factors of a rig from its references and reference parts, or verifies them.
//!
//! Calibration and verification measure the reference parts as a run does before its lot, but test no part of a lot
//! afterwards. A calibration stores the factors found. A verification stores no factors: each factor found must agree
//! with the stored one within the combined expanded uncertainty (k = 3, because all fifteen must agree), and the
//! history marks the stored calibration with the outcome. A rig whose calibration is overdue or failed its verification
//! runs no lot until it is calibrated again. A kind that is calibrated by certificate takes its factors from the file
//! of the certificate, without a run.

mod compare;

use super::exit::{Cause, Exit};
use super::lot::{Purpose, Subscriber};
use super::order::{Files, LotOrder};
use super::source::RigSource;
use anyhow::{Context, bail};
pub use compare::{FactorComparison, K, K_JOINT};
use config::{Folder, Plant, load_recipe};
use history::{CalibrationRecord, Store, snapshot_hash};
use machine::dut::Calibration;
use machine::dut::device::Made;
use machine::dut::recipe::DeviceRecipe;
use std::path::Path;
use std::sync::OnceLock;
use texts::Message;

/// Remedy for a calibration that permits no lot.
pub(super) const REMEDY: &str = "run `relayrig calibrate` before the next lot";
/// Name of the lot under which the history keeps the reference parts.
const LOT: &str = "calibration";

/// Outcome of a calibration or a verification.
#[derive(Debug)]
pub enum Calibrated {
    /// A calibration: the history holds the new factors.
    Stored(Box<Calibration>),
    /// A verification: the stored factors beside the factors found now.
    Verified {
        /// One entry per factor.
        compared: Vec<FactorComparison>,
        /// Instant at which the stored factors expire, microseconds since 1970 UTC.
        due_at_us: i64,
    },
    /// The run ended before it had determined the factors.
    Ended(Exit),
}

/// Calibrates the rig, or with `verify` verifies its calibration. The coil voltage of the recipe selects the reference
/// parts; a kind that is calibrated by certificate needs no run.
///
/// # Errors
/// Fails when the kind needs no calibration, when the plant has no reference part of the recipe's coil voltage or no
/// valid certificate, when there is no valid calibration to verify, or as [`super::run_lot`] does.
pub fn calibrate(
    files: &Files,
    source: &RigSource,
    (recipe, verify): (&str, bool),
    outer: &mut dyn Subscriber,
) -> anyhow::Result<Calibrated> {
    history::check_rig(&files.db, source.is_simulated())?;
    if let Some((found, file)) = certified(&files.config, recipe, source)? {
        return keep_certified(files, found, &file, verify);
    }
    let nominal_v = reference_voltage(&files.config, recipe)?;
    let stored = match verify {
        true => Some(valid_calibration(
            &open(&files.db)?,
            source.is_simulated(),
            nominal_v,
        )?),
        false => None,
    };
    let order = LotOrder {
        lot: LOT.into(),
        recipe: recipe.to_owned(),
        count: Some(0),
        retest: None,
    };
    let mut both = (OnceLock::new(), outer);
    match super::run_lot(files, source, &order, Purpose::Calibration, &mut both)? {
        Exit::Done => {}
        exit => return Ok(Calibrated::Ended(exit)),
    }
    let Some(found) = both.0.into_inner() else {
        let cause = Cause::not_calibrated();
        tracing::error!("{}", cause.text);
        return Ok(Calibrated::Ended(Exit::Trouble(cause)));
    };
    match stored {
        Some((record, expected)) => {
            let compared = compare::compare(&found, &expected);
            let verified = compared.iter().all(FactorComparison::agrees);
            let due_at_us = record.due_at_us;
            open(&files.db)?.save_calibration(&CalibrationRecord { verified, ..record })?;
            Ok(Calibrated::Verified {
                compared,
                due_at_us,
            })
        }
        None => keep(&files.db, found),
    }
}

/// Returns the calibration that the certificates of the plant give for the recipe, with the name of their file; `None`
/// for a kind that is calibrated on parts.
fn certified(
    config: &Folder,
    recipe: &str,
    source: &RigSource,
) -> anyhow::Result<Option<(Calibration, String)>> {
    let plant = Plant::load(config)?;
    let device = load_recipe(config, recipe)?.device;
    let found = of_plant(&plant, &device, source.is_simulated());
    let path = |file: &String| config.path(file).display().to_string();
    let file = plant.calibration.certificate_file.as_ref().map(path);
    if found.is_none() && device.part().nominal_v.is_none() && device.calibrated_for().is_some() {
        bail!(
            "{}: found no calibration.rack, expected the file of the certificate",
            config.path("rig.toml").display()
        );
    }
    Ok(found.zip(file))
}

/// Returns the calibration that the certificates of the plant give for parts of a recipe; `None` for a kind that is
/// calibrated on parts, and for a plant without a certificate.
pub(super) fn of_plant(
    plant: &Plant,
    device: &DeviceRecipe,
    simulated: bool,
) -> Option<Calibration> {
    let made = Made {
        at_us: jiff::Timestamp::now().as_microsecond(),
        valid_us: (plant.calibration.valid_h * 3.6e9) as i64,
        simulated,
    };
    device.certified(&plant.rig(), made)
}

/// Stores the certified calibration `found`, or with `verify` compares the stored one with it. Refuses to store a
/// certificate that has expired or is dated in the future.
fn keep_certified(
    files: &Files,
    found: Calibration,
    file: &str,
    verify: bool,
) -> anyhow::Result<Calibrated> {
    let facts = found.facts();
    let store = open(&files.db)?;
    if verify {
        let (record, expected) = valid_calibration(&store, facts.is_simulated, facts.nominal_v)?;
        let compared = compare::compare(&found, &expected);
        let verified = compared.iter().all(FactorComparison::agrees);
        let due_at_us = record.due_at_us;
        open(&files.db)?.save_calibration(&CalibrationRecord { verified, ..record })?;
        return Ok(Calibrated::Verified {
            compared,
            due_at_us,
        });
    }
    let now_us = jiff::Timestamp::now().as_microsecond();
    let (issued, due) = (date(facts.made_at_us)?, date(facts.due_at_us)?);
    if facts.due_at_us <= now_us {
        bail!(
            "{file}: issued: found {issued}, from which the certificate held until {due}, expected a newer certificate"
        );
    }
    if facts.made_at_us > now_us {
        bail!("{file}: issued: found {issued}, expected a date that has come");
    }
    keep(&files.db, found)
}

/// Returns the nominal coil voltage of the recipe, V; fails for a recipe without a coil, and when no reference part has
/// this voltage.
fn reference_voltage(config: &Folder, recipe: &str) -> anyhow::Result<f64> {
    let plant = Plant::load(config)?;
    let Some(nominal_v) = load_recipe(config, recipe)?.device.part().nominal_v else {
        bail!("--recipe {recipe}: found a kind that needs no calibration, expected a relay");
    };
    if plant.reference_parts.of_nominal(nominal_v).next().is_none() {
        bail!(
            "{}: found no reference part of {nominal_v} V, expected at least 3",
            config.path("golden.toml").display()
        );
    }
    Ok(nominal_v)
}

fn open(db: &Path) -> anyhow::Result<Store> {
    Ok(Store::open(db)?)
}

fn valid_calibration(
    store: &Store,
    simulated: bool,
    nominal_v: f64,
) -> anyhow::Result<(CalibrationRecord, Calibration)> {
    let Some(record) = store.latest_calibration_of(simulated, nominal_v)? else {
        bail!(
            "--verify: found no calibration for {nominal_v} V in the history, expected one (relayrig calibrate)"
        );
    };
    if record.is_overdue(jiff::Timestamp::now().as_microsecond()) {
        let due = date(record.due_at_us)?;
        bail!(
            "--verify: the calibration ran out at {due}, expected a valid one (relayrig calibrate)"
        );
    }
    let calibration =
        serde_json::from_str(&record.body).context("the stored calibration cannot be read")?;
    Ok((record, calibration))
}

fn keep(db: &Path, found: Calibration) -> anyhow::Result<Calibrated> {
    let body = serde_json::to_string(&found)?;
    let facts = found.facts();
    open(db)?.save_calibration(&CalibrationRecord {
        made_at_us: facts.made_at_us,
        due_at_us: facts.due_at_us,
        hash: snapshot_hash(&body),
        body,
        verified: true,
    })?;
    Ok(Calibrated::Stored(Box::new(found)))
}

/// Formats microseconds since 1970 as a date in UTC.
///
/// # Errors
/// Fails when `us` lies outside the range of the calendar.
pub fn date(us: i64) -> anyhow::Result<String> {
    let at = jiff::Timestamp::from_microsecond(us).context("date of the calibration")?;
    Ok(at.strftime("%Y-%m-%dT%H:%M:%SZ").to_string())
}

/// Returns why the stored calibration permits no lot; `None` when the calibration is valid, or when there is none (the
/// run then calibrates first, or takes over the certificate of the plant).
pub(super) fn refusal(
    db: &Path,
    nominal_v: f64,
    of_plant: Option<&Calibration>,
) -> anyhow::Result<Option<Message>> {
    let now_us = jiff::Timestamp::now().as_microsecond();
    let Some(record) = open(db)?.latest_calibration_of(false, nominal_v)? else {
        let due_us = of_plant.map(|it| it.facts().due_at_us);
        return due_us.filter(|it| *it <= now_us).map(ran_out).transpose();
    };
    if record.is_overdue(now_us) {
        return ran_out(record.due_at_us).map(Some);
    }
    let made = date(record.made_at_us)?;
    let stored: Option<Calibration> = serde_json::from_str(&record.body).ok();
    let differs = of_plant
        .zip(stored.as_ref())
        .is_some_and(|(it, stored)| !stored.has_certificate_of(it));
    let (code, said) = match (record.verified, differs) {
        (false, _) => (
            "calibration_not_verified",
            format!("the calibration made at {made} failed its last verification: {REMEDY}"),
        ),
        (true, true) => (
            "calibration_differs",
            format!("the certificate differs from the stored one of {made}: {REMEDY}"),
        ),
        (true, false) => return Ok(None),
    };
    Ok(Some(Message::detail(code, said).with("at", made)))
}

fn ran_out(due_at_us: i64) -> anyhow::Result<Message> {
    let due = date(due_at_us)?;
    let said = format!("the calibration ran out at {due}: {REMEDY}");
    Ok(Message::detail("calibration_out", said).with("at", due))
}
