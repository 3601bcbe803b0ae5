//! Which replies may still be on their way.
//!
//! A `>` reply and the bits of a digital module carry no address. After a time-out one of them may still come and
//! look like the answer to the next question. Two things settle it:
//!
//! 1. The silent module is asked for its configuration word ([`question`]). It serves one request after the other,
//!    so that its `!AA` reply proves that nothing older is on its way.
//! 2. If it does not answer that either, it owes its reply for [`HORIZON`]. In that time whatever has the form of the
//!    reply that is owed is believed only when the module that was asked says the same a second time and then names
//!    itself, with nothing else heard between. What cannot be asked twice, an output, is not believed at all.

use crate::dcon::{Address, Command, Common};
use crate::units::{RigTime, Span};

/// How late a reply may come after its time-out. Clients of these modules give them one second at most, and no
/// module is known to have needed it.
const HORIZON: Span = Span::ms(1_000);

/// The question whose reply names its module, changes nothing, and is understood by every module.
pub(super) fn question(to: Address) -> Command {
    Common::ReadConfig.to(to)
}

/// Questions of a line that were given up within the horizon; few, for each has taken a time-out.
#[derive(Debug, Default)]
pub(super) struct Owing(Vec<(Command, RigTime)>);

impl Owing {
    /// `command` was given up at `now`.
    pub(super) fn owed(&mut self, command: Command, now: RigTime) {
        self.0.retain(|(_, until)| *until > now);
        self.0.push((command, now + HORIZON));
    }

    /// Nothing older is on its way from `module`.
    pub(super) fn paid(&mut self, module: Address) {
        self.0.retain(|(owed, _)| owed.address() != Some(module));
    }

    /// Whether `frame` could be a reply that is owed.
    pub(super) fn doubts(&self, frame: &[u8], with_checksum: bool, now: RigTime) -> bool {
        self.0.iter().any(|(owed, until)| {
            let fits = match owed.decode(frame, with_checksum) {
                Ok(_) => true,
                Err(reason) => reason.is_answer(),
            };
            *until > now && fits
        })
    }
}
