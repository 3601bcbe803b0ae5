//! What the history knows of the rig before a run.

use super::{LotContext, Purpose};
use anyhow::Context;
use history::{Store, UnacknowledgedAlarm};
use machine::dut::Calibration;
use machine::handling::inside::Inside;
use machine::handling::wear::Uses;

/// What a run takes over.
pub(super) struct TakenOver {
    /// A calibration that is still valid, made in the supply range of the recipe.
    pub calibration: Option<Calibration>,
    /// Uses of what wears.
    pub worn: Uses,
    /// Alarms that no person has acknowledged or seen yet.
    pub alarms: Vec<UnacknowledgedAlarm>,
    /// What the run before left inside.
    pub left: Inside,
}

impl TakenOver {
    /// A live rig brings its own calibration, a simulated rig is calibrated anew.
    pub fn read(store: &Store, context: &LotContext) -> anyhow::Result<Self> {
        let simulated = context.is_simulated();
        let calibration = match context.purpose {
            _ if simulated => brought(context),
            Purpose::Calibration => None,
            Purpose::Lot | Purpose::BetweenLots(_) => valid_calibration(store, context)?,
        };
        let (plant, recipe) = (context.plant, context.recipe);
        let wiring = recipe.wired(&plant.wiring, &plant.accuracy)?;
        let range = wiring.supply_range.as_ref();
        let calibration = calibration.filter(|it| range.is_none_or(|range| it.holds_in(range)));
        // What an earlier run left inside was inside of another rig.
        let left = match simulated && is_new(context) {
            true => Inside::default(),
            false => store.left_inside(simulated)?,
        };
        Ok(Self {
            calibration,
            worn: worn(store, simulated)?,
            alarms: store.unacknowledged_alarms(simulated)?,
            left,
        })
    }
}

/// The calibration of a simulated rig that lives on.
#[cfg(feature = "sim")]
fn brought(context: &LotContext) -> Option<Calibration> {
    context.source.live()?.calibration.clone()
}

#[cfg(not(feature = "sim"))]
fn brought(_: &LotContext) -> Option<Calibration> {
    None
}

/// A simulated rig whose time begins with this run.
#[cfg(feature = "sim")]
fn is_new(context: &LotContext) -> bool {
    let live = context.source.live();
    live.is_none_or(|live| live.rig.now_us() == 0)
}

#[cfg(not(feature = "sim"))]
fn is_new(_: &LotContext) -> bool {
    true
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
fn valid_calibration(store: &Store, context: &LotContext) -> anyhow::Result<Option<Calibration>> {
    let Some(nominal_v) = context.recipe.device.part().nominal_v else {
        return Ok(None);
    };
    let Some(record) = store.latest_calibration_of(false, nominal_v)? else {
        return Ok(None);
    };
    let calibration: Calibration =
        serde_json::from_str(&record.body).context("the stored calibration cannot be read")?;
    let fits = calibration.is_complete() && calibration.made_at_us() <= context.epoch_us;
    Ok((record.verified && fits && record.due_at_us > context.epoch_us).then_some(calibration))
}
