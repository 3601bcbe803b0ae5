//! How often in a row something on a line may fail before it is trouble: as often as the bus settings allow tries.

use dcon::{Address, Command};
use machine::rig::wiring::{LineId, ModuleId, Wiring};

/// Failures in a row, of scans by address and of writes by module.
#[derive(Debug)]
pub(super) struct Timeouts {
    tries: u8,
    scans: Vec<(LineId, Option<Address>, u8)>,
    writes: Vec<u8>,
}

impl Timeouts {
    pub(super) fn new(wiring: &Wiring) -> Self {
        Self {
            tries: wiring.bus.tries,
            scans: Vec::new(),
            writes: vec![0; wiring.modules.len()],
        }
    }

    /// A scan was not answered; how often in a row, once that is too often.
    pub(super) fn scan_failed(&mut self, line: LineId, command: &Command) -> Option<u8> {
        let address = command.address();
        let known = self
            .scans
            .iter()
            .position(|(l, a, _)| *l == line && *a == address);
        let index = known.unwrap_or_else(|| {
            self.scans.push((line, address, 0));
            self.scans.len() - 1
        });
        let times = &mut self.scans[index].2;
        *times = times.saturating_add(1);
        (*times >= self.tries).then_some(*times)
    }

    /// A scan was answered: failures before it no longer count.
    pub(super) fn scan_answered(&mut self, line: LineId, command: &Command) {
        if !self.scans.is_empty() {
            let address = command.address();
            self.scans.retain(|(l, a, _)| *l != line || *a != address);
        }
    }

    /// Counts a failed write; true while it may be tried again.
    pub(super) fn may_rewrite(&mut self, module: ModuleId) -> bool {
        let times = &mut self.writes[module.0];
        *times = times.saturating_add(1);
        *times < self.tries
    }

    /// A write was confirmed: failures before it no longer count.
    pub(super) fn written(&mut self, module: ModuleId) {
        self.writes[module.0] = 0;
    }

    /// Forgets failed writes: at the end every module is written until it confirms.
    pub(super) fn forgive(&mut self) {
        self.writes.fill(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dcon::Common;

    #[test]
    fn more_failures_than_a_byte_counts_are_still_trouble() {
        let mut timeouts = Timeouts {
            tries: 3,
            scans: Vec::new(),
            writes: vec![0],
        };
        let command = Common::ReadResetStatus.to(Address(0x11));
        let mut failed = || timeouts.scan_failed(LineId(0), &command);
        assert_eq!([failed(), failed(), failed()], [None, None, Some(3)]);
        assert!((0..300).all(|_| failed() >= Some(3)));
        assert_eq!(failed(), Some(u8::MAX));
        assert!(timeouts.may_rewrite(ModuleId(0)));
        assert!(
            (0..300)
                .filter(|_| timeouts.may_rewrite(ModuleId(0)))
                .count()
                == 1
        );
    }
}
