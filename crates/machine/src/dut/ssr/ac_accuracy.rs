//! Uncertainty budgets of AC parts, from the accuracies of digitizer, source and shunts and from the terms of each
//! method.

use super::ac_plan::{
    AcPlan, CLAMP_V, DIVIDER, LINE_OHM, LINE_SHUNT_OHM, LOOP_SHUNT_OHM, SHUNT_ERROR,
};
use super::accuracy::{AC_K_PER_W, COLD, WARMED, self_heating};
use super::measure::line::leakage::Leak;
use super::measure::line::looped::{Distorted, OnState};
use super::measure::line::references::REFERENCE_OHM;
use super::measure::line::train::Walk;
use super::plan::Plan;
use crate::gauge::Budget;
use std::f64::consts::{SQRT_2, TAU};

/// Error of the reference resistor and of the voltage that it divides, half width, as a share.
const REFERENCE: f64 = 0.001;
/// Delay between two channels that no reference has corrected, half width, s.
const DELAY_S: f64 = 5e-6;
/// Delay that remains after a reference has corrected it, half width, s: amplifiers of two scales differ by less.
const DELAY_LEFT_S: f64 = 0.2e-6;
/// Error of a gain that a reference has corrected at another scale, half width, as a share. Each of the two scales has
/// an error of its own of 0.1 % (half width); this half width has the uncertainty of both together.
const GAIN_LEFT: f64 = 0.001 * SQRT_2;
/// Difference between the fitted line voltage and the true curve (higher harmonics), half width, as a share of the
/// value.
const CURVE: f64 = 0.005;

/// Deviation of a channel from a straight line between its zero and its ends, half width, as a share of its range: a
/// step of a converter of 12 bits. No reference corrects it.
const LINEARITY: f64 = 2.5e-4;
/// Share of [`LINEARITY`] that the clamped channel keeps below the voltage of its reference: a smooth curve that is
/// right at 0 and at 0.7 of its end bends by 0.7³ as much between them.
const LEFT: f64 = 0.343;
/// Vertical divisions of the range of a channel.
const SCREEN: f64 = 8.0;
/// Smallest peak, as a share of the range, at which the deviation counts in full. Below it the channel is straight, so
/// the deviation falls with the peak.
const LEAST: f64 = 0.02;

/// Slow deviation of the mains from its amplitude, standard deviation, as a share.
const WANDERS: f64 = 0.01;
/// Time in which this deviation changes, s.
const WANDERS_S: f64 = 5.0;
/// Share of the capacitive current that seems to be in phase with the voltage within the record of a leakage, because
/// the mains deviates so; standard deviation.
const TURNS: f64 = 1.4e-4;

/// Part of a leakage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeakageOf {
    /// The whole, rms.
    Whole,
    /// The part in phase with the voltage.
    Resistive,
    /// The part a quarter of a period ahead of the voltage.
    Capacitive,
}

/// Returns the error of the gain of a channel, half width, as a share.
fn gain(ac: &AcPlan, is_referenced: bool) -> f64 {
    match is_referenced {
        true => GAIN_LEFT,
        false => ac.digitizer.reading_pct / 100.0,
    }
}

/// Returns the budget of a leakage or a part of it, microamperes. A delay between the channels makes some of the
/// capacitive part look resistive.
pub fn line_leakage(ac: &AcPlan, leak: &Leak, part: LeakageOf, value_a: f64) -> Budget {
    let (resistive_a, capacitive_a) = leak.split_a(ac);
    let (whole_a, ua) = (leak.rms_a(ac), 1e-6);
    let turned_a = |delay_s: f64| match part {
        LeakageOf::Resistive => TAU * ac.mains_hz * delay_s * capacitive_a,
        LeakageOf::Whole | LeakageOf::Capacitive => 0.0,
    };
    let heated_a = match part {
        LeakageOf::Resistive => resistive_a,
        // The share of the resistive part in the whole.
        LeakageOf::Whole => resistive_a * resistive_a / whole_a.max(f64::MIN_POSITIVE),
        LeakageOf::Capacitive => 0.0,
    };
    let heated_a = heated_a * self_heating(AC_K_PER_W, ac.mains_v, resistive_a);
    let scales = ac.leakage();
    let shown_v = SQRT_2 * whole_a * LINE_SHUNT_OHM;
    let budget = Budget::default()
        .with_bounds("linearity", bent(scales.shunt_v, shown_v) * value_a / ua)
        .with_bounds("self-heating", heated_a / ua)
        .with_random("noise", leak.noise_a / ua);
    let Some(doubt) = leak.referenced else {
        let gain = gain(ac, false);
        return budget
            .with_bounds("gain", gain * value_a / ua)
            .with_bounds("gain of the shunt", (gain + SHUNT_ERROR) * value_a / ua)
            .with_bounds("delay", turned_a(DELAY_S) / ua);
    };
    // The reference in the same line has shown the product of shunt and gains, at another scale of the shunt channel
    // and at another voltage of the divided one.
    let reference_a = ac.peak_v() / (LINE_OHM + REFERENCE_OHM);
    let reference = bent(ac.reference_shunt_v(), reference_a * LINE_SHUNT_OHM);
    let divided = bent(scales.divided_v, ac.peak_v() / DIVIDER);
    budget
        .with_bounds("gain", REFERENCE * value_a / ua)
        .with_bounds("gain of the shunt", GAIN_LEFT * value_a / ua)
        .with_bounds("linearity of the reference", reference * value_a / ua)
        .with_bounds("linearity of the voltage", divided * value_a / ua)
        .with_bounds("delay", turned_a(DELAY_LEFT_S) / ua)
        .with("noise of the reference", doubt.ratio * whole_a / ua)
        .with("noise of the fixture", doubt.stray_a / ua)
        .with_random("mains", turned_a(TURNS / TAU / ac.mains_hz) / ua)
}

