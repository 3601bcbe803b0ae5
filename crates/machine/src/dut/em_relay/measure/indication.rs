//! Evaluation of the gate of a ramp: indicated voltage and threshold.

use super::search::parameter;
use super::{Context, Ramp};
use crate::dut::em_relay::Strategy;
use crate::dut::em_relay::calibration::Overshoot;
use crate::dut::em_relay::coil::to_reference;
use crate::dut::em_relay::overshoot::CoarseResults;
use crate::dut::em_relay::readings::Readings;
use crate::dut::em_relay::strategy::{from_two_rates, growth_s};
use crate::dut::em_relay::threshold::{Direction, RampUncertainty, quasi_static};
use crate::dut::em_relay::timing::counts;
use crate::gauge::budget::Reading;
use units::{Celsius, Second, Volt};

/// Returns the time for which gate 0 was open between the last two readings, less the delay of the gate; `None` with
/// fewer than two readings.
pub(super) fn gate0(context: &Context, readings: &Readings) -> Option<Second> {
    let [.., before, after] = readings.gates.as_slice() else {
        return None;
    };
    let gate = f64::from(counts(before[0].count, after[0].count)) / context.clock().hz;
    Some(Second(
        gate - context.calibration.gate_delay_us[0].value * 1e-6,
    ))
}

/// Returns the threshold from a coarse ramp by the overshoot model; `None` for a part unlike those that taught the
/// model.
///
/// The learned scatter already contains resolution, repeatability and slope error, so the budget has no terms for them.
pub(super) fn coarse_reading(
    context: &Context,
    (seen, overshoot): (CoarseResults, Overshoot),
    part: Celsius,
    direction: Direction,
) -> Option<Reading> {
    let predicted = overshoot.coarse.of(&seen);
    // The learned scatter includes the scatter of the operation on the fine ramp. This value comes from the coarse ramp
    // alone, so that scatter is subtracted.
    let operation_v = context.operation_v();
    let own_v = (predicted.u_v.powi(2) - operation_v.powi(2)).max(operation_v.powi(2));
    let uncertainty = RampUncertainty {
        slope_v_per_s: context.calibration.coarse_v_per_s,
        slope_known: true,
        operation_v: 0.0,
        refresh: Second(0.0),
        // The model learns from indications, which include the gain error.
        level_share: 0.0,
        ..uncertainty(context)
    };
    let reference = context.reference_temperature();
    let own = overshoot.own_v(predicted.volts, direction);
    let as_fine = seen.indicated - Volt(predicted.volts);
    let mut reading = quasi_static(
        (as_fine, own),
        Second(0.0),
        overshoot,
        part,
        reference,
        uncertainty,
    );
    reading.budget = reading.budget.with_random("strategy", own_v.sqrt());
    predicted.alike.then_some(reading)
}

/// Returns the threshold from a fine ramp and the overshoot of reference parts; under `two_rates` from both ramps, by
/// the law in `strategy.rs`.
pub(super) fn fine_reading(
    context: &Context,
    (ramps, gate): (Ramp, Second),
    part: Celsius,
    direction: Direction,
) -> Reading {
    let (overshoot, parameter) = (context.overshoot(direction), parameter(direction));
    let seen = ramps.fine.unwrap_or(Volt(f64::NAN));
    let reference = context.reference_temperature();
    let own = overshoot.own_v((ramps.coarse.indicated - seen).0, direction);
    let mut reading = quasi_static(
        (seen, own),
        gate,
        overshoot,
        part,
        reference,
        uncertainty(context),
    );
    if context.strategy(parameter) == Strategy::TwoRates && ramps.coarse.indicated.0.is_finite() {
        let rates = [
            context.calibration.coarse_v_per_s.value,
            context.calibration.fine_v_per_s.value,
        ];
        let sign = direction.sign();
        // The overshoots of reference parts at both rates give the growth time; their common offset cancels.
        let predicted = overshoot.coarse.of(&ramps.coarse);
        let fine_v = overshoot.fine_v.value + overshoot.own_v(predicted.volts, direction).value;
        let overshoots = [predicted.volts + fine_v, fine_v];
        let growth = growth_s(overshoots.map(|it| it * sign), rates);
        let seen = [ramps.coarse.indicated.0, seen.0].map(|volts| volts * sign);
        let found = sign * from_two_rates(seen, rates, growth);
        let scatter = rates[1] / (rates[0] - rates[1]) * predicted.u_v;
        reading.value = found * to_reference(part, reference);
        reading.budget = reading.budget.with_random("strategy", scatter);
    }
    reading
}

/// Returns the uncertainty terms of a fine ramp, except that of the overshoot found on reference parts.
fn uncertainty(context: &Context) -> RampUncertainty {
    RampUncertainty {
        slope_v_per_s: context.calibration.fine_v_per_s,
        slope_known: false,
        operation_v: context.operation_v(),
        refresh: Second(context.accuracy.ao_refresh_ms * 1e-3),
        level_share: context.calibration.level.gain.u,
        contact_share: context.contact_share(),
        temperature_k: context.part_k(),
    }
}
