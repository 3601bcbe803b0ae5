//! The configuration word `TT CC FF`, which every module keeps in its EEPROM, and the name of a module.
//!
//! A host should compare the reply to `$AA2` with the wanted configuration and write only when they differ, because
//! each write wears the EEPROM.

use super::{TypeCode, Unit, UpTo};
use std::fmt;

/// Type, baud and format of a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Config {
    /// Field TT: range of an analog module; type of any other module.
    pub type_code: TypeCode,
    /// Field CC: baud rate.
    pub baud: BaudCode,
    /// Field FF: notation, checksum and more, by family.
    pub format: FormatByte,
}

/// Field CC: bits 5..0 give the baud rate; newer firmware has parity and stop bits in bits 7..6.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BaudCode(pub u8);

impl BaudCode {
    const RATES: [(u8, u32); 8] = [
        (0x03, 1_200),
        (0x04, 2_400),
        (0x05, 4_800),
        (0x06, 9_600),
        (0x07, 19_200),
        (0x08, 38_400),
        (0x09, 57_600),
        (0x0A, 115_200),
    ];

    /// Returns the code of a baud rate with 8 data bits, no parity and 1 stop bit; `None` for a rate that no module
    /// has.
    pub fn of(baud: u32) -> Option<Self> {
        Self::RATES
            .iter()
            .find(|(_, rate)| *rate == baud)
            .map(|(code, _)| Self(*code))
    }

    /// Returns the baud rate, bit/s; `None` for an unknown code.
    pub fn rate(self) -> Option<u32> {
        Self::RATES
            .iter()
            .find(|(code, _)| *code == self.0 & 0x3F)
            .map(|(_, rate)| *rate)
    }
}

/// Notation of analog values (bits 1..0 of FF).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum DataFormat {
    /// In the unit of the range: `+05.123`.
    Engineering,
    /// In percent of full scale: `+051.23`.
    Percent,
    /// As two's complement in hex: `4193`.
    Hex,
}

/// Field FF. Its bits have a different meaning in each family.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FormatByte(pub u8);

impl FormatByte {
    /// Returns true when frames carry a checksum (bit 6). A change takes effect after a power cycle.
    pub fn checksum(self) -> bool {
        self.0 & 0x40 != 0
    }

    /// Returns the notation of an analog module; `None` for the code that no module has.
    pub fn data_format(self) -> Option<DataFormat> {
        match self.0 & 0x03 {
            0 => Some(DataFormat::Engineering),
            1 => Some(DataFormat::Percent),
            2 => Some(DataFormat::Hex),
            _ => None,
        }
    }

    /// Returns true in fast mode (bit 5): an analog input converts faster, at a lower resolution.
    pub fn fast(self) -> bool {
        self.0 & 0x20 != 0
    }

    /// Returns true when the filter of an analog input rejects 50 Hz instead of 60 Hz (bit 7).
    pub fn rejects_50_hz(self) -> bool {
        self.0 & 0x80 != 0
    }

    /// Returns the slew rate of an analog output (bits 5..2).
    pub fn slew(self) -> SlewCode {
        SlewCode(UpTo::new(self.0 >> 2 & 0x0F).unwrap_or(SlewCode::IMMEDIATE.0))
    }

    /// Returns true when the gate time of a frequency measurement is 1.0 s instead of 0.1 s (bit 2).
    pub fn long_gate(self) -> bool {
        self.0 & 0x04 != 0
    }
}

/// Code of the slew rate of an analog output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SlewCode(pub UpTo<15>);

impl SlewCode {
    /// Code for no slew limit: the output steps at once.
    pub const IMMEDIATE: Self = match UpTo::new(0) {
        Some(zero) => Self(zero),
        None => unreachable!(),
    };

    /// Returns the slew rate in V/s; `None` when the output steps at once. Code 1 is 1/16 V/s, and each further code
    /// doubles it. For current outputs, the rate in mA/s is twice this number.
    pub fn volt_per_second(self) -> Option<f64> {
        match self.0.get() {
            0 => None,
            code => Some(0.0625 * f64::from(1u32 << (code - 1))),
        }
    }

    /// Returns the slew rate of an output of this range with its unit; `None` when the output steps at once.
    pub(super) fn in_units(self, range: TypeCode) -> Option<String> {
        let rate = self.volt_per_second()?;
        let unit = range.full_scale().map(|scale| scale.unit);
        Some(match unit {
            Some(Unit::Milliampere) => format!("{} mA/s", 2.0 * rate),
            Some(Unit::Volt | Unit::Millivolt | Unit::Celsius) | None => format!("{rate} V/s"),
        })
    }
}

/// Name of a module: one to six printable characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModuleName {
    bytes: [u8; 6],
    length: u8,
}

impl ModuleName {
    /// Creates a name; returns `None` when it is empty, longer than six characters, or has characters that cannot be
    /// sent.
    pub fn new(name: &str) -> Option<Self> {
        let fits =
            (1..=6).contains(&name.len()) && name.bytes().all(|byte| byte.is_ascii_graphic());
        let mut bytes = [0; 6];
        fits.then(|| {
            bytes[..name.len()].copy_from_slice(name.as_bytes());
            Self {
                bytes,
                length: name.len() as u8,
            }
        })
    }

    pub(super) fn as_bytes(&self) -> &[u8] {
        &self.bytes[..usize::from(self.length)]
    }
}

impl fmt::Display for ModuleName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(std::str::from_utf8(self.as_bytes()).unwrap_or_default())
    }
}
