//! Scatter of a threshold from operation to operation.

use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::measure::Ramp;
use crate::dut::em_relay::overshoot::OvershootModel;
use crate::gauge::Reading;
use crate::gauge::evidence::Residuals;

/// Parts that teach the overshoot model before its residuals count.
const TAUGHT: u32 = 20;
/// Rest of a taught overshoot model without any scatter of operations, volts (1 sd): 2.9 mV, and a reserve for lots that
/// scatter more.
const MODEL_V: f64 = 0.0035;

/// Returns the residuals of repeated fine ramps of one part; `scatter_v` is the promised scatter.
pub fn of_repeats<T>(
    record: &crate::dut::record::TestRecord<T>,
    scatter_v: f64,
) -> impl Iterator<Item = Residuals> {
    let thresholds = [Parameter::OperateVoltage, Parameter::ReleaseVoltage];
    thresholds.into_iter().filter_map(move |parameter| {
        let readings: Vec<&Reading> = record.each(parameter).collect();
        let values: Vec<f64> = readings.iter().map(|it| it.value).collect();
        let terms = readings.first()?.budget.0.iter();
        let others = terms.filter(|it| it.random && it.source != "repeatability");
        let others = others.map(|it| it.u * it.u).sum();
        Residuals::about_mean(&values, scatter_v.powi(2), others)
    })
}

/// Returns the residual of the overshoot that `model` expects of a part: two operations scatter, a coarse and a fine one.
pub fn of_overshoot(model: &OvershootModel, ramp: &Ramp, scatter_v: f64) -> Option<Residuals> {
    let expected = model.of(&ramp.coarse);
    let rest_v = (ramp.coarse.indicated - ramp.fine?).0 - expected.volts;
    let usable = model.parts() >= TAUGHT && expected.alike;
    usable.then(|| Residuals {
        squares: rest_v * rest_v / (1.0 + expected.spread),
        freedom: 1,
        own: 2.0 * scatter_v.powi(2),
        others: MODEL_V.powi(2),
    })
}
