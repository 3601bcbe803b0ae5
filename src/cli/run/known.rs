//! What the history knows of the rig before a run.

use super::Controls;
use super::recorder::Setup;
use anyhow::Context;
use history::{AlarmLeft, Store};
use machine::dut::Calibration;
use machine::handling::inside::Inside;
use machine::handling::wear::Uses;

/// What a run takes over.
pub struct Known {
    /// A calibration that is still valid.
    pub calibration: Option<Calibration>,
    /// Uses of what wears.
    pub worn: Uses,
    /// Alarms that nobody has seen yet.
    pub alarms: Vec<AlarmLeft>,
    /// What the run before left inside.
    pub left: Inside,
}

impl Known {
    /// A stage brings its own calibration, a simulated rig is calibrated anew.
    pub(super) fn read(store: &Store, setup: &Setup, controls: &Controls) -> anyhow::Result<Self> {
        let simulated = setup.args.rig.sim;
        let calibration = match &controls.stage {
            Some(stage) => stage.calibration.clone(),
            None if simulated || controls.calibrates.is_some() => None,
            None => valid_calibration(store, setup)?,
        };
        let left = match simulated && controls.rig_is_new() {
            true => Inside::default(),
            false => store.left_inside(simulated)?,
        };
        Ok(Self {
            calibration,
            worn: worn(store, simulated)?,
            alarms: store.alarms_left(simulated)?,
            left,
        })
    }
}

fn worn(store: &Store, simulated: bool) -> anyhow::Result<Uses> {
    let wear = store.wear(simulated)?;
    let of = |name: &str| {
        wear.iter()
            .find(|it| it.name == name)
            .map_or(0, |it| it.count)
    };
    Ok(Uses {
        probe_touches: of("probe_touches"),
        jaw_closings: of("jaw_closings"),
    })
}

/// The stored calibration, provided it is not overdue.
fn valid_calibration(store: &Store, setup: &Setup) -> anyhow::Result<Option<Calibration>> {
    let Some(nominal_v) = setup.recipe.rated_v() else {
        return Ok(None);
    };
    let Some(record) = store.latest_calibration_of(false, nominal_v)? else {
        return Ok(None);
    };
    let calibration: Calibration =
        serde_json::from_str(&record.body).context("the stored calibration cannot be read")?;
    let fits = calibration.is_complete() && calibration.made_at_us() <= setup.epoch_us;
    Ok((record.verified && fits && record.due_at_us > setup.epoch_us).then_some(calibration))
}
