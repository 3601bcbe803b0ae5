//! Dead lines and lost ports.
//!
//! A cut line stays open and carries nothing. A lost port ends every open descriptor, as an unplugged converter does.
//! Both recover after two seconds unless the value states another duration.

use rand_chacha::ChaCha8Rng;

use super::value::{Chances, FaultRequest, Targets, Trigger, Window};
use super::{Family, FaultEntry};
use crate::error::SimError;

const LIST: [FaultEntry; 3] = [
    FaultEntry {
        name: "line_cut",
        unit: "LINE[@s]",
        default: "measure@5",
        what: "a line is dead for two seconds, or until ..s",
    },
    FaultEntry {
        name: "baud_mismatch",
        unit: "LINE[@s]",
        default: "measure@0",
        what: "the modules of a line run at another baud rate and understand nothing",
    },
    FaultEntry {
        name: "port_lost",
        unit: "LINE[@s] or probability[/ms]",
        default: "measure@5",
        what: "a port vanishes and is back after two seconds, at ..s, or after the given ms",
    },
];

/// Default duration of a cut line or a lost port, microseconds.
const AWAY_US: u64 = 2_000_000;

#[derive(Default)]
pub(super) struct Port {
    dead: Targets,
    lost: Targets,
    /// Random losses: time for which the port stays away, microseconds, and the chance that one request causes the
    /// loss.
    losses: Vec<(u64, Chances)>,
}

impl Family for Port {
    fn list(&self) -> &'static [FaultEntry] {
        &LIST
    }

    fn add(&mut self, request: &FaultRequest<'_>) -> Result<(), SimError> {
        let line = request.value.to_owned();
        match request.name {
            "line_cut" => self.dead.add(line, ended(request.window)),
            "baud_mismatch" => self.dead.add(line, request.window),
            "port_lost" => match request.trigger()? {
                Trigger::Chance(probability, rest) => {
                    let away_us = rest.map_or(Ok(AWAY_US), |ms| request.ms(ms))?;
                    self.losses
                        .push((away_us, Chances::one(probability, request.window)));
                }
                Trigger::Target(line) => self.lost.add(line, ended(request.window)),
            },
            name => unreachable!("fault `{name}` is listed without a branch here"),
        }
        Ok(())
    }

    fn targets(&self) -> Vec<&str> {
        self.dead.names().chain(self.lost.names()).collect()
    }
}

fn ended(window: Window) -> Window {
    Window {
        until_us: window.until_us.or(Some(window.from_us + AWAY_US)),
        ..window
    }
}

impl Port {
    /// Checks whether the line is dead now.
    pub(super) fn line_dead(&self, line: &str, now_us: u64) -> bool {
        self.dead.hold(line, now_us)
    }

    /// Draws whether this request makes the port vanish.
    pub(super) fn may_lose(&mut self, line: &str, rng: &mut ChaCha8Rng, now_us: u64) {
        for (away_us, chances) in &self.losses {
            if chances.occurs(rng, now_us) {
                let window = Window {
                    from_us: now_us,
                    until_us: Some(now_us + away_us),
                };
                self.lost.forget_before(now_us);
                self.lost.add(line.to_owned(), window);
            }
        }
    }

    /// Returns the instant at which a lost port comes back; `None` while the port is present.
    pub(super) fn restored_us(&self, line: &str, now_us: u64) -> Option<u64> {
        let away = self
            .lost
            .windows(line)
            .filter(|window| window.holds(now_us));
        away.filter_map(|window| window.until_us).max()
    }

    /// Returns the instant at which the port vanishes next.
    pub(super) fn next_loss_us(&self, line: &str, now_us: u64) -> Option<u64> {
        let to_come = self.lost.windows(line).map(|window| window.from_us);
        to_come.filter(|from_us| *from_us > now_us).min()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::LineFaults;

    #[test]
    fn a_cut_line_comes_back_after_two_seconds() {
        let mut faults = LineFaults::none(1);
        faults.add("line_cut", Some("motion@1")).unwrap();
        assert!(!faults.line_dead("motion", 999_999));
        assert!(faults.line_dead("motion", 1_000_000));
        assert!(!faults.line_dead("measure", 1_000_000));
        assert!(!faults.line_dead("motion", 3_000_000));
    }

    #[test]
    fn a_lost_port_announces_loss_and_return() {
        let mut faults = LineFaults::none(1);
        faults.add("port_lost", Some("motion@1..1.5")).unwrap();
        assert_eq!(faults.next_port_loss_us("motion", 0), Some(1_000_000));
        assert_eq!(faults.next_port_loss_us("measure", 0), None);
        assert_eq!(faults.port_back_us("motion", 999_999), None);
        assert_eq!(faults.port_back_us("motion", 1_000_000), Some(1_500_000));
        assert_eq!(faults.port_back_us("motion", 1_500_000), None);
        faults.add("port_lost", Some("1/20@7")).unwrap();
        faults.may_lose_port("measure", 7_000_000);
        assert_eq!(faults.port_back_us("measure", 7_000_001), Some(7_020_000));
    }
}
