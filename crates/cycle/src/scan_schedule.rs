//! Chooses what the scan of a line polls next.
//!
//! Every second transaction polls the module with the emergency-stop contact; even a write waits for that poll. The
//! transactions between these polls alternate between the beam of the awaited bin and the modules; every sixteenth of
//! them instead reads the reset status of a module. While a motion may arrive, the polls of modules go to the modules of
//! its end sensors, as long as the others have not waited too long. When an actuator is not where it should be, the scan
//! first reads the reset status of all modules. Each list has its own counter, so no list starves another.

use dcon::Command;
use units::{RigTime, Span};

/// Of this number of transactions, polls of the emergency-stop contact not counted, one reads the reset status of a
/// module.
const RESET_EVERY: usize = 16;
/// Greatest time that awaited modules may take between two polls of another module. On a slow line the round of the
/// modules is always due, so that no sensor gets old.
const ROUND: Span = Span::ms(20);

/// Schedule of the scan of one line.
#[derive(Debug)]
pub(super) struct ScanSchedule {
    /// Poll of the module with the emergency-stop contact; `None` on a line without this contact.
    priority: Option<Command>,
    /// Polls of the other modules.
    others: Vec<Command>,
    /// Commands that read the reset status, one for every module with outputs.
    pub(super) resets: Vec<Command>,
    /// True when the next transaction must poll the emergency-stop contact, because the last one did not.
    contact_is_due: bool,
    turn: usize,
    next_other: usize,
    /// Polls of the modules with an awaited end sensor, perhaps also of the one with the emergency-stop contact.
    awaited: Vec<Command>,
    next_awaited: usize,
    /// Instant of the last poll in the round.
    round_at: RigTime,
    next_reset: usize,
    /// Number of reset-status reads that go before all other polls.
    urgent_resets: usize,
    beam_was_last: bool,
}

/// What the scan polls next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ScanPoll {
    /// The poll of the emergency-stop contact; the scan does not pause afterwards.
    Priority(Command),
    /// Any other poll; the scan pauses afterwards, unless it hurries.
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
            awaited: Vec::new(),
            next_awaited: 0,
            round_at: RigTime(0),
            next_reset: 0,
            urgent_resets: 0,
            beam_was_last: false,
        }
    }

    /// Returns the poll of the emergency-stop contact if it is due, and marks it as no longer due.
    pub(super) fn contact(&mut self) -> Option<Command> {
        let is_due = std::mem::take(&mut self.contact_is_due);
        self.priority.filter(|_| is_due)
    }

    /// Notes that a transaction did not poll the emergency-stop contact, which is therefore due next.
    pub(super) fn note_other(&mut self) {
        self.contact_is_due = true;
    }

    /// Makes the scan read the reset status of every module first.
    pub(super) fn require_resets(&mut self) {
        if self.priority.is_some() || !self.others.is_empty() {
            self.urgent_resets = self.resets.len();
        }
    }

    /// Prefers these polls from now on; a command may come twice.
    pub(super) fn hurry(&mut self, awaited: impl Iterator<Item = Command>) {
        self.awaited.clear();
        for command in awaited {
            if !self.awaited.contains(&command) {
                self.awaited.push(command);
            }
        }
    }

    /// Returns the time after a poll in the round from which the next one precedes an awaited module.
    fn round_pause(&self) -> Span {
        Span(ROUND.0 / self.others.len().max(1) as u64)
    }

    /// Returns true while polls are preferred.
    pub(super) fn hurries(&self) -> bool {
        !self.awaited.is_empty()
    }

    /// Returns the next poll at `now`; `None` when the line has nothing to poll. `beam` polls the beam of the awaited bin.
    pub(super) fn next(&mut self, beam: Option<Command>, now: RigTime) -> Option<ScanPoll> {
        if let Some(command) = self.contact() {
            return Some(ScanPoll::Priority(command));
        }
        self.note_other();
        if self.urgent_resets > 0 {
            self.urgent_resets -= 1;
            return round(&self.resets, &mut self.next_reset).map(ScanPoll::Other);
        }
        let turn = self.turn;
        self.turn += 1;
        if turn % RESET_EVERY == RESET_EVERY - 1
            && let Some(command) = round(&self.resets, &mut self.next_reset)
        {
            return Some(ScanPoll::Other(command));
        }
        self.beam_was_last = !self.beam_was_last && beam.is_some();
        if self.beam_was_last {
            return beam.map(ScanPoll::Other);
        }
        let awaited = match self.others.is_empty() || now.since(self.round_at) < self.round_pause()
        {
            true => round(&self.awaited, &mut self.next_awaited),
            false => None,
        };
        let poll = awaited.or_else(|| {
            self.round_at = now;
            round(&self.others, &mut self.next_other)
        });
        poll.or(beam).map(ScanPoll::Other)
    }
}

