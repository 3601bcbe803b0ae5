//! Whose turn it is in the scan of a line.
//!
//! The module with the emergency-stop contact is every second transaction, whatever the others are: a write, too, waits
//! for it. The turns between go to the watched beam and
//! the other modules alternately, and now and then to the question whether a module has restarted; to that at once, one
//! module after the other, when an actuator is not where it should be. Each list has a counter of its own, so that none
//! of them can starve another, however many there are.

use dcon::Command;

/// Turns per restart check of a module; turns that read a contact do not count.
const RESET_EVERY: usize = 16;

/// The scan of one line.
#[derive(Debug)]
pub(super) struct ScanSchedule {
    /// Every second turn, if the line carries the emergency-stop contact.
    priority: Option<Command>,
    /// The other modules.
    others: Vec<Command>,
    /// Reset status of every module with outputs.
    pub(super) resets: Vec<Command>,
    /// The transaction before was another one.
    contact_is_due: bool,
    turn: usize,
    next_other: usize,
    next_reset: usize,
    /// Reset questions that come before anything else.
    urgent_resets: usize,
    beam_was_last: bool,
}

/// What to ask next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Next {
    /// The contact; the turn after it follows at once.
    Priority(Command),
    /// Anything else; the scan rests afterwards.
    Other(Command),
}

impl ScanSchedule {
    pub(super) fn new(
        priority: Option<Command>,
        others: Vec<Command>,
        resets: Vec<Command>,
    ) -> Self {
        Self {
            priority,
            others,
            resets,
            contact_is_due: true,
            turn: 0,
            next_other: 0,
            next_reset: 0,
            urgent_resets: 0,
            beam_was_last: false,
        }
    }

    /// The poll of the contact when its turn has come.
    pub(super) fn contact(&mut self) -> Option<Command> {
        let is_due = std::mem::take(&mut self.contact_is_due);
        self.priority.filter(|_| is_due)
    }

    /// A transaction that is not the poll of the contact.
    pub(super) fn something_else(&mut self) {
        self.contact_is_due = true;
    }

    /// Every module of a line that is scanned is asked next whether it has restarted.
    pub(super) fn ask_for_resets(&mut self) {
        if self.priority.is_some() || !self.others.is_empty() {
            self.urgent_resets = self.resets.len();
        }
    }

    /// None when there is nothing to ask in this turn.
    pub(super) fn next(&mut self, beam: Option<Command>) -> Option<Next> {
        if let Some(command) = self.contact() {
            return Some(Next::Priority(command));
        }
        self.something_else();
        if self.urgent_resets > 0 {
            self.urgent_resets -= 1;
            return round(&self.resets, &mut self.next_reset).map(Next::Other);
        }
        let turn = self.turn;
        self.turn += 1;
        if turn % RESET_EVERY == RESET_EVERY - 1
            && let Some(command) = round(&self.resets, &mut self.next_reset)
        {
            return Some(Next::Other(command));
        }
        self.beam_was_last = !self.beam_was_last && beam.is_some();
        if self.beam_was_last || self.others.is_empty() {
            return beam.map(Next::Other);
        }
        round(&self.others, &mut self.next_other).map(Next::Other)
    }
}

/// The entries of `list` one after the other, again and again.
fn round(list: &[Command], next: &mut usize) -> Option<Command> {
    let command = *list.get(*next % list.len().max(1))?;
    *next = (*next + 1) % list.len();
    Some(command)
}

#[cfg(test)]
mod tests {
    use super::*;
    use dcon::{Address, Channel, Common, Digital};

    fn poll(address: u8) -> Command {
        Digital::ReadPort.to(Address(address))
    }

    fn reset(address: u8) -> Command {
        Common::ReadResetStatus.to(Address(address))
    }

    fn beam() -> Command {
        let channel = Channel::new(3).expect("3 is a channel");
        Digital::ReadEvents { channel }.to(Address(0x11))
    }

