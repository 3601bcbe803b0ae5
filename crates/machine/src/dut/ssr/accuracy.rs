//! Uncertainty budgets, from the accuracies of the instruments and the terms of each method.

use super::edges::Crossing;
use super::plan::{CurrentRange, DcPlan, Plan};
use crate::gauge::Budget;
use crate::gauge::budget::rectangular;
use scpi::Accuracy;

/// Noise of the cold drop, divided by the noise of the drop of one period. A curve through the drops of all periods
/// gives the cold drop; the value holds for a junction with a time constant of one period.
pub const COLD: f64 = 2.6;
/// As [`COLD`], of the drift.
pub const WARMED: f64 = 1.1;
/// As [`COLD`], of the difference between the cold drops at full and at half current, whose errors by the curve are
/// alike.
const APART: f64 = 2.4;

/// Averaging time of the reading that shows whether a leakage has settled, periods of the mains.
const BRIEF: f64 = 0.1;

/// Growth of the leakage of a junction with its temperature: twice the current each ten kelvin.
const LEAKAGE_PER_K: f64 = 0.07;
/// Greatest thermal resistance between junction and case, K/W, of the small MOSFETs of a DC part.
const DC_K_PER_W: f64 = 15.0;
/// As [`DC_K_PER_W`], of the triac or the thyristors of an AC part.
pub const AC_K_PER_W: f64 = 3.0;

/// Returns the share by which a leakage may read too high because it heats its own junction, of `k_per_w` to the case;
/// `volts` and `ampere`: rms of the voltage at the output, and of the current in phase with it.
pub fn self_heating(k_per_w: f64, volts: f64, ampere: f64) -> f64 {
    LEAKAGE_PER_K * k_per_w * (volts * ampere).abs()
}

/// Returns the standard uncertainty of an applied or measured value, in its unit: gain and offset, without noise.
pub fn applied_u(accuracy: &Accuracy, value: f64) -> f64 {
    rectangular(accuracy.gain(value)).hypot(rectangular(accuracy.offset))
}

/// Returns the part of a difference of two readings, A, that noise does not explain. Only this part shows that the
/// current still settles.
fn beyond(moved: f64, noise_a: f64) -> f64 {
    (moved.abs() - 3.0 * noise_a).max(0.0)
}

/// Returns the budget of a current in multiples of `unit_a` amperes. `moved` is the difference of two successive
/// readings, A, which bounds what has yet to settle.
pub fn current(range: &CurrentRange, ampere: f64, moved: f64, unit_a: f64) -> Budget {
    let meter = &range.meter;
    let noise_a = meter.noise_over(range.periods);
    Budget::default()
        .with_bounds("gain", meter.gain(ampere) / unit_a)
        .with_bounds("offset", meter.offset / unit_a)
        .with_bounds("settling", beyond(moved, noise_a) / unit_a)
        .with_random("noise", noise_a / unit_a)
}

/// Returns the budget of a leakage, microamperes; the test subtracts the current of the open fixture when it is known.
/// The difference has the noise of both readings, and no offset.
pub fn leakage(
    range: &CurrentRange,
    (volts, ampere): (f64, f64),
    moved: f64,
    is_referenced: bool,
) -> Budget {
    let share = (range.source.gain(volts) + range.source.offset) / volts;
    let heated = self_heating(DC_K_PER_W, volts, ampere) * ampere / 1e-6;
    if !is_referenced {
        return current(range, ampere, moved, 1e-6)
            .with_bounds("source", share * ampere / 1e-6)
            .with_bounds("self-heating", heated);
    }
    let noise_a = range.meter.noise_over(range.periods);
    // The first of both readings is short and noisy.
    let moved = beyond(moved, range.meter.noise_over(BRIEF));
    Budget::default()
        .with_bounds("gain", range.meter.gain(ampere) / 1e-6)
        .with_bounds("source", share * ampere / 1e-6)
        .with_bounds("settling", moved / 1e-6)
        .with_bounds("self-heating", heated)
        .with("open fixture", noise_a / 1e-6)
        .with_random("noise", noise_a / 1e-6)
}

