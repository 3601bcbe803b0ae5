//! Reads what a run takes over from the history.

use super::{LotContext, Purpose};
use anyhow::Context;
use history::{Store, UnacknowledgedAlarm};
use machine::dut::Calibration;
use machine::dut::device::Made;
use machine::handling::inside::Inside;
use machine::handling::serial::{Serials, Source, SourceName};
use machine::handling::wear::Uses;
use std::collections::BTreeSet;
use units::Span;

/// State of the rig that a run takes over.
pub(super) struct PriorState {
    /// Calibration that is still valid and was made in the supply range of the recipe; `None`: the run calibrates.
    pub calibration: Option<Calibration>,
    /// Use counts of the wearing parts, from the history.
    pub uses: Uses,
    /// Unacknowledged alarms of earlier runs.
    pub alarms: Vec<UnacknowledgedAlarm>,
    /// Parts that the last run left inside.
    pub left: Inside,
    /// Serial numbers of the lot's parts.
    pub serials: Serials,
}

impl PriorState {
    /// Reads the state from `store`. Takes the calibration of a simulated rig from the live rig, or else from the
    /// certificates of the plant, never from `store`.
    pub fn read(store: &Store, context: &LotContext) -> anyhow::Result<Self> {
        let simulated = context.is_simulated();
        let calibration = match context.purpose {
            _ if simulated => live_calibration(context).or_else(|| certified(context)),
            Purpose::Calibration => None,
            Purpose::Lot | Purpose::BetweenLots(_) | Purpose::Experiment(_) => {
                valid_calibration(store, context)?.or_else(|| certified(context))
            }
        };
        let (plant, recipe) = (context.plant, context.recipe);
        let wiring = recipe.wired(&plant.wiring, &plant.accuracy)?;
        let range = wiring.supply_range.as_ref();
        let calibration = calibration
            .filter(|it| range.is_none_or(|range| it.facts().range_factor == range.factor));
        // Parts that an earlier run left inside belong to another simulated rig.
        let left = match simulated && is_new(context) {
            true => Inside::default(),
            false => store.left_inside(simulated)?,
        };
        Ok(Self {
            calibration,
            uses: uses(store, simulated)?,
            alarms: store.unacknowledged_alarms(simulated)?,
            left,
            serials: serials(store, context)?,
        })
    }
}

/// Returns the serial numbers of the run's parts. In a retest the parts return with the numbers that they already have.
fn serials(store: &Store, context: &LotContext) -> anyhow::Result<Serials> {
    let (order, plant) = (context.order, context.plant);
    let settings = plant.lot.serial.as_ref();
    let Some(settings) = settings.filter(|_| context.purpose == Purpose::Lot) else {
        return Ok(Serials::default());
    };
    let source = match settings.source {
        SourceName::Counted => Source::Counted {
            template: settings.template.clone(),
            lot: order.lot.clone(),
            given: store.parts_numbered(&order.lot)?,
        },
        SourceName::Reader => Source::Reader {
            timeout: Span::ms(
                plant
                    .serial_reader
                    .as_ref()
                    .map_or(0, |it| it.timeout_ms as u64),
            ),
        },
        SourceName::Wedge => Source::Wedge,
    };
    let taken = match order.retest {
        None => store.serials(&order.lot)?,
        Some(_) => BTreeSet::new(),
    };
    Ok(Serials::new(source, taken))
}

/// Returns the calibration of a live simulated rig; `None` without a live rig or a calibration.
#[cfg(feature = "sim")]
fn live_calibration(context: &LotContext) -> Option<Calibration> {
    context.source.live()?.calibration.clone()
}

#[cfg(not(feature = "sim"))]
fn live_calibration(_: &LotContext) -> Option<Calibration> {
    None
}

/// Returns true for a simulated rig whose rig time begins with this run.
#[cfg(feature = "sim")]
fn is_new(context: &LotContext) -> bool {
    let live = context.source.live();
    live.is_none_or(|live| live.rig.now_us() == 0)
}

#[cfg(not(feature = "sim"))]
fn is_new(_: &LotContext) -> bool {
    true
}

fn uses(store: &Store, simulated: bool) -> anyhow::Result<Uses> {
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

/// Returns the calibration that the certificates of the plant give; `None` for a kind that is calibrated on parts, and
/// for an expired certificate (admission has then refused the lot already).
fn certified(context: &LotContext) -> Option<Calibration> {
    let made = Made {
        at_us: context.epoch_us,
        valid_us: (context.plant.calibration.valid_h * 3.6e9) as i64,
        simulated: context.is_simulated(),
    };
    let device = &context.recipe.device;
    let found = device.certified(&context.plant.rig(), made);
    found.filter(|it| it.facts().due_at_us > context.epoch_us)
}

/// Returns the newest stored calibration for the coil voltage of the recipe; `None` when it is missing, incomplete,
/// overdue, dated in the future, or failed its verification.
fn valid_calibration(store: &Store, context: &LotContext) -> anyhow::Result<Option<Calibration>> {
    let Some(nominal_v) = context.recipe.device.calibrated_for() else {
        return Ok(None);
    };
    let Some(record) = store.latest_calibration_of(false, nominal_v)? else {
        return Ok(None);
    };
    let calibration: Calibration =
        serde_json::from_str(&record.body).context("the stored calibration cannot be read")?;
    let facts = calibration.facts();
    let fits = facts.is_complete && facts.made_at_us <= context.epoch_us;
    let holds = record.verified && !record.is_overdue(context.epoch_us);
    Ok((fits && holds).then_some(calibration))
}
