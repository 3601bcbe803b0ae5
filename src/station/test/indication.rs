//! What the gate of a ramp says: the indicated voltage, and the threshold behind it.

use super::{Bench, Ramp};
use crate::gauge::budget::Reading;
use crate::gauge::calibration::Lag;
use crate::gauge::coil::to_reference;
use crate::gauge::strategy::{from_two_rates, growth_s};
use crate::gauge::threshold::{Direction, RampDoubt, quasi_static};
use crate::gauge::timing::counts;
use crate::gauge::{Parameter, Strategy};
use crate::station::act::Readings;
use crate::units::{Celsius, Second, Volt};

/// Length of gate 0 between the last two readings.
pub(super) fn gate0(bench: &Bench, readings: &Readings) -> Option<Second> {
    let [.., before, after] = readings.gates.as_slice() else {
        return None;
    };
    let gate = f64::from(counts(before[0].count, after[0].count)) / bench.clock().hz;
    Some(Second(
        gate - bench.calibration.gate_delay_us[0].value * 1e-6,
    ))
}

/// A coarse ramp whose lag golden parts and lot have taught.
pub(super) struct FastRamp {
    /// Indicated voltage.
    pub seen: Volt,
    /// Length of the gate.
    pub gate: Second,
    /// Lag of this direction.
    pub lag: Lag,
}

impl FastRamp {
    /// The threshold, with the scatter of the lag in its budget.
    pub(super) fn reading(&self, bench: &Bench, part: Celsius) -> Reading {
        let as_fine = self.seen - Volt(self.lag.coarse_v);
        let doubt = RampDoubt {
            slope: bench.calibration.coarse_v_per_s,
            slope_known: true,
            ..doubt(bench)
        };
        let reference = bench.reference_temperature();
        let mut reading = quasi_static(as_fine, self.gate, self.lag, part, reference, doubt);
        reading.budget = reading.budget.with_random("strategy", self.lag.coarse_u_v);
        reading
    }
}

/// Threshold from a fine ramp: less the lag of golden parts, or, by two rates, from both ramps.
pub(super) fn fine_reading(
    bench: &Bench,
    (ramps, gate): (Ramp, Second),
    part: Celsius,
    direction: Direction,
) -> Reading {
    let (lag, parameter) = match direction {
        Direction::Rising => (bench.operate_lag(), Parameter::OperateVoltage),
        Direction::Falling => (bench.release_lag(), Parameter::ReleaseVoltage),
    };
    let seen = ramps.fine.unwrap_or(Volt(f64::NAN));
    let reference = bench.reference_temperature();
    let mut reading = quasi_static(seen, gate, lag, part, reference, doubt(bench));
    if bench.strategy(parameter) == Strategy::TwoRates && ramps.coarse.0.is_finite() {
        let rates = [
            bench.calibration.coarse_v_per_s.value,
            bench.calibration.fine_v_per_s.value,
        ];
        let sign = direction.sign();
        // The growth time from the lags of both rates on golden parts; their common offset stays out of it.
        let lags = [lag.coarse_v + lag.fine_v.value, lag.fine_v.value];
        let growth = growth_s(lags.map(|it| it * sign), rates);
        let seen = [ramps.coarse.0, seen.0].map(|volts| volts * sign);
        let found = sign * from_two_rates(seen, rates, growth);
        let scatter = rates[1] / (rates[0] - rates[1]) * lag.coarse_u_v;
        reading.value = found * to_reference(part, reference);
        reading.budget = reading.budget.with_random("strategy", scatter);
    }
    reading
}

/// Doubts of a fine ramp beyond the golden parts' shift.
fn doubt(bench: &Bench) -> RampDoubt {
    RampDoubt {
        slope: bench.calibration.fine_v_per_s,
        slope_known: false,
        operation_v: bench.accuracy.operation_scatter_mv / 1e3,
        refresh: Second(bench.accuracy.ao_refresh_ms * 1e-3),
        level: bench.calibration.level.gain.u,
        temperature_k: bench.accuracy.part_minus_track_k,
    }
}
