//! Things that do not arrive: whole requests, whole replies, ends of replies, a module for good.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::value::{Asked, Chances, Targets};
use super::{Family, Known};
use crate::error::SimError;

const LIST: [Known; 4] = [
    Known {
        name: "drop",
        unit: "probability",
        default: "0.01",
        what: "a reply is lost; what was asked is done",
    },
    Known {
        name: "deaf",
        unit: "probability",
        default: "0.01",
        what: "a request is not heard; nothing is done",
    },
    Known {
        name: "truncate",
        unit: "probability",
        default: "0.01",
        what: "a reply breaks off",
    },
    Known {
        name: "silence",
        unit: "MODULE[@s]",
        default: "board_di@0",
        what: "a module hears and is silent for good",
    },
];

#[derive(Default)]
pub(super) struct Loss {
    drop: Chances,
    deaf: Chances,
    truncate: Chances,
    silence: Targets,
}

impl Family for Loss {
    fn list(&self) -> &'static [Known] {
        &LIST
    }

    fn add(&mut self, asked: &Asked<'_>) -> Result<(), SimError> {
        let chances = match asked.name {
            "drop" => &mut self.drop,
            "deaf" => &mut self.deaf,
            "truncate" => &mut self.truncate,
            _ => {
                self.silence.add(asked.value.to_owned(), asked.window);
                return Ok(());
            }
        };
        chances.add(asked.probability()?, asked.window);
        Ok(())
    }

    fn targets(&self) -> Vec<&str> {
        self.silence.names().collect()
    }
}

impl Loss {
    /// Nobody hears this request.
    pub(super) fn swallows(&self, rng: &mut ChaCha8Rng, now_us: u64) -> bool {
        self.deaf.strike(rng, now_us)
    }

    /// The module hears, but is silent.
    pub(super) fn silences(&self, module: &str, now_us: u64) -> bool {
        self.silence.hold(module, now_us)
    }

    /// What arrives of a reply; nothing when it is lost.
    pub(super) fn strike(&self, reply: &mut Vec<u8>, rng: &mut ChaCha8Rng, now_us: u64) {
        if self.drop.strike(rng, now_us) {
            reply.clear();
        }
        if self.truncate.strike(rng, now_us) && !reply.is_empty() {
            reply.truncate(rng.random_range(0..reply.len()));
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::LineFaults;

    #[test]
    fn a_truncation_never_leaves_all_and_a_drop_leaves_nothing() {
        let mut faults = LineFaults::none(7);
        faults.add("truncate", Some("1")).unwrap();
        for _ in 0..100 {
            let left = faults.strike(b"#01", b">+05.123\r".to_vec(), 0);
            assert!(left.is_none_or(|(_, bytes)| bytes.len() < 9));
        }
        faults.add("drop", Some("1@2..3")).unwrap();
        let mut left = |now_us| faults.strike(b"#01", b">\r".to_vec(), now_us);
        assert_eq!(left(2_500_000), None);
    }

    #[test]
    fn a_module_is_silent_and_requests_are_unheard_while_it_was_asked() {
        let mut faults = LineFaults::none(7);
        faults.add("silence", Some("timer@1..2")).unwrap();
        faults.add("deaf", Some("1@3")).unwrap();
        assert!(!faults.silent("timer", 999_999) && faults.silent("timer", 1_000_000));
        assert!(!faults.silent("timer", 2_000_000) && !faults.silent("rtd", 1_500_000));
        assert!(!faults.swallows(2_999_999) && faults.swallows(3_000_000));
    }
}
