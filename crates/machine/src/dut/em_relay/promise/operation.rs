//! Scatter of a threshold from operation to operation.

use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::measure::Ramp;
use crate::dut::em_relay::overshoot::OvershootModel;
use crate::dut::record::TestRecord;
use crate::gauge::Reading;
use crate::gauge::evidence::Residuals;
use units::Volt;

/// Parts that teach the overshoot model before its residuals count.
const TAUGHT: u32 = 8;
/// Standard deviation that a taught overshoot model leaves without any scatter of operations, of a 12 V coil.
pub const MODEL: Volt = Volt(0.003);

/// Returns the residuals of repeated fine ramps of one part; `scatter` is the promised scatter.
pub fn of_repeats<T>(record: &TestRecord<T>, scatter: Volt) -> impl Iterator<Item = Residuals> {
    let thresholds = [Parameter::OperateVoltage, Parameter::ReleaseVoltage];
    thresholds.into_iter().filter_map(move |parameter| {
        let readings: Vec<&Reading> = record.each(parameter).collect();
        let values: Vec<f64> = readings.iter().map(|it| it.value).collect();
        let terms = readings.first()?.budget.0.iter();
        let others = terms.filter(|it| it.random && it.source != "repeatability");
        let others = others.map(|it| it.u * it.u).sum();
        Residuals::about_mean(&values, scatter.0.powi(2), others)
    })
}

/// Returns the residual of the overshoot that `model` expects of a part: two operations scatter, a coarse and a fine one;
/// `rest` is what the model leaves without them.
pub fn of_overshoot(
    model: &OvershootModel,
    ramp: &Ramp,
    (scatter, rest): (Volt, Volt),
) -> Option<Residuals> {
    let expected = model.of(&ramp.coarse);
    let off_v = (ramp.coarse.indicated - ramp.fine?).0 - expected.volts;
    let usable = model.parts() >= TAUGHT && expected.alike;
    usable.then(|| Residuals {
        squares: off_v * off_v / (1.0 + expected.spread),
        freedom: 1,
        own: 2.0 * scatter.0.powi(2),
        others: rest.0.powi(2),
    })
}
