//! Counts consecutive failures of scans and writes; the bus settings say how many tries are allowed.

use dcon::{Address, Command};
use machine::rig::wiring::{LineId, ModuleId, Wiring};

/// Consecutive failures: of scans by line and address, of writes by module.
#[derive(Debug)]
pub(super) struct Failures {
    tries: u8,
    scans: Vec<(LineId, Option<Address>, u8)>,
    writes: Vec<u8>,
}

impl Failures {
    pub(super) fn new(wiring: &Wiring) -> Self {
        Self {
            tries: wiring.bus.tries,
            scans: Vec::new(),
            writes: vec![0; wiring.modules.len()],
        }
    }

    /// Counts a failed scan; returns the number of consecutive failures once it reaches the limit, else `None`.
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

    /// Resets the count after an answered scan.
    pub(super) fn scan_answered(&mut self, line: LineId, command: &Command) {
        if !self.scans.is_empty() {
            let address = command.address();
            self.scans.retain(|(l, a, _)| *l != line || *a != address);
        }
    }

    /// Counts a failed write; returns true while another try is allowed.
    pub(super) fn may_rewrite(&mut self, module: ModuleId) -> bool {
        let times = &mut self.writes[module.0];
        *times = times.saturating_add(1);
        *times < self.tries
    }

    /// Resets the count after a confirmed write.
    pub(super) fn written(&mut self, module: ModuleId) {
        self.writes[module.0] = 0;
    }

    /// Resets the counts of writes: in an abort and at the end of a run the cycle repeats every write until the module
    /// confirms it.
    pub(super) fn reset_writes(&mut self) {
        self.writes.fill(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dcon::Common;

    #[test]
    fn a_count_of_failures_saturates() {
        let mut failures = Failures {
            tries: 3,
            scans: Vec::new(),
            writes: vec![0],
        };
        let command = Common::ReadResetStatus.to(Address(0x11));
        let mut failed = || failures.scan_failed(LineId(0), &command);
        assert_eq!([failed(), failed(), failed()], [None, None, Some(3)]);
        assert!((0..300).all(|_| failed() >= Some(3)));
        assert_eq!(failed(), Some(u8::MAX));
        assert!(failures.may_rewrite(ModuleId(0)));
        assert!(
            (0..300)
                .filter(|_| failures.may_rewrite(ModuleId(0)))
                .count()
                == 1
        );
    }
}
