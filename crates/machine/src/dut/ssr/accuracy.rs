//! Uncertainty budgets, from the accuracies of the instruments and the terms of each method.

use super::edges::Crossing;
use super::plan::{CurrentRange, Plan};
use crate::gauge::Budget;
use crate::gauge::budget::{rectangular, resolution};
use scpi::Accuracy;

/// Readings of the drop over time that make its last value: the two around 200 ms.
pub const LAST_DROPS: usize = 2;

/// Returns the standard uncertainty of an applied or measured value: gain and offset, without noise.
pub fn applied_u(accuracy: &Accuracy, value: f64) -> f64 {
    rectangular(accuracy.gain(value)).hypot(rectangular(accuracy.offset))
}

/// Returns the budget of a current in multiples of `unit_a` amperes. `moved` is the difference of two readings one after
/// the other, A, which shows how far the current has settled.
pub fn current(range: &CurrentRange, ampere: f64, moved: f64, unit_a: f64) -> Budget {
    let meter = &range.meter;
    Budget::default()
        .with("gain", rectangular(meter.gain(ampere)) / unit_a)
        .with("offset", rectangular(meter.offset) / unit_a)
        .with("settling", rectangular(moved) / unit_a)
        .with_random("noise", meter.noise_over(range.periods) / unit_a)
}

/// Returns the budget of a threshold of the control voltage, V, that lies in an interval `width_v` wide.
pub fn threshold(plan: &Plan, volts: f64, width_v: f64) -> Budget {
    Budget::default()
        .with("source", applied_u(&plan.input.source, volts))
        .with("dwell", rectangular(plan.unseen_v()))
        .with_random("step", resolution(width_v))
}

/// Returns the budget of a time, microseconds, between a control edge and a crossing of the output.
pub fn time(plan: &Plan, step_s: f64, control: &Crossing, output: &Crossing) -> Budget {
    let took_s = output.at_s - control.at_s;
    Budget::default()
        .with(
            "time base",
            rectangular(plan.time.gain(took_s) + plan.time.offset) * 1e6,
        )
        .with_random("sample interval", step_s / 6f64.sqrt() * 1e6)
        .with_random("threshold level", output.u_s * 1e6)
        .with_random("control edge", control.u_s * 1e6)
}

/// Returns the budget of a resistance, milliohms, from the drops at half and at full current. The offsets of source and
/// meter are the same at both and cancel. `heated_v` is the rise of the drop by heat during the measurement, V.
pub fn resistance(plan: &Plan, ohm: f64, heated_v: f64) -> Budget {
    let (source, meter) = (&plan.drop.source, &plan.drop.meter);
    let apart_a = plan.drop_a / 2.0;
    let noise_v = 2f64.sqrt() * meter.noise_over(1.0);
    Budget::default()
        .with("voltage gain", rectangular(meter.gain(ohm)) * 1e3)
        .with("current gain", rectangular(source.gain(ohm)) * 1e3)
        .with("heat", rectangular(heated_v / apart_a) * 1e3)
        .with_random("noise", noise_v / apart_a * 1e3)
}

/// Returns the budget of a drop at the rated current, V, from that of the resistance in milliohms. The rated current heats
/// the output with the square of its ratio to the larger measuring current, which raised the drop by `rise_v`.
pub fn drop_at_rated(plan: &Plan, resistance: &Budget, rise_v: f64) -> Budget {
    let mut budget = resistance.clone();
    for term in &mut budget.0 {
        term.u *= plan.rated_a / 1e3;
    }
    let ratio = plan.rated_a / plan.drop_a;
    let hotter_v = rise_v.max(0.0) * ratio * (ratio * ratio - 1.0);
    budget.with("heat at rated current", rectangular(hotter_v))
}

/// Returns the budget of a rise of the drop, mV. Offsets cancel.
pub fn drift(plan: &Plan, rise_v: f64) -> Budget {
    let meter = &plan.drop.meter;
    let noise_v = meter
        .noise_over(1.0)
        .hypot(meter.noise_over(LAST_DROPS as f64));
    Budget::default()
        .with("voltage gain", rectangular(meter.gain(rise_v)) * 1e3)
        .with_random("noise", noise_v * 1e3)
}

/// Adds to the budget of a current of the LED what the error of the applied voltage makes of it. Above its knee the LED
/// in series with its resistor takes a current that rises at most `STEEP` times as fast as in proportion.
pub fn applied(budget: Budget, range: &CurrentRange, volts: f64, value: f64) -> Budget {
    const STEEP: f64 = 2.0;
    budget.with(
        "source",
        STEEP * value * applied_u(&range.source, volts) / volts,
    )
}
