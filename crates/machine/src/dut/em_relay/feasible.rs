//! Checks, before any motion, that the modules of a rig can perform a recipe, and that its limits are wider than the
//! guard bands.
//!
//! A strategy may need outputs that step or slew, a counter in counting mode, or channels that are enabled.

mod limits;
mod supply;

use super::coil::relative_per_kelvin;
use super::parameter::Expected;
use super::recipe::RelayRecipe;
use super::scale::Scale;
use super::settings::ReferenceSet;
use super::{Parameter, Strategy};
use crate::dut::Kind;
use crate::dut::accuracy::AccuracySettings;
use crate::dut::device::Rig;
use crate::dut::em_relay::points::{AnalogIn, AnalogOut, Counter, Points};
use crate::dut::recipe::Limits;
use crate::gauge::budget::COVERAGE_FACTOR;
use crate::rig::fault::Fault;
use crate::rig::point::AnalogOutput;
use crate::rig::wiring::Wiring;
pub use supply::demand;
use units::Celsius;

/// Longest accepted refresh interval of an output that ramps, ms: at 96 V/s an interval of 2 ms makes steps of 0.19 V.
pub const SLOWEST_REFRESH_MS: f64 = 2.0;
/// Fewest reference parts that a calibration accepts.
const FEWEST_PARTS: usize = 3;
/// Conversions per second of an I-7017F outside its fast mode.
const SLOW_CONVERSIONS_PER_S: f64 = 10.0;
/// Type code of an I-7080 in counting mode; 0x51 would be frequency mode.
const COUNTS: u8 = 0x50;

/// Returns every reason why the rig cannot perform the recipe, each with its key: missing references, bins or points
/// first, then what the supply, the modules or the uncertainty forbid.
pub fn faults(recipe: &RelayRecipe, limits: &Limits, rig: &Rig) -> Vec<Fault> {
    let references = check_references(recipe.part.nominal_v, rig);
    let mut faults = Vec::from_iter(references.err());
    match reach(recipe, limits, rig) {
        Ok(reach) => faults.extend(out_of_reach(recipe, limits, rig.accuracy, &reach)),
        Err(fault) => faults.push(fault),
    }
    faults.extend(check_early_stop(recipe, limits).err());
    faults.extend(guard_band_faults(recipe, limits, rig.accuracy));
    faults
}

/// What a recipe uses of the rig: the wiring in the supply range that serves the recipe, and the points.
struct Reach {
    wiring: Wiring,
    points: Points,
}

/// Finds the bins, the points and the supply range that the recipe uses.
///
/// # Errors
/// Fails with the first bin, point or range that the rig does not have.
fn reach(recipe: &RelayRecipe, limits: &Limits, rig: &Rig) -> Result<Reach, Fault> {
    let points = Points::resolve(rig.wiring);
    let demand = demand(recipe, limits, rig.accuracy);
    let (wiring, points) = Kind::EmRelay.reach(rig, points, Some(&demand))?;
    Ok(Reach { wiring, points })
}

/// Returns a fault for each demand of the recipe that supply, converters or modules cannot meet.
fn out_of_reach(
    recipe: &RelayRecipe,
    limits: &Limits,
    accuracy: &AccuracySettings,
    reach: &Reach,
) -> Vec<Fault> {
    let mut faults = supply::faults(recipe, limits, reach);
    faults.extend(limits::faults(recipe, limits, reach));
    for (key, strategy) in recipe.test.strategy.each() {
        let why = hindrance(strategy, &reach.wiring, &reach.points, accuracy);
        faults.extend(why.map(|why| {
            let expected = format!("a strategy that these modules can perform: {why}");
            Fault::new(format!("test.strategy.{key}"), strategy.name(), expected)
        }));
    }
    faults.extend(supply::check_ramp(recipe, reach, accuracy).err());
    faults
}

/// Checks that both contact resistances have limits if the recipe stops repeating closures once a result is clear of
/// its limits.
fn check_early_stop(recipe: &RelayRecipe, limits: &Limits) -> Result<(), Fault> {
    if recipe.test.strategy.contact.stops_early {
        for parameter in [
            Parameter::ContactResistanceNo,
            Parameter::ContactResistanceNc,
        ] {
            if limits.of(parameter).is_open() {
                let expected = format!("a limit of {parameter} to be clear of, or no early stop");
                return Err(Fault::new(
                    "test.strategy.contact.stops_early",
                    true,
                    expected,
                ));
            }
        }
    }
    Ok(())
}

/// Returns a fault for each pair of limits so close together that the guard bands leave no room between them.
fn guard_band_faults(
    recipe: &RelayRecipe,
    limits: &Limits,
    accuracy: &AccuracySettings,
) -> impl Iterator<Item = Fault> {
    Parameter::ALL.into_iter().filter_map(move |parameter| {
        let limit = limits.of(parameter);
        let (low, high) = (limit.low?, limit.high?);
        let least = 2.0 * expected_u(parameter, recipe, accuracy);
        (high - low < least).then(|| {
            let expected = format!(
                "limits more than {least:.3} apart: the guard bands at both ends leave nothing between"
            );
            Fault::new(format!("limits.{parameter}"), format!("{low} to {high}"), expected)
        })
    })
}

