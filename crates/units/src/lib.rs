//! Physical units as types, so that a voltage is never compared with a limit in ohms.
//!
//! Arithmetic stays within one unit; the only mixed operation is Ohm's law, [`Volt::over`]. Rig time, real or
//! simulated, is in whole microseconds: [`RigTime`] is an instant, [`Span`] a duration.
//!
//! ```
//! use units::{Ampere, Ohm, RigTime, Span, Volt};
//! assert_eq!(Volt(6.0).over(Ampere(0.015)), Ohm(400.0));
//! assert_eq!((RigTime(1_500) + Span::ms(2)).since(RigTime(500)), Span(3_000));
//! ```

use serde::{Deserialize, Serialize, Serializer};
use std::fmt;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $symbol:literal) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default, Serialize, Deserialize)]
        #[serde(transparent)]
        pub struct $name(pub f64);

        impl $name {
            /// Returns the value without its sign.
            pub fn abs(self) -> Self {
                Self(self.0.abs())
            }
            /// Returns true when the value is neither NaN nor infinite; a verdict needs such a value.
            pub fn is_finite(self) -> bool {
                self.0.is_finite()
            }
        }
        impl Add for $name {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }
        impl Sub for $name {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }
        impl Neg for $name {
            type Output = Self;
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }
        impl Mul<f64> for $name {
            type Output = Self;
            fn mul(self, factor: f64) -> Self {
                Self(self.0 * factor)
            }
        }
        impl Div<f64> for $name {
            type Output = Self;
            fn div(self, divisor: f64) -> Self {
                Self(self.0 / divisor)
            }
        }
        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                fmt::Display::fmt(&self.0, f)?;
                f.write_str(concat!(" ", $symbol))
            }
        }
    };
}

quantity!(/** Electric potential. */ Volt, "V");
quantity!(/** Electric current. */ Ampere, "A");
quantity!(/** Resistance. */ Ohm, "ohm");
quantity!(/** Time as a measured quantity (an operate time), not an instant of the rig. */ Second, "s");
quantity!(/** Temperature on the Celsius scale. */ Celsius, "C");
quantity!(/** Length. */ Millimetre, "mm");

/// Unit of a number whose type does not state it, such as a reading, a limit or a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unit {
    /// A pure number, without unit.
    One,
    /// A share, percent.
    Percent,
    /// Resistance, ohm.
    Ohm,
    /// Resistance of contacts, milliohm.
    Milliohm,
    /// Voltage, volt.
    Volt,
    /// Small voltage, millivolt.
    Millivolt,
    /// Current, milliampere.
    Milliampere,
    /// Small current, microampere.
    Microampere,
    /// Time, millisecond.
    Millisecond,
    /// Delay of a gate, microsecond.
    Microsecond,
    /// Slope of a ramp, volt per second.
    VoltPerSecond,
    /// Rise of a blocked voltage, volt per microsecond.
    VoltPerMicrosecond,
    /// Inverse of a measuring current, milliohm per volt.
    MilliohmPerVolt,
    /// Temperature, degree Celsius.
    Celsius,
    /// Difference of temperatures, kelvin.
    Kelvin,
}

impl Unit {
    /// Returns the symbol in files, rows and JSON: ASCII only.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::One => "1",
            Self::Percent => "%",
            Self::Ohm => "ohm",
            Self::Milliohm => "mOhm",
            Self::Volt => "V",
            Self::Millivolt => "mV",
            Self::Milliampere => "mA",
            Self::Microampere => "uA",
            Self::Millisecond => "ms",
            Self::Microsecond => "us",
            Self::VoltPerSecond => "V/s",
            Self::VoltPerMicrosecond => "V/us",
            Self::MilliohmPerVolt => "mohm/V",
            Self::Celsius => "C",
            Self::Kelvin => "K",
        }
    }

    /// Returns the symbol on paper and pages.
    pub const fn sign(self) -> &'static str {
        match self {
            Self::Ohm => "Ω",
            Self::Milliohm => "mΩ",
            Self::Microampere => "µA",
            Self::Microsecond => "µs",
            Self::VoltPerMicrosecond => "V/µs",
            Self::MilliohmPerVolt => "mΩ/V",
            Self::Celsius => "°C",
            Self::One
            | Self::Percent
            | Self::Volt
            | Self::Millivolt
            | Self::Milliampere
            | Self::Millisecond
            | Self::VoltPerSecond
            | Self::Kelvin => self.symbol(),
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.symbol())
    }
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.symbol())
    }
}

impl Volt {
    /// Returns the resistance across which `current` drops this voltage (Ohm's law).
    pub fn over(self, current: Ampere) -> Ohm {
        Ohm(self.0 / current.0)
    }
}

/// An instant of rig time: microseconds since the rig's clock was created.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct RigTime(pub u64);

/// A duration of rig time, microseconds.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Span(pub u64);

impl Span {
    /// Converts whole milliseconds.
    pub const fn ms(ms: u64) -> Self {
        Self(ms * 1000)
    }
    /// Converts seconds, rounded to the microsecond. Negative values and NaN become zero; a value that is too large
    /// becomes the greatest span.
    pub fn seconds(seconds: f64) -> Self {
        Self((seconds * 1e6).round().max(0.0) as u64)
    }
    /// Converts to seconds.
    pub fn as_seconds(self) -> f64 {
        self.0 as f64 / 1e6
    }
}

impl RigTime {
    /// Returns the time since `earlier`; zero when `earlier` is later than this instant.
    pub fn since(self, earlier: RigTime) -> Span {
        Span(self.0.saturating_sub(earlier.0))
    }
}

impl Add<Span> for RigTime {
    type Output = RigTime;
    fn add(self, span: Span) -> RigTime {
        RigTime(self.0 + span.0)
    }
}

impl Add for Span {
    type Output = Span;
    fn add(self, other: Span) -> Span {
        Span(self.0 + other.0)
    }
}

impl AddAssign for Span {
    fn add_assign(&mut self, other: Span) {
        self.0 += other.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ohms_law_is_the_only_mixed_operation() {
        assert_eq!(Volt(5.0).over(Ampere(0.0125)), Ohm(400.0));
    }

    #[test]
    fn a_unit_has_an_ascii_and_a_printed_symbol() {
        assert_eq!(serde_json::json!(Unit::Milliohm), "mOhm");
        assert_eq!(Unit::Milliohm.sign(), "mΩ");
        assert_eq!(format!("[{:>3}]", Unit::Volt), "[  V]");
    }

    #[test]
    fn a_span_is_never_negative() {
        assert_eq!(RigTime(5).since(RigTime(9)), Span(0));
        assert_eq!(Span::seconds(f64::NAN), Span(0));
        assert_eq!(Span::seconds(0.0000014), Span(1));
    }
}
