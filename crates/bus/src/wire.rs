//! Time that characters take on the wire.

use units::Span;

/// Bits of a character: one start, eight data, one stop.
const BITS: u64 = 10;

/// Speed of a line, which gives the time of characters on the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Wire {
    /// Bits per second; 0 counts as 1.
    pub baud: u32,
}

impl Wire {
    /// Returns the time that this many characters take, rounded up to a whole microsecond.
    pub fn time(self, characters: usize) -> Span {
        Span((characters as u64 * BITS * 1_000_000).div_ceil(u64::from(self.baud.max(1))))
    }
}
