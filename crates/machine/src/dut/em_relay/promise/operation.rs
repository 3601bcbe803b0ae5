//! Scatter of a threshold from operation to operation.

use crate::dut::em_relay::Parameter;
use crate::dut::record::TestRecord;
use crate::gauge::Reading;
use crate::gauge::evidence::Residuals;
use units::Volt;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gauge::budget::Budget;
    use crate::rig::sample::Sample;
    use units::Unit;

    const SCATTER: Volt = Volt(0.002);

    #[test]
    fn repeated_ramps_scatter_about_their_mean() {
        let mut record = TestRecord::<()>::default();
        for volts in [7.88, 7.89, 7.90] {
            let budget = Budget::default().with("reference parts", 0.004);
            let budget = budget.with_random("repeatability", SCATTER.0);
            let reading = Reading {
                value: volts,
                unit: Unit::Volt,
                budget: budget.with_random("resolution", 0.0004),
            };
            record.found::<Sample>(Parameter::OperateVoltage, reading, []);
        }
        let all: Vec<Residuals> = of_repeats(&record, SCATTER).collect();
        assert_eq!(all.len(), 1);
        assert!((all[0].squares - 2e-4).abs() < 1e-9 && all[0].freedom == 2);
        assert!((all[0].others - 1.6e-7).abs() < 1e-12);
    }
}