/// Returns the budget of a threshold of the control voltage, V, that lies in an interval `width_v` wide.
pub fn threshold(plan: &Plan, volts: f64, width_v: f64) -> Budget {
    Budget::default()
        .with_bounds("source gain", plan.input.source.gain(volts))
        .with_bounds("source offset", plan.input.source.offset)
        // In at most one search of four a step lies so close to the threshold.
        .with_bounds("dwell", plan.unseen_v() / 2.0)
        .with_random_bounds("step", width_v / 2.0)
}

/// Returns the budget of a threshold of the control voltage, V, found by a ramp with levels `step_v` apart. The output
/// is late by up to `lag_v`, of which the result allows for half.
pub fn ramp(plan: &Plan, volts: f64, step_v: f64, lag_v: f64) -> Budget {
    Budget::default()
        .with_bounds("source gain", plan.input.source.gain(volts))
        .with_bounds("source offset", plan.input.source.offset)
        .with_bounds("lag", lag_v / 2.0)
        // The record may show the level beside the one that switched.
        .with_random_bounds("step", step_v)
}

/// Returns the budget of a time, microseconds, between a control edge and a crossing of the output.
pub fn time(plan: &Plan, step_s: f64, control: &Crossing, output: &Crossing) -> Budget {
    let took_s = output.at_s - control.at_s;
    Budget::default()
        .with_bounds(
            "time base",
            (plan.time.gain(took_s) + plan.time.offset) * 1e6,
        )
        .with_random_bounds("sample before the edge", step_s / 2.0 * 1e6)
        .with_random_bounds("sample before the crossing", step_s / 2.0 * 1e6)
        .with_random("threshold level", output.u_s * 1e6)
        .with_random("control edge", control.u_s * 1e6)
}

/// Returns the budget of a resistance, milliohms, from the drops at half and at full current. The offsets of source and
/// meter are the same at both and cancel. `warmth_v` is the half width of the error that remaining heat makes in the
/// drop at half current, V.
pub fn resistance(plan: &DcPlan, ohm: f64, warmth_v: f64) -> Budget {
    let (source, meter) = (&plan.drop.source, &plan.drop.meter);
    let apart_a = plan.drop_a / 2.0;
    let noise_v = APART * meter.noise_over(1.0);
    Budget::default()
        .with_bounds("voltage gain", meter.gain(ohm) * 1e3)
        .with_bounds("current gain", source.gain(ohm) * 1e3)
        .with_bounds("heat", warmth_v / apart_a * 1e3)
        .with_random("noise", noise_v / apart_a * 1e3)
}

/// Returns the budget of a drop at the rated current, V, before that current has warmed the part, from the budget of
/// the resistance in milliohms.
pub fn drop_at_rated(plan: &DcPlan, resistance: &Budget) -> Budget {
    let mut budget = resistance.clone();
    for term in &mut budget.0 {
        term.u *= plan.rated_a / 1e3;
    }
    budget
}

/// Difference between the fitted warm-up of one time constant and that of a part, half width, as a share of the rise.
const WARM_UP: f64 = 0.03;

/// Returns the budget, mV, of a rise of the drop by heat; the offset of the meter cancels between the two readings.
pub fn drift(plan: &DcPlan, rise_v: f64) -> Budget {
    let meter = &plan.drop.meter;
    let noise_v = WARMED * meter.noise_over(1.0);
    Budget::default()
        .with_bounds("voltage gain", meter.gain(rise_v) * 1e3)
        .with_bounds("warm-up", WARM_UP * rise_v * 1e3)
        .with_random("noise", noise_v * 1e3)
}

/// Adds to the budget of a current of the LED its error by that of the applied voltage. The current is taken as that of
/// the voltage above the knee of the LED through its resistor.
pub fn applied(budget: Budget, range: &CurrentRange, volts: f64, value: f64) -> Budget {
    const KNEE_V: f64 = 1.2;
    const LEAST_V: f64 = 0.5;
    let share = value / (volts - KNEE_V).max(LEAST_V);
    budget
        .with_bounds("source gain", share * range.source.gain(volts))
        .with_bounds("source offset", share * range.source.offset)
}
