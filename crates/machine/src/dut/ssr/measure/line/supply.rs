//! Checks that the source has fed a circuit during a whole record.
//!
//! Source, load and output are in series, so the voltages of output and load add up to that of the source, whatever the
//! part does: an open part has the whole voltage, and a conducting one leaves it to the load. An open circuit (a blown
//! fuse, a contactor that falls off, a broken wire) leaves neither: the sum stays at 0, or at the voltage that the
//! capacitance of the output holds. So it is never taken for an open part.

use super::super::given::NotDelivered;
use crate::dut::Reason;
use crate::dut::ssr::Finding;
use crate::dut::ssr::ac_plan::{AcPlan, Circuit, DIVIDER, Scales};
use crate::dut::ssr::points::Device;
use crate::dut::ssr::wave::Channel;
use crate::dut::ssr::wave::mains::Mains;
use crate::dut::ssr::wave::turn::run_from;
use crate::instrument::query::Waveform;

/// Divisions from the middle of the screen at which a reading counts as over range.
pub const FULL: f64 = 3.9;
/// Time without voltage that no zero of a live source explains, as a share of half a period.
const SILENT: f64 = 0.25;
/// Time in which the source must reach either polarity, in half periods: one, and what it takes to pass [`LOW`] twice.
const ONE_SIGN: f64 = 1.4;
/// Voltage, as a share of the peak, that a live source exceeds except around its zeros.
const LOW: f64 = 0.1;
/// Difference of the sum from its sine, as a share of the amplitude, that neither errors of the channels nor a mains that
/// wanders explain; and the time for which it must last, as a share of half a period.
const OFF: f64 = 0.1;
const LASTS: f64 = 0.05;
/// Least amplitude of the source, as a share of the nominal one; the greatest is 2 minus this.
const NEAR: f64 = 0.8;
/// Samples of half a period that the comparison with the sine looks at.
const PER_HALF: f64 = 200.0;

/// How the source has fed a circuit during a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fed {
    /// With its nominal voltage, from begin to end.
    Whole,
    /// The circuit was open for a while, or without its source.
    Broken,
    /// With another voltage.
    Wrong,
}

/// Fails with the reason unless the source has fed the circuit during the whole record.
///
/// # Errors
/// Fails also when the two channels do not fit each other.
pub fn proven(ac: &AcPlan, scales: &Scales, record: [&Waveform; 2]) -> Result<(), Reason> {
    match fed(ac, scales, record).ok_or(NotDelivered(Device::Digitizer))? {
        Fed::Whole => Ok(()),
        Fed::Broken => Err(broken(scales.circuit).into()),
        Fed::Wrong => Err(Finding::WrongMains.into()),
    }
}

const fn broken(circuit: Circuit) -> Finding {
    match circuit {
        Circuit::Line => Finding::LineDead,
        Circuit::Loop => Finding::LoopDead,
    }
}

/// Returns how the source has fed the circuit, from the records of the divided channel and of the shunt; `None` when they
/// do not fit each other.
pub fn fed(ac: &AcPlan, scales: &Scales, [divided, shunt]: [&Waveform; 2]) -> Option<Fed> {
    let per_volt = scales.circuit.ohm() / scales.circuit.shunt_ohm();
    let sum = Sum {
        output: Channel::of(divided, DIVIDER, 0.0)?,
        load: Channel::of(shunt, per_volt, 0.0)?,
        full_v: FULL * scales.shunt_v * per_volt,
        peak_v: ac.circuit_peak_v(scales.circuit),
        half_s: ac.half_s(),
    };
    let fits = sum.output.is_beside(&sum.load) && !sum.output.is_empty();
    fits.then(|| sum.judged(ac.mains_hz))
}

/// Voltages of output and load.
struct Sum<'a> {
    output: Channel<'a>,
    load: Channel<'a>,
    /// Voltage of the load at which the range of its channel ends, V.
    full_v: f64,
    peak_v: f64,
    half_s: f64,
}

impl Sum<'_> {
    fn judged(&self, nominal_hz: f64) -> Fed {
        if self.is_silent() {
            return Fed::Broken;
        }
        let (count, stride) = (self.output.len(), self.stride());
        let shown = || (0..count).step_by(stride).filter(|it| !self.is_beyond(*it));
        // A current beyond the range of its channel flows only while the source drives it.
        if 2 * stride * shown().count() < count {
            return Fed::Whole;
        }
        let samples = shown().map(|it| (self.output.time(it), self.at(it)));
        let Some(sine) = Mains::fit(samples, nominal_hz) else {
            return Fed::Broken;
        };
        let is_off = |number: usize| {
            let it = number * stride;
            let off_v = self.at(it) - sine.at(self.output.time(it));
            !self.is_beyond(it) && off_v.abs() > OFF * sine.amplitude()
        };
        let lasts = (LASTS * PER_HALF).round() as usize;
        if run_from(is_off, (0, count / stride), lasts).is_some() {
            return Fed::Broken;
        }
        match (NEAR..2.0 - NEAR).contains(&(sine.amplitude() / self.peak_v)) {
            true => Fed::Whole,
            false => Fed::Wrong,
        }
    }

    fn stride(&self) -> usize {
        ((self.half_s / PER_HALF / self.output.step_s) as usize).max(1)
    }

    /// Returns the voltage of output and load together at a sample, V.
    fn at(&self, index: usize) -> f64 {
        self.output.at(index) + self.load.at(index)
    }

    /// Returns true when the current of a sample is beyond the range of its channel.
    fn is_beyond(&self, index: usize) -> bool {
        self.load.at(index).abs() >= self.full_v
    }

    /// Returns true when the source shows no voltage for longer than a zero lasts, or one polarity for longer than a half
    /// period. A dead source leaves a constant voltage at the capacitance of the output.
    fn is_silent(&self) -> bool {
        let least_v = LOW * self.peak_v;
        let seen_v = |it: usize| match self.is_beyond(it) {
            true => self.peak_v.copysign(self.load.at(it)),
            false => self.at(it),
        };
        let lasts = |is_so: &dyn Fn(f64) -> bool, halves: f64| {
            let count = (halves * self.half_s / self.output.step_s).ceil() as usize;
            run_from(|it| is_so(seen_v(it)), (0, self.output.len()), count).is_some()
        };
        lasts(&|it| it.abs() < least_v, SILENT)
            || lasts(&|it| it < least_v, ONE_SIGN)
            || lasts(&|it| it > -least_v, ONE_SIGN)
    }
}
