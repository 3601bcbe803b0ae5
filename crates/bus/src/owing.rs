//! Which replies may still be on their way.
//!
//! A `>` reply and the bits of a digital module carry no address. After a time-out one of them may still come and
//! look like the answer to the next question. Two things settle it:
//!
//! 1. The silent module is asked for something that it answers with its name ([`Owing::question`]). It serves one
//!    request after the other, so that this reply proves that nothing older is on its way. A question that is not
//!    answered in time is owed like everything else: its reply may come after a later request has been given up, and
//!    proves nothing about that one. A reply is therefore taken for the oldest that it can be, and the questions
//!    differ from those that are owed as long as there are any left.
//! 2. If it does not answer that either, it owes its reply for [`HORIZON`]. In that time whatever has the form of the
//!    reply that is owed is believed only when the module that was asked says the same a second time and then names
//!    itself, with nothing else heard between. What cannot be asked twice, an output, is not believed at all.

use dcon::{Address, Command, Common};
use units::{RigTime, Span};

/// How late a reply may come after its time-out. Clients of these modules give them one second at most, and no
/// module is known to have needed it.
const HORIZON: Span = Span::ms(1_000);

/// More than this is never owed at once: each has taken a time-out, and is forgotten after the horizon.
const MOST: usize = 10_000;

/// Questions whose replies name their module, change nothing, and are understood by every module. The replies look
/// different: three bytes in hex, a product, a version.
const QUESTIONS: [Common; 3] = [Common::ReadConfig, Common::ReadFirmware, Common::ReadName];

/// The question that is asked first; the others are given the same time.
pub(super) fn question(to: Address) -> Command {
    QUESTIONS[0].to(to)
}

/// Questions of a line that were not answered within the horizon, oldest first; few, for each has taken a time-out.
#[derive(Debug, Default)]
pub(super) struct Owing(Vec<(Command, RigTime)>);

impl Owing {
    /// `command` was sent, and is not answered at `now`.
    pub(super) fn owed(&mut self, command: Command, now: RigTime) {
        self.0.retain(|(_, until)| *until > now);
        let latest = self.0.last().map(|(_, until)| *until);
        assert!(latest <= Some(now + HORIZON), "owed in another order");
        assert!(self.0.len() < MOST, "a line owes without end");
        self.0.push((command, now + HORIZON));
    }

    /// What to ask a module for its name: if possible something that it does not owe.
    pub(super) fn question(&self, to: Address) -> Command {
        let mut questions = QUESTIONS.into_iter().map(|asked| asked.to(to));
        questions
            .find(|asked| !self.owes(asked))
            .unwrap_or_else(|| question(to))
    }

    /// Whether the reply to `command` may be on its way.
    pub(super) fn owes(&self, command: &Command) -> bool {
        self.0.iter().any(|(owed, _)| owed == command)
    }

    /// `frame` was heard: if it names `module`, the oldest request that it can answer, and what is older, is settled.
    /// False if it does not name it, or answers nothing that is owed.
    pub(super) fn settle(&mut self, module: Address, frame: &[u8], with_checksum: bool) -> bool {
        let asked = |owed: &Command| owed.address() == Some(module);
        let answered = |owed: &Command| asked(owed) && fits(owed, frame, with_checksum);
        let Some(oldest) = self.0.iter().position(|(owed, _)| answered(owed)) else {
            return false;
        };
        if !names(module, frame) {
            return false;
        }
        let (before, mut place) = (self.0.len(), 0);
        self.0.retain(|(owed, _)| {
            place += 1;
            place > oldest + 1 || !asked(owed)
        });
        assert!(self.0.len() < before, "settled and still owed");
        true
    }

    /// Whether `frame` could be a reply that is owed.
    pub(super) fn doubts(&self, frame: &[u8], with_checksum: bool, now: RigTime) -> bool {
        let mut open = self.0.iter().filter(|(_, until)| *until > now);
        open.any(|(owed, _)| fits(owed, frame, with_checksum))
    }
}

/// Yes and no are both answers.
fn fits(owed: &Command, frame: &[u8], with_checksum: bool) -> bool {
    match owed.decode(frame, with_checksum) {
        Ok(_) => true,
        Err(reason) => reason.is_answer(),
    }
}

/// `!AA` and `?AA` are said by the module that was asked.
fn names(Address(module): Address, frame: &[u8]) -> bool {
    let lead = matches!(frame.first(), Some(b'!' | b'?'));
    lead && frame.get(1..3) == Some(format!("{module:02X}").as_bytes())
}