/// Refuses a rig without references on its board, or without enough reference parts of this nominal voltage.
///
/// # Errors
/// Fails with what `rig.toml` lacks, or with the nominal voltages of the reference parts that the rig has.
fn check_references(nominal_v: f64, rig: &Rig) -> Result<(), Fault> {
    let lacks = match (rig.reference, rig.reference_parts.parts.is_empty()) {
        (Some(_), false) => return check_reference_parts(nominal_v, rig.reference_parts),
        (None, true | false) => "references: rig.toml has no [reference]",
        (Some(_), true) => {
            "reference parts: rig.toml names no file of them in [calibration].golden"
        }
    };
    let expected = format!("a rig with {lacks}");
    Err(Fault::new("kind", "\"em_relay\"", expected))
}

fn check_reference_parts(nominal_v: f64, parts: &ReferenceSet) -> Result<(), Fault> {
    if parts.of_nominal(nominal_v).count() >= FEWEST_PARTS {
        return Ok(());
    }
    let mut others: Vec<f64> = parts.parts.iter().map(|part| part.nominal_v).collect();
    others.sort_by(f64::total_cmp);
    others.dedup();
    let others: Vec<String> = others.iter().map(|volts| format!("{volts} V")).collect();
    let expected = format!(
        "a coil voltage with at least {FEWEST_PARTS} reference parts; there are some of {}",
        others.join(", ")
    );
    Err(Fault::new("part.nominal_v", nominal_v, expected))
}

/// Returns the reason why the modules cannot perform a strategy; `None` when they can.
pub fn hindrance(
    strategy: Strategy,
    wiring: &Wiring,
    points: &Points,
    accuracy: &AccuracySettings,
) -> Option<String> {
    let slew = |output: AnalogOut| {
        let module = wiring.module(wiring.analog_out(points.source(output)).module);
        (
            module.name.as_str(),
            module.slew.and_then(|code| code.volt_per_second()),
        )
    };
    if let (name, Some(_)) = slew(AnalogOut::SupplyLevel) {
        return Some(format!(
            "module {name} slews, supply_level must step (slew code 0)"
        ));
    }
    let drop = wiring.analog_in(points.analog(AnalogIn::ContactDrop));
    let module = wiring.module(drop.module);
    if module
        .mask
        .is_some_and(|mask| mask >> drop.channel.get() & 1 == 0)
    {
        return Some(format!(
            "module {} masks the channel of contact_drop",
            module.name
        ));
    }
    let coil = wiring.analog_in(points.analog(AnalogIn::CoilVoltageFine));
    let coil = wiring.module(coil.module);
    if let Some(slow) = [module, coil].into_iter().find(|module| !module.fast)
        && accuracy.conversions_per_s > SLOW_CONVERSIONS_PER_S
    {
        let promised = accuracy.conversions_per_s;
        return Some(format!(
            "module {} is not in fast mode, accuracy.conversions_per_s promises {promised}",
            slow.name
        ));
    }
    let timer = wiring.module(wiring.counter(points.counter(Counter::Gate0)).module);
    if timer.type_code.0 != COUNTS {
        return Some(format!(
            "module {} does not count (type code 50)",
            timer.name
        ));
    }
    if !strategy.ramps() {
        return None;
    }
    if accuracy.ao_refresh_ms > SLOWEST_REFRESH_MS {
        let refresh = accuracy.ao_refresh_ms;
        return Some(format!(
            "outputs that ramp are refreshed every {refresh} ms only, {SLOWEST_REFRESH_MS} at most"
        ));
    }
    [AnalogOut::SupplyCoarse, AnalogOut::SupplyFine]
        .into_iter()
        .find_map(|output| match slew(output) {
            (_, Some(_)) => None,
            (name, None) => Some(format!(
                "module {name} steps, {output} must slew (slew code 1 to F)"
            )),
        })
}

/// Returns the slew rate of an output at the coil, volts per second; 0 for an output that steps.
pub fn nominal_v_per_s(wiring: &Wiring, output: AnalogOutput) -> f64 {
    let terminal = wiring.analog_out(output);
    let slew = wiring.module(terminal.module).slew;
    slew.and_then(|code| code.volt_per_second()).unwrap_or(0.0) * terminal.gain
}

/// Returns the expanded uncertainty of a parameter from the makers' accuracies, with only those terms that every
/// strategy has.
fn expected_u(parameter: Parameter, recipe: &RelayRecipe, accuracy: &AccuracySettings) -> f64 {
    let per_kelvin = relative_per_kelvin(Celsius(recipe.part.reference_temperature_c));
    let scale = Scale::new(recipe.part.nominal_v, 1.0);
    let threshold = |volts: f64| {
        let kelvin = volts * per_kelvin * accuracy.part_minus_track_k;
        kelvin.hypot(scale.operation_v(accuracy))
    };
    let u = match parameter.facts().expected {
        Expected::Coil => {
            let kelvin = accuracy.part_minus_track_k.hypot(accuracy.rtd_k);
            recipe.part.nominal_coil_ohm * per_kelvin * kelvin
        }
        Expected::Threshold(direction) => threshold(recipe.test.expected(direction).0),
        Expected::Usual { u, .. } => u,
    };
    COVERAGE_FACTOR * u
}

#[cfg(test)]
mod tests;