    /// How often each command comes in `turns` turns, and the longest wait between two of the contact.
    fn counted(
        scan_schedule: &mut ScanSchedule,
        beam: Option<Command>,
        turns: usize,
    ) -> Vec<(Command, usize)> {
        let mut counts: Vec<(Command, usize)> = Vec::new();
        for _ in 0..turns {
            let Some(Next::Priority(command) | Next::Other(command)) = scan_schedule.next(beam)
            else {
                continue;
            };
            match counts.iter_mut().find(|(known, _)| *known == command) {
                Some((_, count)) => *count += 1,
                None => counts.push((command, 1)),
            }
        }
        counts
    }

    fn of(counts: &[(Command, usize)], command: Command) -> usize {
        counts
            .iter()
            .find(|(known, _)| *known == command)
            .map_or(0, |(_, count)| *count)
    }

    #[test]
    fn no_module_of_a_scan_starves_while_a_beam_is_watched() {
        for modules in 1..=6u8 {
            let others: Vec<Command> = (0..modules).map(|n| poll(0x20 + n)).collect();
            let resets: Vec<Command> = (0..modules).map(|n| reset(0x20 + n)).collect();
            let mut scan_schedule =
                ScanSchedule::new(Some(poll(0x11)), others.clone(), resets.clone());
            let turns = 2 * RESET_EVERY * 60;
            let counts = counted(&mut scan_schedule, Some(beam()), turns);
            assert_eq!(of(&counts, poll(0x11)), turns / 2);
            let fair = (turns / 2 - 60) / 2 / usize::from(modules);
            for command in &others {
                assert!(
                    of(&counts, *command).abs_diff(fair) <= 1,
                    "{modules}: {counts:?}"
                );
            }
            for command in &resets {
                assert_eq!(
                    of(&counts, *command),
                    60 / usize::from(modules),
                    "{counts:?}"
                );
            }
            assert!(of(&counts, beam()).abs_diff((turns / 2 - 60) / 2) <= 1);
        }
    }

    #[test]
    fn between_two_other_transactions_the_contact_is_asked() {
        let mut scan_schedule = ScanSchedule::new(Some(poll(0x11)), vec![poll(0x12)], Vec::new());
        scan_schedule.something_else();
        assert_eq!(scan_schedule.contact(), Some(poll(0x11)));
        assert_eq!(scan_schedule.contact(), None, "it was asked just now");
        scan_schedule.something_else();
        assert_eq!(scan_schedule.next(None), Some(Next::Priority(poll(0x11))));
        assert_eq!(scan_schedule.next(None), Some(Next::Other(poll(0x12))));
    }

    #[test]
    fn when_an_actuator_is_not_where_it_should_be_each_module_is_asked_at_once_whether_it_has_restarted()
     {
        let resets = vec![reset(0x13), reset(0x14)];
        let mut scan_schedule = ScanSchedule::new(Some(poll(0x11)), vec![poll(0x12)], resets);
        scan_schedule.ask_for_resets();
        let asked = std::iter::from_fn(|| scan_schedule.next(Some(beam())));
        let asked: Vec<Command> = asked
            .map(|(Next::Priority(command) | Next::Other(command))| command)
            .filter(|command| *command != poll(0x11))
            .take(3)
            .collect();
        assert_eq!(asked, [reset(0x13), reset(0x14), beam()]);
    }

    #[test]
    fn a_line_that_is_not_scanned_is_left_to_its_measurements() {
        let mut scan_schedule = ScanSchedule::new(None, Vec::new(), vec![reset(0x04)]);
        scan_schedule.ask_for_resets();
        assert_eq!(scan_schedule.next(None), None);
    }

    #[test]
    fn without_a_beam_its_turns_go_to_the_other_modules() {
        let others = vec![poll(0x12), poll(0x13)];
        let mut scan_schedule = ScanSchedule::new(Some(poll(0x11)), others, Vec::new());
        let counts = counted(&mut scan_schedule, None, 400);
        assert_eq!(
            [0x11, 0x12, 0x13].map(|address| of(&counts, poll(address))),
            [200, 100, 100]
        );
    }

    #[test]
    fn a_line_with_nothing_to_scan_asks_nothing() {
        let mut scan_schedule = ScanSchedule::new(None, Vec::new(), Vec::new());
        assert!(counted(&mut scan_schedule, None, 100).is_empty());
    }
}
