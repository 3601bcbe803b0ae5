//! Levels of the reference coil in each range of the supply.
#![allow(clippy::unwrap_used)]
use super::levels::Levels;
use crate::dut::accuracy::FULL_SCALE_V;
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::points::{AnalogIn, Points};
use crate::dut::em_relay::recipe::CoilChannels;
use crate::dut::em_relay::tests::context;
use crate::handling::tests::wiring;
use std::sync::Arc;
use units::Volt;

/// Levels in the range with this name, of a recipe with these channels.
fn levels(range: &str, channels: CoilChannels) -> (Levels, Context) {
    let wiring = wiring();
    let mut ranges = wiring.supply_ranges.iter();
    let range = ranges.find(|it| it.name == range).unwrap();
    let mut context = context();
    context.points = Points::resolve(&wiring.in_range(range)).unwrap();
    context.range = Some(range.clone());
    Arc::make_mut(&mut context.relay).test.coil_channels = channels;
    (Levels::of(&context), context)
}

#[test]
fn levels_stay_within_every_range_and_channel() {
    use CoilChannels::{CoarseCurrent, Fine, HighCurrent};
    for range in ["x0_75", "x1_5", "x3", "x6"] {
        for channels in [Fine, CoarseCurrent, HighCurrent] {
            let (levels, context) = levels(range, channels);
            let limits = context.range.as_ref().unwrap();
            let gain = context.points.gain(AnalogIn::CoilVoltageFine).unwrap();
            assert!(levels.high.0 * gain < FULL_SCALE_V, "{range}");
            for (level, _) in levels.steps() {
                let current = level.0 / context.reference.coil_ohm;
                assert!(level < limits.max && level > Volt(0.0), "{range}");
                assert!(current < limits.max_current.unwrap().0, "{range}");
            }
            let best = levels.current.unwrap_or(levels.high);
            let gain = context.points.gain(channels.current()).unwrap();
            assert!(best.0 / context.reference.coil_ohm * gain < FULL_SCALE_V);
        }
    }
}

#[test]
fn a_12_v_recipe_needs_two_levels() {
    let (levels, _) = levels("x1_5", CoilChannels::Fine);
    let steps: Vec<Volt> = levels.steps().map(|(level, _)| level).collect();
    assert_eq!(steps, [Volt(5.7 * (1.5 / 5.7)), Volt(5.7)]);
}