/// Returns the error of the amplitude of a sine by the deviation of a channel from a straight line, half width, as a
/// share of the amplitude. `scale_v` is the scale in volts per division, `peak_v` the peak at the channel.
fn bent(scale_v: f64, peak_v: f64) -> f64 {
    LINEARITY * SCREEN * scale_v / peak_v.max(LEAST * SCREEN * scale_v)
}

/// Returns the budget of a time from the pulse train, microseconds: the mean of `count` instants, each known to within
/// one interval of the samples.
pub fn line_time(plan: &Plan, walk: &Walk, (took_us, count): (f64, usize)) -> Budget {
    let slope = walk
        .mains
        .slope(walk.answers.first().map_or(0.0, |it| it.zero_s));
    let zero_us = walk.mains.residual / 10.0 / slope.abs() * 1e6;
    Budget::default()
        .with_bounds("time base", base_us(plan, walk) + plan.time.gain(took_us))
        .with_random_bounds("sample interval", sampled(walk.step_s, count) * 1e6)
        .with_random("zero of the mains", zero_us)
}

/// Returns the budget of a time that counts from the trigger, microseconds. All edges share the interval of the samples
/// in which the trigger lies. The averaged pulses lie half of the train after the trigger on average.
pub fn from_trigger(plan: &Plan, walk: &Walk, (took_us, count): (f64, usize)) -> Budget {
    Budget::default()
        .with_bounds(
            "time base",
            base_us(plan, walk) / 2.0 + plan.time.gain(took_us),
        )
        .with_random_bounds("sample interval", sampled(walk.step_s, count) * 1e6)
        .with_random_bounds("trigger", walk.step_s / 2.0 * 1e6)
}

/// Returns the error of the time base over the whole train, half width, microseconds.
fn base_us(plan: &Plan, walk: &Walk) -> f64 {
    let ends_s = walk.answers.last().map_or(0.0, |it| it.pulse.end_s);
    (plan.time.gain(ends_s) + plan.time.offset) * 1e6
}

/// Returns the half width of the error of the mean of `count` jumps, each taken to lie in the middle between two
/// samples a `step` apart.
fn sampled(step: f64, count: usize) -> f64 {
    step / 2.0 / (count as f64).sqrt()
}

/// Returns the budget of a voltage at which a part turns on, V: the mean of `count` jumps between two samples that the
/// mains moves `step_v` apart.
pub fn turn_on_voltage(
    ac: &AcPlan,
    is_referenced: bool,
    step_v: f64,
    (value_v, count): (f64, usize),
) -> Budget {
    let range_v = if value_v < CLAMP_V {
        CLAMP_V
    } else {
        ac.peak_v()
    };
    let bits_v = 2.0 * range_v / 4096.0;
    Budget::default()
        .with_bounds("gain", gain(ac, is_referenced) * value_v)
        .with_bounds("linearity", LINEARITY * 2.0 * range_v)
        .with_bounds("curve", CURVE * value_v)
        .with_random_bounds("sample interval", sampled(step_v, count))
        .with_random_bounds("resolution", bits_v / 2.0)
}

