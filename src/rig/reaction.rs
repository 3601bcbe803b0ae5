//! How long the emergency-stop contact may go unnoticed: a number derived from the wiring.
//!
//! The module that carries the contact is asked in every second transaction of its line. The contact
//! opens, at worst, just after it was asked. Then passes
//!
//! - one other transaction, the longest of that line, failing: request, time-out, and the silence that
//!   must follow a time-out,
//! - the poll that sees the contact open, answered at the last moment,
//! - one write that makes outputs safe, answered at the last moment.
//!
//! A poll that is not answered needs no separate bound: a stale contact counts as open, and the age limit
//! of the contact is this same number. Commands on this line have one try ([`Wiring::tries_on`]).
//! Wire times are those of 8N1, ten bits a character; reading commands, host OK and event counters of this
//! line are all shorter than the frames assumed here.

use super::fault::Fault;
use super::wiring::{LineId, Wiring};
use crate::units::Span;

/// Characters of the longest request sent while a lot runs, CR and check sum included: `#AABBDD`, a write of
/// four digits, or a 16-bit level are at most this.
const LONGEST_REQUEST: u64 = 10;
/// Characters of the longest reply of a module without analog inputs: a counter or a level, with lead, CR and check sum.
const LONGEST_DIGITAL_REPLY: u64 = 12;
/// Characters of the longest reply at all: eight readings of seven characters, with lead, CR and check sum.
const LONGEST_ANALOG_REPLY: u64 = 60;

impl Wiring {
    /// The line that carries the emergency-stop contact.
    pub fn emergency_stop_line(&self) -> LineId {
        self.module(self.emergency_stop_module()).line
    }

    /// Worst time from the opening of the emergency-stop contact to outputs written.
    pub fn longest_reaction(&self) -> Span {
        let line = self.emergency_stop_line();
        let analog = self
            .modules_on(line)
            .any(|module| self.module(module).model.is_analog_in());
        let longest = if analog {
            LONGEST_ANALOG_REPLY
        } else {
            LONGEST_DIGITAL_REPLY
        };
        let allowance = if analog {
            self.analog_allowance()
        } else {
            self.digital_allowance()
        };
        let answered =
            |reply: u64, allowance: Span| self.wire(line, LONGEST_REQUEST + reply) + allowance;
        let silence = self.wire(line, longest) + allowance;
        let other = answered(longest, allowance) + silence;
        let poll = answered(LONGEST_DIGITAL_REPLY, self.digital_allowance());
        let write = answered(LONGEST_DIGITAL_REPLY, self.digital_allowance());
        other + poll + write
    }

    /// Age at which the emergency-stop contact no longer counts as known.
    pub fn emergency_stop_max_age(&self) -> Span {
        self.longest_reaction()
    }

    fn digital_allowance(&self) -> Span {
        Span::seconds(self.bus.digital_allowance_ms / 1000.0)
    }

    fn analog_allowance(&self) -> Span {
        Span::seconds(self.bus.analog_allowance_ms / 1000.0)
    }

    /// Time of so many characters on the wire, rounded up to the microsecond.
    fn wire(&self, line: LineId, characters: u64) -> Span {
        const BITS_PER_CHARACTER: u64 = 10;
        Span(
            (characters * BITS_PER_CHARACTER * 1_000_000).div_ceil(u64::from(self.line(line).baud)),
        )
    }
}

/// Refuses a wiring that cannot react as fast as the plant demands.
pub(super) fn check_reaction(wiring: &Wiring) -> Result<(), Fault> {
    let accepted_ms = wiring.safety.estop_reaction_ms;
    let worst_ms = wiring.longest_reaction().as_seconds() * 1000.0;
    if worst_ms <= accepted_ms {
        return Ok(());
    }
    let line = &wiring.line(wiring.emergency_stop_line()).name;
    let expected = format!("at least {worst_ms:.1}, the worst reaction on line {line}");
    Err(Fault::new(
        "safety.estop_reaction_ms",
        accepted_ms,
        expected,
    ))
}
