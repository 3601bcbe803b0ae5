//! Probation: addresses whose replies the line confirms.
//!
//! Two modules at one address, a bad plug or a motor near the cable damage replies. Form and checksum reveal most of
//! the damage, but an eight-bit checksum misses one in 256. So visible damage serves as a warning: after a damaged
//! reply the address is on probation until [`PROBATION_ANSWERS`] whole answers in a row. During probation the line
//! reads twice and accepts equal answers. For noisy or moving quantities it reads a third time and accepts the middle
//! answer ([`dcon::Command::select_answer`]). It rejects readings that change faster; the request may retry them. Without
//! damage a line never reads twice.
//!
//! Residual risk: let a share c of an address's replies be damaged such that a share p of them passes, and a share d
//! of all its replies be visibly damaged. Then c p (1 - d)^100 readings are false and accepted before the probation
//! begins, and (c p)^2 within it. With every fault of the storm at 1 % that is less than one in ten million; `cargo
//! bench -p bus --bench line_storm` prints it. Two modules that always answer together have c = 1 and d close to 1, so
//! probation begins with the first reply.

use dcon::Address;

/// Whole answers in a row that end the probation. A disturbance of every twentieth reply stays invisible that long
/// with a probability of 0.95^100 = 0.6 %; a scan takes a second or two for them.
pub const PROBATION_ANSWERS: u8 = 100;

/// Whole answers still missing, by address.
#[derive(Debug)]
pub(super) struct Probation([u8; 256]);

impl Default for Probation {
    fn default() -> Self {
        Self([0; 256])
    }
}

impl Probation {
    /// Returns true when a read of this address needs confirmation.
    pub(super) fn applies_to(&self, Address(module): Address) -> bool {
        self.0[usize::from(module)] > 0
    }

    /// Starts the probation of an address after a damaged reply.
    pub(super) fn start(&mut self, Address(module): Address) {
        self.0[usize::from(module)] = PROBATION_ANSWERS;
    }

    /// Counts a whole answer towards the end of the probation.
    pub(super) fn count_whole(&mut self, Address(module): Address) {
        let left = &mut self.0[usize::from(module)];
        assert!(
            *left <= PROBATION_ANSWERS,
            "the probation exceeds its length"
        );
        *left = left.saturating_sub(1);
    }
}
