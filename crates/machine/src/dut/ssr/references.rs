//! Corrections of the channels of the digitizer, from the references of the fixture. The test of the first part of a
//! lot measures them first; the first part after [`VALID`] repeats this.

use super::wave::split::Admittance;
use units::{RigTime, Span};

/// Time for which the corrections are valid: an hour.
pub const VALID: Span = Span(3_600_000_000);

/// Errors of the channels, as the references show them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct References {
    /// Reading of the clamped channel at 0 V, with the scale of the drop, V.
    pub zero_v: f64,
    /// Reading of the shunt channel without current, with the scale of the loop, V.
    pub shunt_zero_v: f64,
    /// Gain of the clamped channel with the scale of the drop: reading over voltage.
    pub gain: f64,
    /// Gain of the divided channel: reading over voltage.
    pub divided_gain: f64,
    /// Ratio of a read admittance to the true one: gains of the divided and the shunt channel, and their delay.
    pub ratio: Admittance,
    /// Admittance of the fixture without a part.
    pub stray: Admittance,
    /// Noise of the values above.
    pub doubt: Doubt,
    /// Time of the measurement.
    pub at: RigTime,
}

/// Noise of the references: the same error in every part that they correct.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Doubt {
    /// Standard uncertainty of the ratio, as a share.
    pub ratio: f64,
    /// Standard uncertainty of the current of the fixture at the nominal voltage, A.
    pub stray_a: f64,
    /// Standard uncertainty of the zero of the clamped channel, V.
    pub zero_v: f64,
    /// Standard uncertainty of the zero of the shunt channel in the loop, V.
    pub shunt_zero_v: f64,
}

/// Currents through the fixture without a part at the rated voltage of a DC part, A: offset of the meter and
/// insulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpenFixture {
    /// With the polarity of the test.
    pub forward_a: f64,
    /// With reversed voltage.
    pub reversed_a: f64,
    /// Instant of the measurement.
    pub at: RigTime,
}

impl OpenFixture {
    /// Returns true while the currents are valid.
    pub fn holds(&self, now: RigTime) -> bool {
        now < self.at + VALID
    }
}

/// Corrections that the test of a lot has measured at its fixture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Fixture {
    /// Corrections for AC parts.
    pub references: Option<References>,
    /// Currents of the open fixture, for DC parts.
    pub open: Option<OpenFixture>,
}

impl References {
    /// Returns true while the corrections are valid.
    pub fn hold(&self, now: RigTime) -> bool {
        now < self.at + VALID
    }

    /// Returns the gain of the shunt channel: reading over the voltage of the shunt.
    pub fn shunt_gain(&self) -> f64 {
        self.ratio.size() * self.divided_gain
    }

    /// Returns the admittance of the part from a reading: corrects the ratio and subtracts the admittance of the
    /// fixture.
    pub fn corrected(&self, read: Admittance) -> Admittance {
        read.over(self.ratio).less(self.stray)
    }
}
