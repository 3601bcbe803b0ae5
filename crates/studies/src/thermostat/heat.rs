//! Times in which the heater is commanded on: its analog output carries a voltage, and the main contactor is closed.

use rigsim::journal::Entry;
use std::ops::Range;

/// Module and channel of the heater; module and bit of the contactor.
const HEATER: (&str, u8) = ("power_ao", 0);
pub const CONTACTOR: (&str, u16) = ("relay_do", 1);

/// Returns the times, microseconds of rig time, in order. The last one ends with `u64::MAX` when the heater is still on at
/// the end of the journal.
pub fn heated(journal: &[Entry]) -> Vec<Range<u64>> {
    let (mut level, mut closed, mut since_us) = (false, false, None);
    let mut all = Vec::new();
    for entry in journal {
        let now_us = match entry {
            Entry::Level {
                t_us,
                module,
                channel,
                on,
            } if (module.as_str(), *channel) == HEATER => {
                level = *on;
                *t_us
            }
            Entry::Output { t_us, module, bits } if module == CONTACTOR.0 => {
                closed = bits & CONTACTOR.1 != 0;
                *t_us
            }
            Entry::Level { .. }
            | Entry::Output { .. }
            | Entry::Struck { .. }
            | Entry::Expired { .. }
            | Entry::Late { .. }
            | Entry::CoilOverdriven(_)
            | Entry::Contact(_)
            | Entry::Chamber(_) => continue,
        };
        match (level && closed, since_us) {
            (true, None) => since_us = Some(now_us),
            (false, Some(from_us)) => {
                all.push(from_us..now_us);
                since_us = None;
            }
            (true, Some(_)) | (false, None) => {}
        }
    }
    all.extend(since_us.map(|from_us| from_us..u64::MAX));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(t_us: u64, on: bool) -> Entry {
        Entry::Level {
            t_us,
            module: "power_ao".into(),
            channel: 0,
            on,
        }
    }

    fn contactor(t_us: u64, bits: u16) -> Entry {
        Entry::Output {
            t_us,
            module: "relay_do".into(),
            bits,
        }
    }

    #[test]
    fn heat_needs_level_and_contactor() {
        let journal = [
            level(1, true),
            contactor(2, 1),
            contactor(3, 3),
            level(5, false),
            level(6, true),
            contactor(8, 2),
            contactor(9, 1),
        ];
        assert_eq!(heated(&journal), [2..5, 6..8, 9..u64::MAX]);
    }
}
