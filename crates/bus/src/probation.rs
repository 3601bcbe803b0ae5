//! Probation: for a while the line confirms every reply from an address that sent a damaged one.
//!
//! Two modules at one address, a bad plug, or a motor near the cable damage replies. Form and checksum reveal most of
//! the damage, but an eight-bit checksum misses one error in 256. So detected damage serves as a warning: after a
//! damaged reply the address is on probation until it has given [`PROBATION_ANSWERS`] whole answers in a row. During
//! probation the line reads twice and accepts equal answers. For a noisy or moving quantity it reads a third time and
//! accepts the answer in the middle ([`dcon::Command::select_answer`]). It rejects readings that change even faster;
//! the request may allow another try. Without damage a line never reads twice.
//!
//! Residual risk: let c be the share of an address's replies that are damaged, p the share of these that pass for a
//! reply, and d the share of all its replies with detected damage. Then a share c p (1 - d)^100 of the readings is
//! wrong and accepted before the probation begins, and a share of at most 3 (c p)^2 during it, when two of three
//! answers are damaged. With every fault of the storm at 1 %, that is less than one in ten million; `cargo bench -p bus
//! --bench line_storm` prints the numbers. Two modules that always answer together have c = 1 and d close to 1, so that
//! their probation begins with the first reply.

use dcon::Address;

/// Number of consecutive whole answers that ends the probation. A disturbance of every twentieth reply stays undetected
/// for that many replies with a probability of 0.95^100 = 0.6 %; a hundred replies take one or two seconds of a scan.
pub const PROBATION_ANSWERS: u8 = 100;

/// Number of whole answers that each address still needs to end its probation; 0 for an address not on probation.
#[derive(Debug)]
pub(super) struct Probation([u8; 256]);

impl Default for Probation {
    fn default() -> Self {
        Self([0; 256])
    }
}

impl Probation {
    /// Returns true when replies from this address need confirmation.
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
