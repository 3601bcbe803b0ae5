//! Observes the promises on tested parts.

use super::{Promises, closure, operation};
use crate::dut::em_relay::measure::{Observed, Ramp};
use crate::dut::em_relay::overshoot::OvershootModel;
use crate::dut::em_relay::scale::Scale;
use crate::dut::promise::Promise;
use crate::dut::record::TestRecord;
use crate::gauge::evidence::Residuals;
use units::Volt;

impl Promises {
    /// Observes the scatter of operations by the repeated ramps of any part.
    pub fn watch_repeats<T>(&mut self, record: &TestRecord<T>, scale: Scale) {
        let residuals: Vec<Residuals> =
            operation::of_repeats(record, self.scatter(scale)).collect();
        self.observe(Promise::OperationScatter, residuals);
    }

    /// Observes the scatter of closures of a good part.
    pub fn watch_closures(&mut self, observed: &Observed) {
        let promised_pct = self.promised(Promise::ClosureScatter);
        let closures = closure::of_closures(&observed.nc_mohm, promised_pct);
        self.observe(Promise::ClosureScatter, closures);
    }

    /// Observes the scatter of operations by the residuals of a good part about the models of both overshoots, operate
    /// and release; does nothing where the ramp is too steep for the coil.
    pub fn watch_overshoots(
        &mut self,
        observed: &Observed,
        models: [&OvershootModel; 2],
        scale: Scale,
    ) {
        if scale.range() > operation::STEEPEST * scale.coil() {
            return;
        }
        let scatters = (self.scatter(scale), scale.of_coil(operation::REST));
        let ramps = [observed.operate, observed.release].into_iter();
        let of = |(ramp, model): (Option<Ramp>, &OvershootModel)| {
            operation::of_overshoot(model, &ramp?, scatters)
        };
        let residuals: Vec<Residuals> = ramps.zip(models).filter_map(of).collect();
        self.observe(Promise::OperationScatter, residuals);
    }

    /// Returns the promised scatter of operations of this coil.
    fn scatter(&self, scale: Scale) -> Volt {
        let of_12_v = self.promised(Promise::OperationScatter) / 1e3;
        scale.of_coil(Volt(of_12_v))
    }
}
