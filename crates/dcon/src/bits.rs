//! Bits of digital modules, as a host reads and writes them.

use super::request::Request;

/// Two bytes as a digital module sends them; their meaning depends on the module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bits {
    /// On a module with outputs and inputs, the outputs; on one with more than eight channels of one kind, channels 8
    /// to 15; otherwise all channels, such as the inputs of a 7052.
    pub first: u8,
    /// On a module with outputs and inputs, the inputs; on one with more than eight channels of one kind, channels 0 to
    /// 7; otherwise 0.
    pub second: u8,
}

impl Bits {
    /// Returns both bytes as one word, bit n = channel n. This suits modules with only inputs or only outputs, more
    /// than eight of them: 7041, 7043, 7045, 7051.
    pub fn word(self) -> u16 {
        u16::from(self.first) << 8 | u16::from(self.second)
    }
}

/// Number of hex digits of the data in `@AA(data)`; each model accepts exactly one width.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Width {
    /// 7060, 7063: up to four outputs, one digit.
    One,
    /// 7050, 7065, 7067: up to eight outputs, two digits.
    Two,
    /// 7043, 7045: sixteen outputs, four digits.
    Four,
}

impl Width {
    const fn digits(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Two => 2,
            Self::Four => 4,
        }
    }
}

/// All outputs of a module at once: bit n = output n.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OutputWord {
    width: Width,
    bits: u16,
}

impl OutputWord {
    /// Creates a word; returns `None` when a bit lies beyond the width.
    pub const fn new(width: Width, bits: u16) -> Option<Self> {
        if (bits as u32) >> (4 * width.digits()) == 0 {
            Some(Self { width, bits })
        } else {
            None
        }
    }

    /// Creates a word for the 16 outputs of a 7043 or 7045, for which every word is valid.
    pub const fn sixteen(bits: u16) -> Self {
        Self {
            width: Width::Four,
            bits,
        }
    }

    /// Returns the bits; bit n = output n.
    pub const fn bits(self) -> u16 {
        self.bits
    }

    pub(super) fn encode(self, request: &mut Request<'_>) {
        request.hex(u32::from(self.bits), self.width.digits());
    }
}
