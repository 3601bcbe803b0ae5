//! How long the emergency-stop contact may go unnoticed: a number derived from the wiring.
//!
//! The module that carries the contact is asked in every second transaction of its line, writes and beams
//! notwithstanding. The contact opens, at worst, just after it was looked at. Then passes
//!
//! - the rest of that poll: answered at the last moment, said again and confirmed by the name of its module, each at
//!   the last moment, as after a module that was silent: its late reply could be taken for the contact's,
//! - one other transaction, the longest of that line, failing: a first answer at the last moment, damage seen before,
//!   so that it is asked again, time-out, the question to the silent module who is there, not answered either, and a
//!   wait for silence, broken once by a late reply,
//! - the poll that sees the contact open, as long as the one before. One that is not answered either holds the line
//!   longer, and ends the same way: a contact not known for [`Wiring::emergency_stop_max_age`] counts as open, and
//!   what is left of that poll passes before the first write,
//! - one write to each module of the line that has outputs, answered at the last moment,
//!
//! and a rest of two characters after each. A line without the contact begins its writes after the longest that one
//! transaction of its own may take. A late reply is taken to begin at most one allowance after the
//! time-out. Commands on this line have one try ([`Wiring::tries_on`]).
//! Wire times are those of 8N1, ten bits a character; reads, host OK and event counters of a running lot are no
//! longer than the frames assumed here.

use super::fault::Fault;
use super::point::DigitalOut;
use super::wiring::{LineId, Wiring};
use units::Span;

/// Characters of the longest request sent while a lot runs: a level in percent, `#AA+ddd.dd` with check sum and CR.
const LONGEST_REQUEST: u64 = 13;
/// Characters of the longest reply of a module without analog inputs: a counter or a level, with lead, CR and check sum.
const LONGEST_DIGITAL_REPLY: u64 = 12;
/// Rest after a reply, characters.
const TURNAROUND: u64 = 2;
/// Characters of the longest reply at all: eight readings of seven characters, with lead, CR and check sum.
const LONGEST_ANALOG_REPLY: u64 = 60;

impl Wiring {
    /// The line that carries the emergency-stop contact.
    pub fn emergency_stop_line(&self) -> LineId {
        self.module(self.emergency_stop_module()).line
    }

    /// Worst time from the opening of the emergency-stop contact to outputs written.
    pub fn longest_reaction(&self) -> Span {
        let moved = DigitalOut::ALL.iter().filter(|point| point.moves());
        let lines = moved.map(|point| self.module(self.digital_out(*point).module).line);
        let made_safe = lines.map(|line| self.longest_writing(line)).max();
        self.emergency_stop_max_age() + made_safe.unwrap_or_default()
    }

    /// From the decision until every output of a line has been written.
    fn longest_writing(&self, line: LineId) -> Span {
        let busy = match line == self.emergency_stop_line() {
            true => Span(self.longest_failure(line).0 - self.confirmed(line).0),
            false => self.longest_failure(line),
        };
        let write = self.answered(line, LONGEST_DIGITAL_REPLY, self.digital_allowance());
        let modules = self.modules_on(line).map(|module| self.module(module));
        let writes = modules.filter(|module| module.model.has_outputs());
        writes.fold(busy, |time, _| time + write)
    }

    /// Age at which the emergency-stop contact no longer counts as known: by then the next answer must have come,
    /// whatever befell the one transaction between.
    pub fn emergency_stop_max_age(&self) -> Span {
        let line = self.emergency_stop_line();
        self.confirmed(line) + self.longest_failure(line) + self.confirmed(line)
    }

    /// Age at which an input that was asked for by name no longer counts as the answer to that question: read and
    /// confirmed at the last moment.
    pub fn answer_max_age(&self, line: LineId) -> Span {
        self.confirmed(line)
    }

    /// A read of a digital module, read again, and the name of its module, each at the last moment.
    fn confirmed(&self, line: LineId) -> Span {
        let read = self.answered(line, LONGEST_DIGITAL_REPLY, self.digital_allowance());
        read + read + self.question(line)
    }

    /// The question to a module who is there; its reply is no longer than a count.
    fn question(&self, line: LineId) -> Span {
        self.answered(line, LONGEST_DIGITAL_REPLY, self.digital_allowance())
    }

    /// The longest that one failing transaction can hold a line.
    fn longest_failure(&self, line: LineId) -> Span {
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
        let silence = self.wire(line, longest) + allowance;
        let asked = self.answered(line, longest, allowance);
        asked + asked + self.question(line) + silence
    }

    /// A transaction of this line that is answered at the last moment, with the rest after it.
    fn answered(&self, line: LineId, reply: u64, allowance: Span) -> Span {
        self.wire(line, LONGEST_REQUEST + reply + TURNAROUND) + allowance
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
