//! Type codes (TT): each means a measuring or output range and its scale.

use std::fmt;

/// Type code, the field TT of the configuration word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct TypeCode(pub u8);

/// Unit of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// Volt, V.
    Volt,
    /// Millivolt, mV.
    Millivolt,
    /// Milliampere, mA.
    Milliampere,
    /// Degrees Celsius.
    Celsius,
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Volt => "V",
            Self::Millivolt => "mV",
            Self::Milliampere => "mA",
            Self::Celsius => "°C",
        })
    }
}

/// Both ends of a range, in its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FullScale {
    /// Lower end.
    pub low: f64,
    /// Upper end: the value of 100 % and of 7FFF.
    pub high: f64,
    /// Unit of both ends.
    pub unit: Unit,
}

impl FullScale {
    const fn new(low: f64, high: f64, unit: Unit) -> Self {
        Self { low, high, unit }
    }

    const fn around_zero(high: f64, unit: Unit) -> Self {
        Self::new(-high, high, unit)
    }
}

impl TypeCode {
    /// Type code of digital modules.
    pub const DIGITAL: Self = Self(0x40);
    /// Type code of a 7080 as counter.
    pub const COUNTER: Self = Self(0x50);
    /// Type code of a 7080 as frequency meter.
    pub const FREQUENCY: Self = Self(0x51);
    /// Type code of a type J thermocouple; the reading of the cold junction has the same notation.
    pub(super) const COLD_JUNCTION: Self = Self(0x0E);

    /// Returns the range; `None` for codes that have none (digital, counter) and for unknown codes.
    pub fn full_scale(self) -> Option<FullScale> {
        use Unit::{Milliampere, Millivolt, Volt};
        Some(match self.0 {
            0x00 => FullScale::around_zero(15.0, Millivolt),
            0x01 => FullScale::around_zero(50.0, Millivolt),
            0x02 => FullScale::around_zero(100.0, Millivolt),
            0x03 | 0x0B => FullScale::around_zero(500.0, Millivolt),
            0x04 | 0x0A => FullScale::around_zero(1.0, Volt),
            0x05 => FullScale::around_zero(2.5, Volt),
            0x06 | 0x0D => FullScale::around_zero(20.0, Milliampere),
            0x07 | 0x31 => FullScale::new(4.0, 20.0, Milliampere),
            0x08 | 0x33 => FullScale::around_zero(10.0, Volt),
            0x09 | 0x35 => FullScale::around_zero(5.0, Volt),
            0x0C => FullScale::around_zero(150.0, Millivolt),
            0x1A | 0x30 => FullScale::new(0.0, 20.0, Milliampere),
            0x1B => FullScale::around_zero(150.0, Volt),
            0x1C => FullScale::around_zero(50.0, Volt),
            0x32 => FullScale::new(0.0, 10.0, Volt),
            0x34 => FullScale::new(0.0, 5.0, Volt),
            _ => return self.temperature(),
        })
    }

    /// Returns the range of a temperature sensor: thermocouples J K T E R S B N C L M L-DIN (codes 0E to 19), Pt100 (20
    /// to 23 with 0.00385/K, 24 to 27 with 0.003916/K; 2E and 80 of the 7015), and Pt1000 (2A). Other makers give 20 to
    /// 24 other ranges: a code counts only together with the model name.
    fn temperature(self) -> Option<FullScale> {
        let (low, high) = match self.0 {
            0x0E => (-210.0, 760.0),
            0x0F => (-270.0, 1372.0),
            0x10 => (-270.0, 400.0),
            0x11 => (-270.0, 1000.0),
            0x12 | 0x13 => (0.0, 1768.0),
            0x14 => (0.0, 1820.0),
            0x15 => (-270.0, 1300.0),
            0x16 => (0.0, 2320.0),
            0x17 => (-200.0, 800.0),
            0x18 => (-200.0, 100.0),
            0x19 => (-200.0, 900.0),
            0x20 | 0x24 => (-100.0, 100.0),
            0x21 | 0x25 => (0.0, 100.0),
            0x22 | 0x26 => (0.0, 200.0),
            0x23 | 0x27 => (0.0, 600.0),
            0x2A | 0x80 => (-200.0, 600.0),
            0x2E => (-200.0, 200.0),
            _ => return None,
        };
        Some(FullScale::new(low, high, Unit::Celsius))
    }

    /// Returns true for a temperature range that begins at 0 C: its hex notation uses 0000 to 7FFF only.
    pub(super) fn is_warm(self) -> bool {
        self.temperature().is_some_and(|scale| scale.low == 0.0)
    }

    /// Returns true when the hex notation of this input runs from 0000 at the lower end to FFFF at the upper end,
    /// instead of being two's complement.
    pub fn unipolar_input(self) -> bool {
        matches!(self.0, 0x07 | 0x1A)
    }
}

impl fmt::Display for TypeCode {
    /// Writes the code and its range: `08 (±10 V)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:02X}", self.0)?;
        match self.full_scale() {
            Some(FullScale { low, high, unit }) if low == -high => write!(f, " (±{high} {unit})"),
            Some(FullScale { low, high, unit }) => write!(f, " ({low}…{high} {unit})"),
            None => Ok(()),
        }
    }
}
