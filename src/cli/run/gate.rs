//! Whether a lot may be run at all, looked at before anything is opened or moved.

use super::RunArgs;
use crate::config::Plant;
use crate::gauge::Recipe;
use crate::history::{AlarmRecord, Archive, Identity, LotRecord, LotState, Store};
use anyhow::bail;
use std::path::Path;

/// Refuses a lot that is held, one that was begun with another recipe and is not complete, a retest of nothing, and
/// golden checks without golden parts.
pub fn admit(db: &Path, plant: &Plant, recipe: &Recipe, args: &RunArgs) -> anyhow::Result<()> {
    let nominal_v = recipe.part.nominal_v;
    if plant.lot.golden_check.any() && plant.golden.of_nominal(nominal_v).next().is_none() {
        bail!(
            "{}: [golden_check]: found a check and no golden part of {nominal_v} V, expected one in {}",
            plant.dir.join("lot.toml").display(),
            plant.calibration.golden
        );
    }
    let standing = match db.exists() {
        true => Archive::open(db)?.standing(&args.lot)?,
        false => None,
    };
    let lot = &args.lot;
    let Some(standing) = standing else {
        if args.retest.is_some() {
            bail!(
                "--retest: found no run of lot \"{lot}\", expected one whose parts are tested again"
            );
        }
        return Ok(());
    };
    match standing.state {
        LotState::Held => bail!(
            "--lot: \"{lot}\" is held since {}: {}; expected a lot that may be run (relayrig lot release)",
            standing.since,
            standing.why.unwrap_or_default()
        ),
        LotState::Open | LotState::Running if standing.recipe_hash != recipe.hash => bail!(
            "--recipe: found {} {}, expected {} {}, by which lot \"{lot}\" was begun (relayrig lot close ends it)",
            recipe.name,
            &recipe.hash[..12],
            standing.recipe,
            standing.recipe_hash.get(..12).unwrap_or_default()
        ),
        LotState::Open | LotState::Running | LotState::Complete => Ok(()),
    }
}

/// Alarm of a rig that takes no lot before it was calibrated again.
pub const INVALID: &str = "calibration_invalid";

/// The lot gets a run without parts, whose alarm says why.
pub fn refuse(db: &Path, recipe: &Recipe, args: &RunArgs, why: &str) -> anyhow::Result<()> {
    let mut store = Store::open(db, &Identity::of_this_program())?;
    let now_us = jiff::Timestamp::now().as_microsecond();
    store.begin_lot(&LotRecord {
        lot: args.lot.clone(),
        recipe: recipe.name.clone(),
        recipe_snapshot: recipe.source_text.clone(),
        recipe_hash: recipe.hash.clone(),
        opened_at_us: now_us,
        retest: args.retest.clone(),
        ..LotRecord::default()
    })?;
    store.alarm(&AlarmRecord {
        lot: Some(args.lot.clone()),
        code: INVALID.into(),
        text: why.to_owned(),
        raised_at_us: now_us,
        ..AlarmRecord::default()
    })?;
    Ok(store.close_lot(&args.lot, now_us)?)
}
