//! Builds the simulated rig of a run, or loads a simulated rig that lives from run to run.

use super::order::LotOrder;
use super::source::Simulated;
use config::{Folder, Plant};
use machine::dut::Calibration;
use rigsim::{Files, Options, SharedRig};

/// A simulated rig that exists before and after the run.
#[derive(Debug, Clone)]
pub struct LiveRig {
    /// The rig; each run takes the present time of the rig as its rig time zero.
    pub rig: SharedRig,
    /// Wall clock at rig time zero of the run, microseconds since 1970 UTC.
    pub epoch_us: i64,
    /// Calibration of the rig; `None`: the run calibrates.
    pub calibration: Option<Calibration>,
}

impl LiveRig {
    /// Returns a rig without calibration whose rig time zero is now.
    pub fn new(rig: SharedRig) -> Self {
        Self {
            rig,
            epoch_us: jiff::Timestamp::now().as_microsecond(),
            calibration: None,
        }
    }
}

/// Returns the configuration in the form that the simulated rig reads; files in memory are copied as they are now.
pub fn files(folder: &Folder) -> Files {
    match folder {
        Folder::Directory(dir) => Files::Directory(dir.clone()),
        Folder::Memory(memory) => Files::Texts(memory.texts()),
    }
}

/// Returns the faults of the source. Adds fault `golden_every` with the interval of the lot's reference checks, unless
/// the source sets it; the magazine then holds a reference part for each check.
fn faults(plant: &Plant, source: &Simulated) -> Vec<String> {
    let mut faults = source.faults.clone();
    let asked = faults.iter().any(|it| it.starts_with("golden_every"));
    let every = plant.lot.reference_check.after_parts.filter(|_| !asked);
    faults.extend(every.map(|every| format!("golden_every={every}")));
    faults
}

/// Returns the options that fill the magazine with reference parts and the parts of the lot.
fn loaded(plant: &Plant, source: &Simulated, order: &LotOrder) -> Options {
    Options {
        files: files(&plant.folder),
        world: source.world.clone(),
        seed: source.seed,
        recipe: order.recipe.clone(),
        parts: order.count,
        reference_parts: true,
        faults: faults(plant, source),
    }
}

/// Builds the rig with reference parts and the lot in its magazine.
///
/// # Errors
/// Fails on files or faults that the simulated rig refuses.
pub fn build(plant: &Plant, source: &Simulated, order: &LotOrder) -> anyhow::Result<SharedRig> {
    Ok(rigsim::build(&loaded(plant, source, order))?)
}

/// Builds the rig with an empty magazine.
///
/// # Errors
/// Fails as [`build`] does.
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

/// Empties the magazine and loads it for the lot, as a person would. Without a truth file the rig forgets the parts of
/// earlier lots.
///
/// # Errors
/// Fails as [`build`] does.
pub fn load(
    rig: &SharedRig,
    plant: &Plant,
    source: &Simulated,
    order: &LotOrder,
) -> anyhow::Result<()> {
    if source.truth.is_none() {
        rig.forget_finished();
    }
    Ok(rig.refill(&loaded(plant, source, order))?)
}
