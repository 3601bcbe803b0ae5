//! Time for which motion outputs stay on after the emergency stop, from the journal of the simulated rig.

use crate::journal::Entry;
use std::collections::BTreeMap;

/// Interval after a stop in which the script gives no order, microseconds. The study cannot find a longer reaction.
const QUIET_US: u64 = 2_000_000;

/// Returns, for every stop, the time until the last motion output is off, milliseconds; `None` when none was on.
pub fn reactions(entries: &[Entry], moving: &BTreeMap<String, u16>) -> Vec<Option<f64>> {
    let mut on: BTreeMap<&str, u16> = BTreeMap::new();
    let mut reactions: Vec<Option<f64>> = Vec::new();
    let mut pressed_us = None;
    for entry in entries {
        match entry {
            Entry::Struck { t_us, fault } if fault == "estop" => {
                pressed_us = Some(*t_us);
                let any = on.values().any(|bits| *bits != 0);
                // An output that never goes off counts with the whole quiet interval.
                reactions.push(any.then_some(QUIET_US as f64 / 1e3));
            }
            Entry::Output { t_us, module, bits } => {
                let Some(mask) = moving.get(module) else {
                    continue;
                };
                let was = on.insert(module, bits & mask).unwrap_or(0);
                let all_off = on.values().all(|bits| *bits == 0);
                let since_us = pressed_us
                    .map(|pressed| t_us - pressed)
                    .filter(|us| *us < QUIET_US);
                if let (Some(us), Some(last)) = (since_us, reactions.last_mut())
                    && (was | (bits & mask)) != 0
                {
                    *last = Some(if all_off {
                        us as f64 / 1e3
                    } else {
                        QUIET_US as f64 / 1e3
                    });
                }
            }
            Entry::Struck { .. } | Entry::Other => {}
        }
    }
    reactions
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reactions_of(entries: &[Entry]) -> Vec<Option<f64>> {
        reactions(
            entries,
            &BTreeMap::from([("valves".to_owned(), 0x00FF), ("axis".to_owned(), 0x000F)]),
        )
    }

    fn output(t_us: u64, module: &str, bits: u16) -> Entry {
        Entry::Output {
            t_us,
            module: module.into(),
            bits,
        }
    }

    fn estop(t_us: u64) -> Entry {
        Entry::Struck {
            t_us,
            fault: "estop".into(),
        }
    }

    #[test]
    fn a_reaction_ends_with_the_last_motion_output() {
        let entries = [
            output(0, "valves", 0x0102),
            output(0, "axis", 0x0008),
            estop(1_000_000),
            output(1_010_000, "valves", 0x0106),
            output(1_030_000, "axis", 0x0100),
            output(1_040_000, "valves", 0x0100),
            output(5_000_000, "valves", 0x0002),
        ];
        assert_eq!(reactions_of(&entries), [Some(40.0)]);
    }

    #[test]
    fn an_output_that_stays_on_is_the_longest_reaction() {
        assert_eq!(
            reactions_of(&[output(0, "valves", 0x0100), estop(10)]),
            [None]
        );
        assert_eq!(
            reactions_of(&[output(0, "valves", 0x0001), estop(10)]),
            [Some(2000.0)]
        );
        let again = [
            output(0, "valves", 1),
            estop(10),
            output(1_010, "valves", 0),
            output(2_010, "valves", 2),
        ];
        assert_eq!(reactions_of(&again), [Some(2000.0)]);
    }
}
