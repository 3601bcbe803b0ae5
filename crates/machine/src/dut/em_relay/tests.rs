//! Recipe, reference parts and instruments without error.
#![allow(clippy::unwrap_used)]

use crate::dut;
use crate::dut::accuracy::AccuracySettings;
use crate::dut::em_relay::Calibration;
use crate::dut::em_relay::Device;
use crate::dut::em_relay::calibration::{InputLine, OutputLine, Overshoot, Overshoots};
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::overshoot::OvershootModel;
use crate::dut::em_relay::points::Points;
use crate::dut::em_relay::settings::{ReferencePart, ReferenceSet, ReferenceSettings};
use crate::dut::recipe::{DeviceRecipe, Recipe};
use crate::gauge::Factor;
use crate::handling::tests::wiring;
use serde::Deserialize;
use std::sync::Arc;

const RIG: &str = include_str!("../../../../../config/rig.toml");

#[derive(Deserialize)]
struct Instruments {
    reference: ReferenceSettings,
    accuracy: AccuracySettings,
}

/// The default recipe on instruments without error, overshoot known.
pub fn context() -> Context {
    let recipe: Recipe = toml::from_str(include_str!(
        "../../../../../config/recipes/jzc-22f-012.toml"
    ))
    .unwrap();
    let instruments: Instruments = toml::from_str(RIG).unwrap();
    let DeviceRecipe::EmRelay(relay) = &recipe.device else {
        panic!("a relay");
    };
    Context {
        relay: Arc::new(relay.clone()),
        recipe: Arc::new(recipe),
        calibration: Arc::new(calibration()),
        points: Points::resolve(&wiring()).unwrap(),
        reference: instruments.reference,
        accuracy: instruments.accuracy,
        nominal_v_per_s: [96.0, 1.5],
        range: None,
        probe_contact: None,
        thorough: false,
        teaching: None,
    }
}

/// The same context as a device, with the reference parts of the plant.
pub fn device() -> dut::Device {
    device_of(context())
}

/// A device of this context.
pub fn device_of(context: Context) -> dut::Device {
    dut::Device::EmRelay(Box::new(Device::of(context, reference_parts())))
}

/// The reference parts for 12 V coils.
pub fn reference_parts() -> Vec<ReferencePart> {
    let set: ReferenceSet =
        toml::from_str(include_str!("../../../../../config/golden.toml")).unwrap();
    set.of_nominal(12.0).cloned().collect()
}

fn calibration() -> Calibration {
    let exact = |value| Factor::new(value, 1e-6);
    let overshoot = |coarse_v| Overshoot {
        fine_v: exact(0.0),
        at_v: 0.0,
        at_coarse_v: coarse_v,
        coarse: OvershootModel::guess(coarse_v, 1.0),
        judges: false,
    };
    Calibration {
        simulated: true,
        made_at_us: 0,
        due_at_us: i64::MAX,
        nominal_v: 12.0,
        coil_input: InputLine {
            gain: exact(1.0),
            offset_v: exact(0.0),
        },
        ohm_fine: exact(375.0),
        ohm_wide: exact(125.0),
        ohm_high: None,
        range_factor: 1.0,
        contact_mohm_per_v: exact(20.0),
        gate_delay_us: [exact(0.0); 2],
        level: OutputLine::IDEAL,
        coarse: OutputLine::IDEAL,
        fine: OutputLine::IDEAL,
        coarse_v_per_s: exact(96.0),
        fine_v_per_s: exact(1.5),
        temperature: None,
        probe_contact_ohm: 0.0,
        broken: Vec::new(),
        overshoots: Some(Overshoots {
            operate: overshoot(0.85),
            release: overshoot(-1.05),
        }),
    }
}
