//! Demand of a test on the supply, and whether the supply range that meets this demand suits the recipe.

use super::{Reach, nominal_v_per_s};
use crate::dut::accuracy::{AccuracySettings, READABLE_V};
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::points::{AnalogIn, AnalogOut, Points};
use crate::dut::em_relay::recipe::RelayRecipe;
use crate::dut::recipe::Limits;
use crate::rig::fault::Fault;
use crate::rig::supply::SupplyDemand;
use crate::rig::wiring::Wiring;
use units::{Ampere, Volt};

/// Lowest voltage at the terminal of a current channel that a test can distinguish from no current.
const LEAST_CURRENT_V: f64 = 0.3;
/// Assumed relative difference of a good coil from its nominal resistance, where the recipe sets no limit.
const USUAL_SPREAD: f64 = 0.1;

/// Returns the demand of a test on the supply. Voltage: the nominal voltage or the top of the coarse ramp, whichever is
/// higher, with the tolerance of the sources. Current: that of the lowest accepted coil at nominal voltage.
pub fn demand(recipe: &RelayRecipe, limits: &Limits, accuracy: &AccuracySettings) -> SupplyDemand {
    let (part, test) = (&recipe.part, &recipe.test);
    let tolerance = 1.0 + accuracy.ao_gain_pct / 100.0;
    let top_v = test.prebias_v + test.coarse_span_v;
    let (volts, volts_key) = match top_v > part.nominal_v {
        true => (top_v, "test.coarse_span_v"),
        false => (part.nominal_v, "part.nominal_v"),
    };
    let (low_ohm, _) = accepted_ohm(recipe, limits);
    let current_key = match limits.of(Parameter::CoilResistance).low {
        Some(_) => "limits.coil_resistance_ohm.low",
        None => "part.nominal_coil_ohm",
    };
    SupplyDemand {
        volts: Volt(volts * tolerance),
        volts_key,
        current: Ampere(part.nominal_v / low_ohm),
        current_key,
    }
}

/// Returns the lowest and the highest coil resistance of a good part, ohm.
fn accepted_ohm(recipe: &RelayRecipe, limits: &Limits) -> (f64, f64) {
    let (nominal, limit) = (
        recipe.part.nominal_coil_ohm,
        limits.of(Parameter::CoilResistance),
    );
    (
        limit.low.unwrap_or(nominal * (1.0 - USUAL_SPREAD)),
        limit.high.unwrap_or(nominal * (1.0 + USUAL_SPREAD)),
    )
}

/// Returns a fault for each demand of the recipe that the outputs or the channels of the supply range cannot meet.
pub(super) fn faults(recipe: &RelayRecipe, limits: &Limits, reach: &Reach) -> Vec<Fault> {
    let Reach { wiring, points } = reach;
    let mut faults = Vec::from_iter(output_faults(recipe, wiring, points));
    faults.extend(check_voltage(recipe, wiring, points).err());
    faults.extend(check_current(recipe, limits, wiring, points).err());
    faults
}

/// Returns a fault when the level output does not reach the pre-bias, and one when the coarse output does not reach the
/// height of the coarse ramp.
fn output_faults(
    recipe: &RelayRecipe,
    wiring: &Wiring,
    points: &Points,
) -> impl Iterator<Item = Fault> {
    let test = &recipe.test;
    let needed = [
        ("test.prebias_v", AnalogOut::SupplyLevel, test.prebias_v),
        (
            "test.coarse_span_v",
            AnalogOut::SupplyCoarse,
            test.coarse_span_v,
        ),
    ];
    needed.into_iter().filter_map(|(key, output, volts)| {
        let cannot = wiring.reaches(points.source(output), Volt(volts)).err()?;
        Some(Fault::new(key, volts, cannot.to_string()))
    })
}

/// Checks that the channel of the coil voltage reads the pre-bias.
fn check_voltage(recipe: &RelayRecipe, wiring: &Wiring, points: &Points) -> Result<(), Fault> {
    let channel = AnalogIn::CoilVoltageFine;
    let gain = wiring.analog_in(points.analog(channel)).gain;
    let (prebias_v, most_v) = (recipe.test.prebias_v, READABLE_V / gain);
    if prebias_v <= most_v {
        return Ok(());
    }
    let expected = format!("at most {most_v:.2} V: {channel} reads no more in this supply range");
    Err(Fault::new("test.prebias_v", prebias_v, expected))
}

/// Checks that the current channel of the recipe reads the coil at the pre-bias.
fn check_current(
    recipe: &RelayRecipe,
    limits: &Limits,
    wiring: &Wiring,
    points: &Points,
) -> Result<(), Fault> {
    let (test, (low_ohm, high_ohm)) = (&recipe.test, accepted_ohm(recipe, limits));
    let (channels, point) = (test.coil_channels, test.coil_channels.current());
    let refused = |found: String, expected: String| {
        let found = format!("{}{found}", channels.name());
        Err(Fault::new("test.coil_channels", found, expected))
    };
    let Some(input) = points.wired_analog(point) else {
        let expected = format!("channels of this rig: rig.toml has no [analog_in].{point}");
        return refused(String::new(), expected);
    };
    let gain = wiring.analog_in(input).gain;
    let current_ma = |ohm: f64| test.prebias_v / ohm * 1e3;
    let (least_ma, most_ma) = (LEAST_CURRENT_V / gain * 1e3, READABLE_V / gain * 1e3);
    if current_ma(low_ohm) > most_ma {
        let found = format!(", {:.1} mA at the pre-bias", current_ma(low_ohm));
        let expected = format!("channels that read it: {point} reads at most {most_ma:.1} mA");
        return refused(found, expected);
    }
    if current_ma(high_ohm) < least_ma {
        let found = format!(", {:.2} mA at the pre-bias", current_ma(high_ohm));
        let expected = format!("channels that tell it from none: {point} from {least_ma:.2} mA on");
        return refused(found, expected);
    }
    Ok(())
}

/// Checks that the coarse ramp is slow enough: between two refreshes of its output it may rise by no more than the
/// scatter of the lot's thresholds; a faster ramp cannot tell one part from another.
pub(super) fn check_ramp(
    recipe: &RelayRecipe,
    reach: &Reach,
    accuracy: &AccuracySettings,
) -> Result<(), Fault> {
    let test = &recipe.test;
    if !test.strategy.each().iter().any(|(_, it)| it.ramps()) {
        return Ok(());
    }
    let v_per_s = nominal_v_per_s(&reach.wiring, reach.points.source(AnalogOut::SupplyCoarse));
    let step_v = v_per_s * accuracy.ao_refresh_ms * 1e-3;
    let (sd_v, key) = (test.expected_operate_sd_v, "test.expected_operate_sd_v");
    if step_v <= sd_v {
        return Ok(());
    }
    let expected = format!(
        "at least {step_v:.3} V: the coarse ramp of {v_per_s} V/s rises so far between two refreshes"
    );
    Err(Fault::new(key, sd_v, expected))
}
