//! The factors of a rig from its references and golden parts, or their verification.
//!
//! Both measure as a run does before its lot, with no part of a lot after the golden ones. Calibrating stores
//! what was found. A verification stores no factors: each found factor must lie within the combined expanded
//! uncertainty (k = 3, for fifteen must hold at once) of the stored one, and the stored calibration is marked with
//! the outcome. A rig whose calibration ran out or failed takes no lot until it was calibrated again.

mod compare;

use super::exit::{Cause, Exit};
use super::lot::{Purpose, Subscriber};
use super::order::{Files, LotOrder};
use super::source::RigSource;
use anyhow::{Context, bail};
pub use compare::{Compared, K, K_OF_ALL};
use config::{Plant, load_recipe};
use history::{CalibrationRecord, Identity, Store, snapshot_hash};
use machine::dut::Calibration;
use std::path::Path;
use std::sync::OnceLock;

/// Lot that the golden parts are recorded in.
const LOT: &str = "calibration";

/// What a calibration has come to.
#[derive(Debug)]
pub enum Calibrated {
    /// New factors are stored.
    Stored(Box<Calibration>),
    /// The stored factors were compared with what was found.
    Verified {
        /// Factor by factor.
        compared: Vec<Compared>,
        /// Until when the stored ones are valid.
        due_at_us: i64,
    },
    /// The run ended before anything was found.
    Not(Exit),
}

/// Calibrates the rig, or verifies its calibration. The coil voltage of `recipe` chooses the golden parts.
///
/// # Errors
/// Bad input: a recipe without a coil, no golden part of its voltage, nothing to verify.
pub fn calibrate(
    files: &Files,
    source: &RigSource,
    (recipe, verify): (&str, bool),
    outer: &mut dyn Subscriber,
) -> anyhow::Result<Calibrated> {
    let nominal_v = reference_voltage(&files.config, recipe)?;
    let stored = match verify {
        true => Some(to_verify(
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
        exit => return Ok(Calibrated::Not(exit)),
    }
    let Some(found) = both.0.into_inner() else {
        let cause = Cause::not_calibrated();
        tracing::error!("{}", cause.text);
        return Ok(Calibrated::Not(Exit::Trouble(cause)));
    };
    match stored {
        Some((record, expected)) => {
            let compared = compare::compare(&found, &expected);
            let verified = compared.iter().all(Compared::holds);
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

/// Nominal voltage of the coil, of which there is a golden part.
fn reference_voltage(config: &Path, recipe: &str) -> anyhow::Result<f64> {
    let plant = Plant::load(config)?;
    let Some(nominal_v) = load_recipe(config, recipe)?.device.part().nominal_v else {
        bail!("--recipe {recipe}: found a kind that needs no calibration, expected a relay");
    };
    if plant.golden.of_nominal(nominal_v).next().is_none() {
        bail!(
            "{}: found no golden part of {nominal_v} V, expected at least 3",
            config.join("golden.toml").display()
        );
    }
    Ok(nominal_v)
}

fn open(db: &Path) -> anyhow::Result<Store> {
    Ok(Store::open(db, &Identity::of_this_program())?)
}

fn to_verify(
    store: &Store,
    simulated: bool,
    nominal_v: f64,
) -> anyhow::Result<(CalibrationRecord, Calibration)> {
    let Some(record) = store.latest_calibration_of(simulated, nominal_v)? else {
        bail!(
            "--verify: found no calibration for {nominal_v} V in the history, expected one (relayrig calibrate)"
        );
    };
    if record.due_at_us <= jiff::Timestamp::now().as_microsecond() {
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
    open(db)?.save_calibration(&CalibrationRecord {
        made_at_us: found.made_at_us(),
        due_at_us: found.due_at_us(),
        hash: snapshot_hash(&body),
        body,
        verified: true,
    })?;
    Ok(Calibrated::Stored(Box::new(found)))
}

/// Microseconds since 1970 as a date in UTC.
///
/// # Errors
/// No date of the calendar.
pub fn date(us: i64) -> anyhow::Result<String> {
    let at = jiff::Timestamp::from_microsecond(us).context("date of the calibration")?;
    Ok(at.strftime("%Y-%m-%dT%H:%M:%SZ").to_string())
}

/// Why a rig may not take a lot on its stored calibration; nothing to say when there is none yet, as the run
/// then calibrates first.
pub(super) fn why_not(db: &Path, nominal_v: f64) -> anyhow::Result<Option<String>> {
    let Some(record) = open(db)?.latest_calibration_of(false, nominal_v)? else {
        return Ok(None);
    };
    let remedy = "run `relayrig calibrate` before the next lot";
    if record.due_at_us <= jiff::Timestamp::now().as_microsecond() {
        let due = date(record.due_at_us)?;
        return Ok(Some(format!("the calibration ran out at {due}: {remedy}")));
    }
    let made = date(record.made_at_us)?;
    Ok((!record.verified)
        .then(|| format!("the calibration made at {made} failed its last verification: {remedy}")))
}
