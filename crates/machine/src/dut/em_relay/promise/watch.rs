//! Compares the promises with the results of tested parts.

use super::{Promises, closure, operation};
use crate::dut::em_relay::measure::Observed;
use crate::dut::em_relay::scale::Scale;
use crate::dut::promise::Promise;
use crate::dut::record::TestRecord;
use crate::gauge::evidence::Residuals;
use units::Volt;

impl Promises {
    /// Adds the scatter of repeated ramps, of any part, to the evidence on the scatter of operations.
    pub fn watch_repeats<T>(&mut self, record: &TestRecord<T>, scale: Scale) {
        let residuals: Vec<Residuals> =
            operation::of_repeats(record, self.scatter(scale)).collect();
        self.observe(Promise::OperationScatter, residuals);
    }

    /// Adds the closures of a good part to the evidence on the scatter of closures.
    pub fn watch_closures(&mut self, observed: &Observed) {
        let promised_pct = self.promised(Promise::ClosureScatter);
        let closures = closure::of_closures(&observed.nc_mohm, promised_pct);
        self.observe(Promise::ClosureScatter, closures);
    }

    /// Returns the promised scatter of operations of this coil.
    fn scatter(&self, scale: Scale) -> Volt {
        let of_12_v = self.promised(Promise::OperationScatter) / 1e3;
        scale.of_coil(Volt(of_12_v))
    }
}
