//! Whether a lot may be run at all, looked at before anything is opened or moved.

use super::RunArgs;
use crate::config::Plant;
use crate::gauge::Recipe;
use crate::history::{Archive, LotState};
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
