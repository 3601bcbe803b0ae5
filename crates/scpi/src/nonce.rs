//! Numbers that prove that a link is in step: 128 to 255, each different from the last 127.

/// The current number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Nonce {
    at: u8,
    step: u8,
}

impl Nonce {
    pub(crate) fn new(seed: u64) -> Self {
        let mixed = seed.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let [at, step, ..] = (mixed ^ (mixed >> 31)).to_be_bytes();
        Self { at, step: step | 1 }
    }

    /// Returns the number, 128 to 255.
    pub(crate) fn current(&self) -> u8 {
        self.at | 0x80
    }

    /// Advances to another number; because the step is odd, the sequence visits all numbers.
    pub(crate) fn advance(&mut self) {
        self.at = self.at.wrapping_add(self.step);
    }
}