/// Returns the next entry of `list`, the first again after the last; `next` holds the position.
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

    /// Counts how often each command comes in `turns` transactions of 5 ms each.
    fn counted(
        scan_schedule: &mut ScanSchedule,
        beam: Option<Command>,
        turns: usize,
    ) -> Vec<(Command, usize)> {
        counted_at(scan_schedule, beam, turns, Span::ms(5))
    }

    fn counted_at(
        scan_schedule: &mut ScanSchedule,
        beam: Option<Command>,
        turns: usize,
        each: Span,
    ) -> Vec<(Command, usize)> {
        let mut counts: Vec<(Command, usize)> = Vec::new();
        for turn in 0..turns as u64 {
            let now = RigTime(0) + Span(each.0 * turn);
            let Some(ScanPoll::Priority(command) | ScanPoll::Other(command)) =
                scan_schedule.next(beam, now)
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
    fn a_watched_beam_starves_no_module() {
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
    fn contact_is_polled_between_two_other_transactions() {
        let mut scan_schedule = ScanSchedule::new(Some(poll(0x11)), vec![poll(0x12)], Vec::new());
        scan_schedule.note_other();
        assert_eq!(scan_schedule.contact(), Some(poll(0x11)));
        assert_eq!(scan_schedule.contact(), None, "polled just now");
        scan_schedule.note_other();
        assert_eq!(
            scan_schedule.next(None, RigTime(0)),
            Some(ScanPoll::Priority(poll(0x11)))
        );
        assert_eq!(
            scan_schedule.next(None, RigTime(0)),
            Some(ScanPoll::Other(poll(0x12)))
        );
    }

    #[test]
    fn a_misplaced_actuator_makes_reset_statuses_due_at_once() {
        let resets = vec![reset(0x13), reset(0x14)];
        let mut scan_schedule = ScanSchedule::new(Some(poll(0x11)), vec![poll(0x12)], resets);
        scan_schedule.require_resets();
        let polled = std::iter::from_fn(|| scan_schedule.next(Some(beam()), RigTime(0)));
        let polled: Vec<Command> = polled
            .map(|(ScanPoll::Priority(command) | ScanPoll::Other(command))| command)
            .filter(|command| *command != poll(0x11))
            .take(3)
            .collect();
        assert_eq!(polled, [reset(0x13), reset(0x14), beam()]);
    }

    #[test]
    fn an_unscanned_line_carries_measurements_only() {
        let mut scan_schedule = ScanSchedule::new(None, Vec::new(), vec![reset(0x04)]);
        scan_schedule.require_resets();
        assert_eq!(scan_schedule.next(None, RigTime(0)), None);
    }

    #[test]
    fn other_modules_take_the_turns_of_an_absent_beam() {
        let others = vec![poll(0x12), poll(0x13)];
        let mut scan_schedule = ScanSchedule::new(Some(poll(0x11)), others, Vec::new());
        let counts = counted(&mut scan_schedule, None, 400);
        assert_eq!(
            [0x11, 0x12, 0x13].map(|address| of(&counts, poll(address))),
            [200, 100, 100]
        );
    }

    #[test]
    fn an_awaited_module_gets_most_polls() {
        let shares = |awaited, each| {
            let others = vec![poll(0x12), poll(0x13)];
            let mut scan_schedule = ScanSchedule::new(Some(poll(0x11)), others, Vec::new());
            scan_schedule.hurry([poll(awaited), poll(awaited)].into_iter());
            assert!(scan_schedule.hurries());
            let counts = counted_at(&mut scan_schedule, None, 800, each);
            [0x11, 0x12, 0x13].map(|address| of(&counts, poll(address)))
        };
        // The round is due 10 ms after its last poll, so in every third turn; every second of its polls goes to the
        // awaited module too.
        assert_eq!(shares(0x13, Span::ms(2)), [400, 67, 333]);
        assert_eq!(shares(0x13, Span::ms(30)), [400, 200, 200]);
        // The module with the emergency-stop contact may be awaited too.
        assert_eq!(shares(0x11, Span::ms(2)), [667, 67, 66]);
        let mut scan_schedule = ScanSchedule::new(None, vec![poll(0x12)], Vec::new());
        scan_schedule.hurry([poll(0x12)].into_iter());
        assert!(scan_schedule.hurries());
        scan_schedule.hurry(std::iter::empty());
        assert!(!scan_schedule.hurries());
    }

    #[test]
    fn a_line_without_modules_to_scan_polls_nothing() {
        let mut scan_schedule = ScanSchedule::new(None, Vec::new(), Vec::new());
        assert!(counted(&mut scan_schedule, None, 100).is_empty());
    }
}
