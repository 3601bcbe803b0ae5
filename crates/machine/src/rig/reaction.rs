//! The worst-case reaction time to the emergency-stop contact, derived from the wiring.
//!
//! Every second transaction on the line of the contact reads the contact's module, however many writes and beam counts
//! wait. In the worst case the contact opens just after the module has sampled it for such a read. The bound is the sum
//! of these times:
//!
//! - The rest of this read: the answer, a repetition and a request for the module's name, each answered at the last
//!   moment. A line needs the repetition and the name after any of its modules was silent, because a late reply of that
//!   module could be taken for the contact's.
//! - One other transaction, the longest of that line, which fails. Its first answer comes at the last moment; the line
//!   does not trust it yet and asks again. A time-out follows, then a request for the name of the silent module, also
//!   without answer, and a wait for silence that a late reply breaks once.
//! - The read that finds the contact open, as long as the first one. If it gets no answer, it occupies the line longer,
//!   with the same result: a contact older than [`Wiring::emergency_stop_max_age`] counts as open, and the rest of that
//!   read passes before the first write.
//! - One write to each module of the line that has outputs, answered at the last moment.
//! - A turnaround of two characters after each transaction.
//!
//! A line without the contact begins its writes after the longest of its own transactions. A late reply begins at most
//! one allowance after the time-out. Commands on this line have one try ([`Wiring::tries_on`]). Wire times are those of
//! 8N1, ten bits a character; no frame of a running lot is longer than the frames assumed here.

use super::fault::Fault;
use super::handling::Handling;
use super::point::DigitalOut;
use super::wiring::{LineId, Wiring};
use units::Span;

/// Characters of the longest request during a lot: a level in percent, `#AA+ddd.dd` with checksum and CR.
const LONGEST_REQUEST: u64 = 13;
/// Characters of the longest reply of a module without analog inputs: a counter or a level, with lead, checksum and
/// CR.
const LONGEST_DIGITAL_REPLY: u64 = 12;
/// Silence between a reply and the next request, characters.
const TURNAROUND: u64 = 2;
/// Characters of the longest reply of any module: eight readings of seven characters, with lead, checksum and CR.
const LONGEST_ANALOG_REPLY: u64 = 60;
/// Least lateness of the computer that explains a missing reply, as a share of the digital allowance.
const EXPLAINS: f64 = 0.5;

impl Wiring {
    /// Returns the line with the emergency-stop contact.
    pub fn emergency_stop_line(&self) -> LineId {
        self.module(self.emergency_stop_module()).line
    }

    /// Returns the longest time from the opening of the emergency-stop contact to the last write that ends a motion; on
    /// a rig with a rack, which moves nothing, to the last write that makes outputs safe.
    pub fn longest_reaction(&self) -> Span {
        let lines: Vec<LineId> = match self.handling {
            Handling::Feeder(_) => {
                let moved = DigitalOut::ALL.iter().filter(|point| point.moves());
                let lines = moved.map(|point| self.module(self.digital_out(*point).module).line);
                lines.collect()
            }
            Handling::Rack(_) => {
                let with_outputs = self.modules.iter().filter(|it| it.model.has_outputs());
                with_outputs.map(|module| module.line).collect()
            }
        };
        let made_safe = lines.into_iter().map(|line| self.longest_writing(line));
        self.emergency_stop_max_age() + made_safe.max().unwrap_or_default()
    }

    /// Returns the time left between [`Wiring::longest_reaction`] and the reaction time that the plant accepts. A wait
    /// that ends late during the reaction lengthens the reaction by at most its lateness.
    pub fn reaction_slack(&self) -> Span {
        let accepted = Span::seconds(self.safety.estop_reaction_ms / 1000.0);
        Span(accepted.0.saturating_sub(self.longest_reaction().0))
    }

    /// Returns the least lateness of the computer that explains a missing reply: half of the time that a digital module
    /// may take.
    pub fn explaining_lateness(&self) -> Span {
        Span::seconds(EXPLAINS * self.bus.digital_allowance_ms / 1000.0)
    }

    /// Returns the longest time from the decision to make the outputs safe to the end of the last write on a line.
    fn longest_writing(&self, line: LineId) -> Span {
        let busy = match line == self.emergency_stop_line() {
            true => Span(self.longest_failure(line).0 - self.confirmed(line).0),
            false => self.longest_failure(line),
        };
        let write = self.short_exchange(line);
        let modules = self.modules_on(line).map(|module| self.module(module));
        let writes = modules.filter(|module| module.model.has_outputs());
        writes.fold(busy, |time, _| time + write)
    }

    /// Returns the age at which the state of the emergency-stop contact expires. By then the answer to the next poll
    /// must have come, even after one other transaction in between.
    pub fn emergency_stop_max_age(&self) -> Span {
        let line = self.emergency_stop_line();
        self.confirmed(line) + self.longest_failure(line) + self.confirmed(line)
    }

    /// Returns the age at which a requested input no longer counts as the answer to its request: the time of a read
    /// that is confirmed at the last moment.
    pub fn answer_max_age(&self, line: LineId) -> Span {
        self.confirmed(line)
    }

    /// Returns the time that a read of a digital module takes with its repetition and the request for the module's
    /// name, each answered at the last moment.
    fn confirmed(&self, line: LineId) -> Span {
        let read = self.short_exchange(line);
        read + read + read
    }

    /// Returns the time of a transaction with a digital module, including writes and requests for its name: no reply of
    /// such a module is longer than a count.
    fn short_exchange(&self, line: LineId) -> Span {
        self.answered(line, LONGEST_DIGITAL_REPLY, self.digital_allowance())
    }

    /// Returns the longest time that one failing transaction occupies a line.
    fn longest_failure(&self, line: LineId) -> Span {
        let analog = self
            .modules_on(line)
            .any(|module| self.module(module).model.is_analog_in());
        let (longest, allowance) = match analog {
            true => (LONGEST_ANALOG_REPLY, self.analog_allowance()),
            false => (LONGEST_DIGITAL_REPLY, self.digital_allowance()),
        };
        let silence = self.wire(line, longest) + allowance;
        let failed = self.answered(line, longest, allowance);
        failed + failed + self.short_exchange(line) + silence
    }

    /// Returns the time of a transaction answered at the last moment, with the turnaround after it.
    fn answered(&self, line: LineId, reply: u64, allowance: Span) -> Span {
        self.wire(line, LONGEST_REQUEST + reply + TURNAROUND) + allowance
    }

    fn digital_allowance(&self) -> Span {
        Span::seconds(self.bus.digital_allowance_ms / 1000.0)
    }

    fn analog_allowance(&self) -> Span {
        Span::seconds(self.bus.analog_allowance_ms / 1000.0)
    }

    /// Returns the time that these characters take on the wire, rounded up to the microsecond.
    fn wire(&self, line: LineId, characters: u64) -> Span {
        const BITS_PER_CHARACTER: u64 = 10;
        Span(
            (characters * BITS_PER_CHARACTER * 1_000_000).div_ceil(u64::from(self.line(line).baud)),
        )
    }
}

/// Rejects a wiring whose reaction takes longer than the plant accepts.
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
