//! Lost requests, lost or truncated replies, and silent modules.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::value::{Chances, FaultRequest, Targets};
use super::{Family, FaultEntry};
use crate::error::SimError;

const LIST: [FaultEntry; 4] = [
    FaultEntry {
        name: "drop",
        unit: "probability",
        default: "0.01",
        what: "a reply is lost; the module has carried out the request",
    },
    FaultEntry {
        name: "deaf",
        unit: "probability",
        default: "0.01",
        what: "a request is lost; the module does nothing",
    },
    FaultEntry {
        name: "truncate",
        unit: "probability",
        default: "0.01",
        what: "a reply breaks off",
    },
    FaultEntry {
        name: "silence",
        unit: "MODULE[@s]",
        default: "board_di@0",
        what: "a module carries out requests and never answers",
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
    fn list(&self) -> &'static [FaultEntry] {
        &LIST
    }

    fn add(&mut self, request: &FaultRequest<'_>) -> Result<(), SimError> {
        let chances = match request.name {
            "drop" => &mut self.drop,
            "deaf" => &mut self.deaf,
            "truncate" => &mut self.truncate,
            "silence" => {
                self.silence.add(request.value.to_owned(), request.window);
                return Ok(());
            }
            name => unreachable!("fault `{name}` is listed without a branch here"),
        };
        chances.add(request.probability()?, request.window);
        Ok(())
    }

    fn targets(&self) -> Vec<&str> {
        self.silence.names().collect()
    }
}

impl Loss {
    /// Draws whether this request is lost.
    pub(super) fn loses_request(&self, rng: &mut ChaCha8Rng, now_us: u64) -> bool {
        self.deaf.occurs(rng, now_us)
    }

    /// Checks whether a fault suppresses every reply of the module now.
    pub(super) fn silences(&self, module: &str, now_us: u64) -> bool {
        self.silence.hold(module, now_us)
    }

    /// Loses or truncates a reply; a lost reply becomes empty.
    pub(super) fn apply(&self, reply: &mut Vec<u8>, rng: &mut ChaCha8Rng, now_us: u64) {
        if self.drop.occurs(rng, now_us) {
            reply.clear();
        }
        if self.truncate.occurs(rng, now_us) && !reply.is_empty() {
            reply.truncate(rng.random_range(0..reply.len()));
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::LineFaults;

    #[test]
    fn truncation_shortens_a_reply_and_drop_removes_it() {
        let mut faults = LineFaults::none(7);
        faults.add("truncate", Some("1")).unwrap();
        for _ in 0..100 {
            let left = faults.apply(b"#01", b">+05.123\r".to_vec(), 0);
            assert!(left.is_none_or(|(_, bytes)| bytes.len() < 9));
        }
        faults.add("drop", Some("1@2..3")).unwrap();
        let mut left = |now_us| faults.apply(b"#01", b">\r".to_vec(), now_us);
        assert_eq!(left(2_500_000), None);
    }

    #[test]
    fn silence_and_deaf_hold_within_their_windows() {
        let mut faults = LineFaults::none(7);
        faults.add("silence", Some("timer@1..2")).unwrap();
        faults.add("deaf", Some("1@3")).unwrap();
        assert!(!faults.silent("timer", 999_999) && faults.silent("timer", 1_000_000));
        assert!(!faults.silent("timer", 2_000_000) && !faults.silent("rtd", 1_500_000));
        assert!(!faults.loses_request(2_999_999) && faults.loses_request(3_000_000));
    }
}
