//! `relayrig calibrate`: the factors of a rig from its references and golden parts, or their verification.
//!
//! Both measure as a run does before its lot, with no part of a lot after the golden ones. Calibrating stores
//! what was found. `--verify` stores no factors: each found factor must lie within the combined expanded
//! uncertainty (k = 3, for fourteen must hold at once) of the stored one, and the stored calibration is marked with
//! the outcome. A rig whose calibration ran out or failed takes no lot until it was calibrated again.

mod compare;

use super::rig::RigArgs;
use super::run::{self, Controls, Orders, RunArgs};
use anyhow::{Context, bail};
pub(super) use compare::K_OF_ALL;
use compare::{Compared, K};
use config::{Plant, load_recipe};
use history::{CalibrationRecord, Identity, Store, snapshot_hash};
use machine::dut::Calibration;
use serde_json::json;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, OnceLock};

/// The stored factors do not hold any more.
const NOT_VERIFIED: i32 = 1;
/// Lot that the golden parts are recorded in.
const LOT: &str = "calibration";

/// What to calibrate.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  relayrig calibrate --sim
  relayrig calibrate --sim --verify --json
  relayrig calibrate --line measure=/dev/ttyUSB0 --line motion=/dev/ttyUSB1

Exit status: 0 calibrated or verified, 1 verification failed, 2 bad input or nothing to verify, 3 the rig has trouble.")]
pub struct CalibrateArgs {
    /// The rig to calibrate.
    #[command(flatten)]
    pub rig: RigArgs,
    /// Measure again and compare with the stored calibration
    #[arg(long)]
    pub verify: bool,
    /// Recipe in config/recipes whose coil voltage chooses the golden parts
    #[arg(long, value_name = "NAME", default_value = "jzc-22f-012")]
    pub recipe: String,
    /// One JSON object per factor, then a summary
    #[arg(long)]
    pub json: bool,
}

/// Runs the command; the result is the exit status.
pub fn run(config: &Path, db: &Path, args: &CalibrateArgs) -> anyhow::Result<i32> {
    let plant = Plant::load(config)?;
    let Some(nominal_v) = load_recipe(config, &args.recipe)?.rated_v() else {
        bail!(
            "--recipe {}: found a kind that needs no calibration, expected a relay",
            args.recipe
        );
    };
    if plant.golden.of_nominal(nominal_v).next().is_none() {
        bail!(
            "{}: found no golden part of {nominal_v} V, expected at least 3",
            config.join("golden.toml").display()
        );
    }
    let stored = if args.verify {
        Some(to_verify(&open(db)?, args.rig.sim, nominal_v)?)
    } else {
        None
    };
    let found = Arc::new(OnceLock::new());
    let controls = Controls {
        calibrates: Some(Arc::clone(&found)),
        ..Controls::new(true)
    };
    let status = run::run_with(config, db, &golden_only(args), &controls, Orders::Nobody)?;
    if status != super::DONE {
        return Ok(status);
    }
    let Some(found) = found.get() else {
        tracing::error!("the golden parts ended without a calibration");
        return Ok(super::RIG_TROUBLE);
    };
    match stored {
        Some((record, expected)) => verify(db, args, record, &expected, found),
        None => keep(db, args, found),
    }
}

fn open(db: &Path) -> anyhow::Result<Store> {
    Ok(Store::open(db, &Identity::of_this_program())?)
}

/// A lot without parts of its own.
fn golden_only(args: &CalibrateArgs) -> RunArgs {
    RunArgs {
        rig: args.rig.clone(),
        lot: LOT.into(),
        recipe: args.recipe.clone(),
        count: Some(0),
        truth: None,
        retest: None,
        json: false,
        study: None,
    }
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

fn keep(db: &Path, args: &CalibrateArgs, found: &Calibration) -> anyhow::Result<i32> {
    let body = serde_json::to_string(found)?;
    open(db)?.save_calibration(&CalibrationRecord {
        made_at_us: found.made_at_us(),
        due_at_us: found.due_at_us(),
        hash: snapshot_hash(&body),
        body,
        verified: true,
    })?;
    let mut out = std::io::stdout().lock();
    for it in found.factors() {
        let (value, u) = (it.factor.value, K * it.factor.u);
        if args.json {
            let it = json!({"type": "factor", "factor": it.name, "unit": it.unit, "value": value, "expanded_u": u});
            writeln!(out, "{it}")?;
        } else {
            writeln!(
                out,
                "{:<18} {value:>14.6} +- {u:<10.6} {}",
                it.name, it.unit
            )?;
        }
    }
    let (made, due) = (date(found.made_at_us())?, date(found.due_at_us())?);
    if args.json {
        let it = json!({"type": "calibration", "made_at": made, "due_at": due, "simulated": found.is_simulated(), "nominal_v": found.nominal_v(), "k": K});
        writeln!(out, "{it}")?;
    } else {
        writeln!(out, "made {made}, due {due}; +- is U (k = {K})")?;
    }
    Ok(super::DONE)
}

fn verify(
    db: &Path,
    args: &CalibrateArgs,
    record: CalibrationRecord,
    expected: &Calibration,
    found: &Calibration,
) -> anyhow::Result<i32> {
    let compared = compare::compare(found, expected);
    let verified = compared.iter().all(Compared::holds);
    let due = date(record.due_at_us)?;
    open(db)?.save_calibration(&CalibrationRecord { verified, ..record })?;
    let mut out = std::io::stdout().lock();
    for it in &compared {
        if args.json {
            let it = json!({"type": "factor", "factor": it.name, "unit": it.unit, "found": it.found, "expected": it.expected, "expanded_u": it.expanded_u, "holds": it.holds()});
            writeln!(out, "{it}")?;
        } else {
            writeln!(out, "{it}")?;
        }
    }
    if args.json {
        let it =
            json!({"type": "verification", "verified": verified, "due_at": due, "k": K_OF_ALL});
        writeln!(out, "{it}")?;
    } else {
        let outcome = if verified {
            "verified"
        } else {
            "verification failed"
        };
        writeln!(
            out,
            "{outcome}, due {due}; +- is the combined U (k = {K_OF_ALL})"
        )?;
    }
    Ok(if verified { super::DONE } else { NOT_VERIFIED })
}

fn date(us: i64) -> anyhow::Result<String> {
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
