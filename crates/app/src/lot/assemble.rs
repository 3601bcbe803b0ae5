//! Builds the cycle of a run from configuration, recipe and calibration.

use super::prior_state::PriorState;
use super::{LotContext, Purpose};
use anyhow::Context;
use bus::Pace;
use config::Plant;
use cycle::{Cycle, CycleLinks, InstrumentEnds, LineEnds};
use history::UnacknowledgedAlarm;
use machine::dut::Recipe;
use machine::dut::device::Rig;
use machine::guard::{Actuator, Guard, PartSize};
use machine::handling::mechanism::Mechanism;
use machine::handling::moves::Strokes;
use machine::rig::axis::AxisTable;
use machine::rig::handling::Handling;
use machine::station::{Plan, Station};
use machine::view::{Mimic, MimicBody};
use std::sync::Arc;
use units::RigTime;

pub(super) fn cycle(
    context: &LotContext,
    prior_state: PriorState,
    pace: Pace,
    ends: (Vec<LineEnds>, Vec<InstrumentEnds>),
    links: CycleLinks,
    attended: bool,
) -> anyhow::Result<Cycle> {
    let PriorState {
        calibration,
        uses,
        alarms,
        left,
        serials,
    } = prior_state;
    let plant = context.plant;
    let recipe = Arc::clone(context.recipe);
    let wiring = Arc::new(recipe.wired(&plant.wiring, &plant.accuracy)?);
    let calibrated = calibration.is_some();
    let rig = Rig {
        wiring: &wiring,
        ..plant.rig()
    };
    let device = recipe
        .device
        .on_rig(Arc::clone(&recipe), &rig, calibration)?;
    let plan = Plan {
        attended,
        between_lots: context.purpose.rest_state(),
        count: context.order.count,
        reference_serials: match context.purpose.rest_state() {
            Some(_) => Vec::new(),
            None => device.reference_serials(),
        },
        calibrated: calibrated || device.due_at_us().is_none(),
        valid_us: (plant.calibration.valid_h * 3.6e9) as i64,
        epoch_us: context.epoch_us,
        simulated: context.is_simulated(),
        lot: plant.lot.clone(),
        worn: uses,
        left,
        serials,
        prompts: match context.purpose {
            Purpose::Lot => plant.prompts(context.recipe).cloned().collect(),
            Purpose::BetweenLots(_) | Purpose::Calibration | Purpose::Experiment(_) => Vec::new(),
        },
        experiment: context.purpose.experiment(),
    };
    let (mut station, guard) = match &wiring.handling {
        Handling::Feeder(table) => {
            let mut guard = guard(plant)?;
            let size = size_of(context.recipe);
            let strokes = strokes(&mut guard, &table.axis, size);
            let mechanism = Mechanism::new(strokes, table.strokes, size);
            let station = Station::new(plan, device, table.axis.clone(), mechanism);
            (station, Some(guard))
        }
        Handling::Rack(rack) => (Station::with_rack(plan, device, rack.clone()), None),
    };
    // An unattended run raises no alarms of earlier runs again, because no operator is there to acknowledge them.
    for left in alarms.into_iter().filter(|_| attended) {
        raise_again(&mut station, left, context.epoch_us);
    }
    Ok(Cycle::new(wiring, pace, station, guard, ends, links))
}

/// Returns the drawing of the machine for screens, with parts of the size in `recipe`; empty on a rig where nothing moves.
pub fn mimic(plant: &Plant, recipe: &Recipe) -> anyhow::Result<Mimic> {
    if plant.scene.is_none() {
        return Ok(Mimic { bodies: Vec::new() });
    }
    let guard = guard(plant)?;
    let ride = |(it, way): (Actuator, [f64; 3])| (it.name().to_owned(), way);
    let bodies = guard.drawing(&size_of(recipe)).into_iter();
    let bodies = bodies.map(|body| MimicBody {
        id: body.id,
        rides: body.rides.into_iter().map(ride).collect(),
        above: body.above,
        front: body.front,
    });
    Ok(Mimic {
        bodies: bodies.collect(),
    })
}

fn strokes(guard: &mut Guard, axis: &AxisTable, size: PartSize) -> Strokes {
    Strokes {
        sensor_off_mm: Actuator::ALL.map(|actuator| guard.sensor_off_mm(actuator)),
        probes_beside_pusher: guard.probes_rise_beside_pusher(size),
        length_mm: Actuator::ALL.map(|actuator| guard.stroke_mm(actuator).1),
        axis_mm: axis
            .stations()
            .map(|at| (at, axis.point(at).x_mm))
            .collect(),
    }
}

fn guard(plant: &Plant) -> anyhow::Result<Guard> {
    let scene = plant
        .scene
        .as_ref()
        .context("the rig has no feeder, so it has no scene.toml")?;
    Guard::build(scene).context("config/scene.toml")
}

/// Raises an alarm again that an earlier run left unacknowledged.
fn raise_again(station: &mut Station, left: UnacknowledgedAlarm, epoch_us: i64) {
    let Some(alarm) = left.alarm() else {
        return tracing::warn!(code = left.code, "skipped an unknown alarm");
    };
    let until = left.shelved_until_us.map(|until_us| until_us - epoch_us);
    let until = until.and_then(|us| u64::try_from(us).ok()).map(RigTime);
    station.annunciator_mut().inherit(alarm, left.count, until);
}

fn size_of(recipe: &Recipe) -> PartSize {
    let part = recipe.device.part();
    PartSize {
        body_mm: part.body_mm,
        pin_length_mm: part.pin_length_mm,
    }
}
