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
pub const REST: Volt = Volt(0.003);
/// Greatest ratio of the factors of range and coil at which [`REST`] holds. For 3, 5, 9 and 18 V coils the ramp is 1.2
/// to 2 times as steep, and the model leaves half as much again.
pub const STEEPEST: f64 = 1.1;
/// Largest residual that counts, in promised standard deviations: a rare part far off the model does not show how
/// operations scatter.
const OUTLIER: f64 = 3.5;

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

/// Returns the residual of a part's overshoot about `model`. It contains the scatter of two operations, a coarse and a
/// fine one, and `rest`, the error of the model.
pub fn of_overshoot(
    model: &OvershootModel,
    ramp: &Ramp,
    (scatter, rest): (Volt, Volt),
) -> Option<Residuals> {
    let expected = model.of(&ramp.coarse);
    let off_v = (ramp.coarse.indicated - ramp.fine?).0 - expected.volts;
    let usable = model.parts() >= TAUGHT && expected.alike;
    let (own, others) = (2.0 * scatter.0.powi(2), rest.0.powi(2));
    let squares = off_v * off_v / (1.0 + expected.spread);
    usable.then(|| Residuals {
        squares: squares.min(OUTLIER.powi(2) * (own + others)),
        freedom: 1,
        own,
        others,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dut::em_relay::overshoot::CoarseResults;
    use crate::gauge::budget::Budget;
    use crate::rig::sample::Sample;
    use units::Unit;

    const SCATTER: Volt = Volt(0.002);

    /// Ramps of a part whose results vary with `at`, with `off_v` more overshoot than its results explain.
    fn ramp(at: u32, off_v: f64) -> Ramp {
        let turn = |by: f64| 1.0 + 0.05 * ((f64::from(at) * by).fract() - 0.5);
        let fine = Volt(7.88 * turn(0.271));
        let indicated = fine + Volt(0.85 + off_v);
        let coarse = CoarseResults {
            indicated,
            operate: indicated,
            operate_ms: 4.7 * turn(0.618),
            release_ms: 2.9 * turn(0.382),
            coil_ohm: 400.0 * turn(0.724),
        };
        let fine = Some(fine);
        Ramp { coarse, fine }
    }

    fn taught(parts: u32) -> OvershootModel {
        let mut model = OvershootModel::guess(0.85, 1.0);
        for at in 0..parts {
            let ramp = ramp(at, 0.0);
            ramp.fine
                .into_iter()
                .for_each(|fine| model.learn(&ramp.coarse, fine));
        }
        model
    }

    fn residual(parts: u32, off_v: f64) -> Option<Residuals> {
        of_overshoot(&taught(parts), &ramp(parts, off_v), (SCATTER, REST))
    }

    #[test]
    fn an_untaught_model_gives_no_residual() {
        assert_eq!(residual(TAUGHT - 1, 0.0), None);
    }

    #[test]
    fn a_residual_holds_two_operations() {
        let it = residual(40, 0.010).expect("a taught model");
        assert!((it.squares.sqrt() - 0.010).abs() < 0.002, "{it:?}");
        assert_eq!((it.own, it.others), (2.0 * 4e-6, 9e-6));
    }

    #[test]
    fn a_part_off_the_model_counts_as_outlier() {
        let it = residual(40, 0.080).expect("a taught model");
        assert!((it.squares / (it.own + it.others) - OUTLIER.powi(2)).abs() < 1e-9);
    }

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
