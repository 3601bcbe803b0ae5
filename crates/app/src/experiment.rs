//! An experiment on a rig with a rack: a run without parts that measures properties of the rig.

use super::exit::Exit;
use super::lot::{Purpose, Subscriber};
use super::order::{Files, LotOrder};
use super::source::RigSource;
use anyhow::bail;
use config::{Plant, load_recipe};
use machine::dut::experiment::{Experiment, Found};
use std::sync::OnceLock;

/// Name of the lot under which the history keeps the run.
const LOT: &str = "experiment";

/// Runs an experiment in the temperature windows of `recipe`. Returns what the experiment found, or how the run ended
/// without a finding. The rack heats up behind its locked door under every check of a batch, and cools before the run
/// ends.
///
/// # Errors
/// Fails on a rig without a rack, for a faulty recipe, or as [`super::run_lot`] does.
pub fn experiment(
    files: &Files,
    source: &RigSource,
    (recipe, what): (&str, Experiment),
    outer: &mut dyn Subscriber,
) -> anyhow::Result<Result<Found, Exit>> {
    let plant = Plant::load(&files.config)?;
    if plant.wiring.rack().is_none() {
        bail!(
            "{}: found no [rack], expected a rig with a chamber",
            files.config.path("rig.toml").display()
        );
    }
    load_recipe(&files.config, recipe)?;
    let order = LotOrder {
        lot: LOT.into(),
        recipe: recipe.to_owned(),
        count: Some(0),
        retest: None,
    };
    let mut both = (OnceLock::new(), outer);
    let purpose = Purpose::Experiment(what);
    let exit = super::run_lot(files, source, &order, purpose, &mut both)?;
    Ok(both.0.into_inner().ok_or(exit))
}
