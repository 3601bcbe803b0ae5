//! Remembers replies that may still be on their way.
//!
//! A `>` reply and the bits of a digital module carry no address. After a time-out such a reply may arrive late and
//! look like the answer to the next request. The line prevents that in two ways:
//!
//! 1. It asks the silent module for its name ([`OutstandingReplies::identification`]). A module serves its requests in
//!    order, so the reply, which carries the module's address, proves that nothing older is on its way. A request for
//!    the name that gets no reply in time is outstanding too: its reply may arrive after a later request timed out, and
//!    then proves nothing about that later request. So the line attributes a reply to the oldest request that it fits,
//!    and asks by a command that is not outstanding, if possible.
//! 2. If the module does not name itself, its reply stays outstanding for [`HORIZON`]. During that time the line
//!    accepts a reply of the same form only when the module repeats this reply and then names itself, with no other
//!    bytes in between. A write must not be repeated, so the line rejects the reply to a write.

use dcon::{Address, Command, Common};
use units::{RigTime, Span};

/// Longest time after a time-out for which the reply may still arrive. Clients of these modules allow at most one
/// second, and no known module needs as much.
const HORIZON: Span = Span::ms(1_000);

/// Greatest number of outstanding replies. The real number stays small, because each costs a time-out and expires after
/// [`HORIZON`].
const MOST_OUTSTANDING: usize = 10_000;

/// Commands that ask a module for its identity. Every module has them, and they change nothing. Their replies carry the
/// module's address and differ in form: three bytes in hexadecimal, a version, a product name.
const IDENTIFICATIONS: [Common; 3] = [Common::ReadConfig, Common::ReadFirmware, Common::ReadName];

/// Returns the first of [`IDENTIFICATIONS`] for the module at `to`; callers use its time-out for all three.
pub(super) fn identification(to: Address) -> Command {
    IDENTIFICATIONS[0].to(to)
}

/// Replies that may still arrive: their requests, oldest first, each with the time at which it expires.
#[derive(Debug, Default)]
pub(super) struct OutstandingReplies(Vec<(Command, RigTime)>);

impl OutstandingReplies {
    /// Adds the reply to `command`, which had not arrived by the time `now`.
    pub(super) fn add(&mut self, command: Command, now: RigTime) {
        self.0.retain(|(_, until)| *until > now);
        let latest = self.0.last().map(|(_, until)| *until);
        assert!(latest <= Some(now + HORIZON), "replies added out of order");
        assert!(
            self.0.len() < MOST_OUTSTANDING,
            "too many outstanding replies"
        );
        self.0.push((command, now + HORIZON));
    }

    /// Returns a command that asks the module for its identity; if possible, one that is not outstanding.
    pub(super) fn identification(&self, to: Address) -> Command {
        let mut requests = IDENTIFICATIONS.into_iter().map(|request| request.to(to));
        requests
            .find(|request| !self.contains(request))
            .unwrap_or_else(|| identification(to))
    }

    /// Returns true when a reply to `command` may still be on its way.
    pub(super) fn contains(&self, command: &Command) -> bool {
        self.0.iter().any(|(request, _)| request == command)
    }

    /// Removes the requests that `frame` proves to be answered: if the frame carries the address of `module`, the
    /// oldest request that it fits and all older ones to this module. Returns false when the frame carries another
    /// address, or fits no outstanding request.
    pub(super) fn settle(&mut self, module: Address, frame: &[u8], with_checksum: bool) -> bool {
        let to_it = |request: &Command| request.address() == Some(module);
        let answered = |request: &Command| to_it(request) && fits(request, frame, with_checksum);
        let Some(oldest) = self.0.iter().position(|(request, _)| answered(request)) else {
            return false;
        };
        if !names(module, frame) {
            return false;
        }
        let (before, mut place) = (self.0.len(), 0);
        self.0.retain(|(request, _)| {
            place += 1;
            place > oldest + 1 || !to_it(request)
        });
        assert!(self.0.len() < before, "nothing was settled");
        true
    }

    /// Returns true when `frame` may be the late reply to an outstanding request.
    pub(super) fn could_be(&self, frame: &[u8], with_checksum: bool, now: RigTime) -> bool {
        let mut open = self.0.iter().filter(|(_, until)| *until > now);
        open.any(|(request, _)| fits(request, frame, with_checksum))
    }
}

/// Returns true when `frame` is a reply to `request`, or a refusal of it.
fn fits(request: &Command, frame: &[u8], with_checksum: bool) -> bool {
    match request.decode(frame, with_checksum) {
        Ok(_) => true,
        Err(reason) => reason.is_answer(),
    }
}

/// Returns true for a frame that begins with `!AA` or `?AA`, where AA is the address of this module.
fn names(Address(module): Address, frame: &[u8]) -> bool {
    let lead = matches!(frame.first(), Some(b'!' | b'?'));
    lead && frame.get(1..3) == Some(format!("{module:02X}").as_bytes())
}
