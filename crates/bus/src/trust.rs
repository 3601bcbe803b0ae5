//! Which modules are believed at their first word.
//!
//! Two modules at one address, a bad plug, a motor beside the cable: most of what they make of a reply is told from a
//! reply by its form and its checksum, and now and then one passes, for a checksum of eight bits catches 255 in 256.
//! So the damage that is seen gives the rest away. An address whose reply was damaged is on probation until [`PROBATION`]
//! answers in a row were whole: it is asked again, and believed when it says the same. What is noisy or moves is asked a third
//! time, and the answer between the others is believed ([`dcon::Command::believed`]). What changes faster is not
//! believed, and may be tried again as often as the request allows. A line in order pays nothing.
//!
//! What is left: a share c of the replies of an address damaged such that a share p of them passes, and a share d of
//! all damaged visibly, gives c p (1 - d)^100 readings falsely believed before the probation begins, and (c p)^2 within it.
//! With every fault of the storm at 1 % that is less than one in ten million; `cargo bench --bench line_storm` prints it. For
//! two modules that always answer together c is 1 and d nearly: it ends with the first reply.

use dcon::Address;

/// Whole answers in a row that end the probation: enough that a disturbance of every twentieth reply is hardly ever
/// out of sight (0.95^100 = 0.6 %), and over in a second or two at the pace of a scan.
pub const PROBATION: u8 = 100;

/// Answers that every address still owes.
#[derive(Debug)]
pub(super) struct Trust([u8; 256]);

impl Default for Trust {
    fn default() -> Self {
        Self([0; 256])
    }
}

impl Trust {
    /// Whether an answer of this address must be heard twice.
    pub(super) fn on_probation(&self, Address(module): Address) -> bool {
        self.0[usize::from(module)] > 0
    }

    /// What was heard was no reply.
    pub(super) fn damaged(&mut self, Address(module): Address) {
        self.0[usize::from(module)] = PROBATION;
    }

    /// A reply was whole, and confirmed if it had to be.
    pub(super) fn whole(&mut self, Address(module): Address) {
        let left = &mut self.0[usize::from(module)];
        assert!(*left <= PROBATION, "on probation for longer than that");
        *left = left.saturating_sub(1);
    }
}