/// Returns the budget of a drop at the rated current, V; `of_current_v` is the share of it that grows with the current,
/// V: its change for a relative change of the current.
///
/// The same source voltage shows the gain of the voltage and, through the ratio of the references, that of the current: an
/// error of it scales both alike and leaves the slope of the drop as it is.
pub fn line_drop(
    plan: &Plan,
    ac: &AcPlan,
    on: &OnState,
    (value_v, of_current_v): (f64, f64),
) -> Budget {
    let budget = Budget::default().with_random("noise", COLD * on.noise_v);
    if on.referenced.is_none() {
        let gain = gain(ac, false);
        return budget
            .with_bounds("gain", gain * value_v)
            // An offset has opposite signs in the two polarities, and their mean cancels it but for a twentieth.
            .with_bounds("offset", 0.05 * ac.offset_v(ac.drop_scale_v))
            .with_bounds("current gain", gain * of_current_v)
            .with_bounds("shunt of the loop", SHUNT_ERROR * of_current_v);
    }
    let (source, level_v) = (&plan.load.source, ac.reference_v());
    let of_source_v = (value_v - of_current_v) / level_v;
    let shunt_v = SQRT_2 * ac.rated_a * LOOP_SHUNT_OHM;
    let curve = bent(ac.looped().shunt_v, shunt_v);
    budget
        .with_bounds("gain of the source", source.gain(level_v) * of_source_v)
        .with_bounds("offset of the source", source.offset * of_source_v)
        .with_bounds("linearity", LINEARITY * SCREEN * ac.drop_scale_v * LEFT)
        .with_bounds("gain of the divider", GAIN_LEFT * of_current_v)
        .with_bounds("gain of the shunt", GAIN_LEFT * of_current_v)
        .with_bounds("linearity of the shunt", curve * of_current_v)
        .with_bounds("reference", REFERENCE * of_current_v)
        .with_bounds("shunt of the line", SHUNT_ERROR * of_current_v)
        .with_bounds("shunt of the loop", SHUNT_ERROR * of_current_v)
}

/// Returns the budget of the mean voltage of the conducting output (DC offset), mV. The curve of a channel is odd, as
/// that of a symmetrical input stage, and cancels between the polarities.
pub fn line_offset(ac: &AcPlan, on: &OnState) -> Budget {
    let budget = Budget::default().with_random("jumps", on.offset_v.1 * 1e3);
    match on.referenced {
        Some(doubt) => budget.with("zero", doubt.zero_v * 1e3),
        None => budget.with_bounds("offset", ac.offset_v(ac.drop_scale_v) * 1e3),
    }
}

/// Returns the budget of the difference of the half cycles, percent.
pub fn unequal(ac: &AcPlan, on: &OnState) -> Budget {
    let pct = |volts: f64| volts / LOOP_SHUNT_OHM / on.mean_a * 100.0;
    // Growth of the mains over the record, as a share. By it a half cycle exceeds the one before by `grows / (2 *
    // periods)`; the result, which compares the polarities with their sum, changes by half of that.
    let grows = WANDERS * (2.0 * on.periods / ac.mains_hz / WANDERS_S).sqrt();
    let budget = Budget::default()
        .with_random("jumps", on.unequal.1 * 100.0)
        .with_random("mains", grows / (4.0 * on.periods) * 100.0);
    match on.referenced {
        Some(doubt) => budget.with("zero", pct(doubt.shunt_zero_v)),
        None => budget.with_bounds("offset", pct(ac.offset_v(ac.looped().shunt_v))),
    }
}

/// Returns the budget of the rise of the drop by heat, mV. The offset is in both drops and cancels; the mains does not
/// matter, because both are drops at the rated current.
pub fn line_drift(ac: &AcPlan, on: &OnState) -> Budget {
    let gain_share = gain(ac, on.referenced.is_some());
    Budget::default()
        .with_bounds("gain", gain_share * on.drift_v * 1e3)
        .with_random("noise", WARMED * on.noise_v * 1e3)
}

/// Returns the budget of a distortion, mV: that of a drop of the same size, which does not depend on the current, and the
/// terms of the wait. The coarser channel shows its voltage, the samples its end, and the fitted source, with higher
/// harmonics that the fit does not know, its length.
pub fn distortion(plan: &Plan, ac: &AcPlan, on: &OnState) -> Budget {
    let Distorted {
        rms_v,
        fires_v,
        waits_v2,
        u_v2,
    } = on.distortion;
    let drop = line_drop(plan, ac, on, (rms_v, 0.0));
    let of_wait_v = waits_v2 / rms_v;
    let gain = gain(ac, on.referenced.is_some());
    let linearity = bent(ac.looped().divided_v, fires_v / DIVIDER);
    let budget = drop
        .with_bounds("gain of the wait", gain * of_wait_v)
        .with_bounds("linearity of the wait", linearity * of_wait_v)
        .with_bounds("curve", CURVE * of_wait_v / 2.0)
        .with_random("sample interval", u_v2 / (2.0 * rms_v));
    scaled(&budget, 1e3)
}

/// Returns a budget in another unit.
pub fn scaled(budget: &Budget, factor: f64) -> Budget {
    let mut scaled = budget.clone();
    for term in &mut scaled.0 {
        term.u *= factor;
    }
    scaled
}
