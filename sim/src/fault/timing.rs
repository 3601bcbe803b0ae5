//! Late replies.

use rand_chacha::ChaCha8Rng;

use super::value::{Chances, FaultRequest, Window};
use super::{Family, FaultEntry};
use crate::error::SimError;

const LIST: [FaultEntry; 2] = [
    FaultEntry {
        name: "delay",
        unit: "ms",
        default: "20",
        what: "every reply takes longer by this time",
    },
    FaultEntry {
        name: "late",
        unit: "probability[/ms]",
        default: "0.01/200",
        what: "a reply comes after the host's time-out; the module is busy until then",
    },
];

/// Default delay of a late reply, microseconds: longer than any time-out of a host.
const LATE_US: u64 = 200_000;

#[derive(Default)]
pub(super) struct Timing {
    delays: Vec<(u64, Window)>,
    late: Vec<(u64, Chances)>,
}

impl Family for Timing {
    fn list(&self) -> &'static [FaultEntry] {
        &LIST
    }

    fn add(&mut self, request: &FaultRequest<'_>) -> Result<(), SimError> {
        match request.name {
            "delay" => {
                let us = request.ms(request.value)?;
                self.delays.push((us, request.window));
            }
            "late" => {
                let (probability, late_us) = match request.value.split_once('/') {
                    Some((probability, ms)) => (probability, request.ms(ms)?),
                    None => (request.value, LATE_US),
                };
                let probability = request.probability_in(probability)?;
                self.late
                    .push((late_us, Chances::one(probability, request.window)));
            }
            name => unreachable!("fault `{name}` is listed without a branch here"),
        }
        Ok(())
    }

    fn targets(&self) -> Vec<&str> {
        Vec::new()
    }
}

impl Timing {
    /// Returns the extra time of the next reply, microseconds.
    pub(super) fn extra_us(&self, rng: &mut ChaCha8Rng, now_us: u64) -> u64 {
        let delays = self
            .delays
            .iter()
            .filter(|(_, window)| window.holds(now_us));
        let delay_us: u64 = delays.map(|(us, _)| us).sum();
        let late = self.late.iter().map(|(us, chances)| {
            let strikes = chances.occurs(rng, now_us);
            u64::from(strikes) * us
        });
        delay_us + late.sum::<u64>()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::LineFaults;

    #[test]
    fn delays_add_up_and_lateness_takes_its_value() {
        let mut faults = LineFaults::none(1);
        faults.add("delay", Some("5")).unwrap();
        faults.add("delay", Some("2.5@1")).unwrap();
        let mut extra = |now_us| faults.apply(b"#01", b">\r".to_vec(), now_us).unwrap().0;
        assert_eq!((extra(0), extra(1_000_000)), (5_000, 7_500));
        faults.add("late", Some("1/350")).unwrap();
        let (extra_us, bytes) = faults.apply(b"#01", b">\r".to_vec(), 0).unwrap();
        assert_eq!((extra_us, bytes), (355_000, b">\r".to_vec()));
    }
}
