//! The simulated rig behind the lines of a run: built for it, or living on from run to run.

use super::order::LotOrder;
use super::source::Simulated;
use config::Plant;
use machine::dut::Calibration;
use rigsim::{Options, SharedRig};

/// A simulated rig that lives before and after the run.
#[derive(Debug, Clone)]
pub struct LiveRig {
    /// The rig; rig time of the run begins where it stands.
    pub rig: SharedRig,
    /// Wall clock at rig time zero of the run, microseconds since 1970 UTC.
    pub epoch_us: i64,
    /// What the rig was calibrated with before; without it the run calibrates.
    pub calibration: Option<Calibration>,
}

/// The faults of the source; and the magazine is loaded as the golden checks of the lot want it, as a person would.
fn faults(plant: &Plant, source: &Simulated) -> Vec<String> {
    let mut faults = source.faults.clone();
    let asked = faults.iter().any(|it| it.starts_with("golden_every"));
    let every = plant.lot.reference_check.after_parts.filter(|_| !asked);
    faults.extend(every.map(|every| format!("golden_every={every}")));
    faults
}

/// Golden parts and the lot in the magazine.
fn loaded(plant: &Plant, source: &Simulated, order: &LotOrder) -> Options {
    Options {
        config_dir: plant.dir.clone(),
        world: source.world.clone(),
        seed: source.seed,
        recipe: order.recipe.clone(),
        parts: order.count,
        reference_parts: true,
        faults: faults(plant, source),
    }
}

/// Builds the rig with golden parts and the lot in its magazine.
///
/// # Errors
/// Files or faults that the simulated rig refuses.
pub fn build(plant: &Plant, source: &Simulated, order: &LotOrder) -> anyhow::Result<SharedRig> {
    Ok(rigsim::build(&loaded(plant, source, order))?)
}

/// Builds the rig with an empty magazine.
///
/// # Errors
/// As [`build`].
pub fn build_empty(
    plant: &Plant,
    source: &Simulated,
    order: &LotOrder,
) -> anyhow::Result<SharedRig> {
    Ok(rigsim::build(&Options {
        parts: Some(0),
        reference_parts: false,
        ..loaded(plant, source, order)
    })?)
}

/// Does what a person does before a lot: empties the magazine and loads it.
///
/// # Errors
/// As [`build`].
pub fn load(
    rig: &SharedRig,
    plant: &Plant,
    source: &Simulated,
    order: &LotOrder,
) -> anyhow::Result<()> {
    Ok(rig.refill(&loaded(plant, source, order))?)
}
