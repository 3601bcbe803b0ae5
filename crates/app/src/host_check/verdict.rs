//! Compares the lateness of a computer with the greatest lateness at which the rig still keeps the times of `rig.toml`.

use machine::rig::wiring::Wiring;
use serde::Serialize;

/// Key of the need for a reaction to the emergency stop within `safety.estop_reaction_ms`.
pub(super) const EMERGENCY_STOP: &str = "emergency_stop";

/// A requirement of `rig.toml` that a late computer may break.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Need {
    /// `missing_reply` or `emergency_stop`.
    pub key: &'static str,
    /// Greatest lateness at which the need is met, ms.
    pub tolerated_ms: f64,
    /// True when the need is met at the worst lateness.
    pub is_kept: bool,
    /// Keys of `rig.toml`, with their values, from which `tolerated_ms` follows.
    pub origin: String,
}

/// Comparison of a computer's lateness with the needs of a rig.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// True when every need is met at the worst lateness.
    pub is_kept: bool,
    /// Worst lateness of the test, ms.
    pub worst_ms: f64,
    /// Least of the tolerated latenesses, ms.
    pub tolerated_ms: f64,
    /// Least `safety.estop_reaction_ms` that the rig keeps at the worst lateness, ms.
    pub reaction_with_lateness_ms: f64,
    /// Each need with its tolerated lateness.
    pub needs: [Need; 2],
}

impl Verdict {
    /// Compares the worst lateness of a test with the needs of this wiring.
    pub fn of(wiring: &Wiring, worst_ms: f64) -> Self {
        let longest_ms = wiring.longest_reaction().as_seconds() * 1e3;
        let needs = [
            missing_reply(wiring, worst_ms),
            emergency_stop(wiring, worst_ms, longest_ms),
        ];
        let tolerated_ms = needs.iter().map(|it| it.tolerated_ms);
        Self {
            is_kept: needs.iter().all(|it| it.is_kept),
            worst_ms,
            tolerated_ms: tolerated_ms.fold(f64::INFINITY, f64::min),
            reaction_with_lateness_ms: (longest_ms + worst_ms).ceil(),
            needs,
        }
    }
}

fn missing_reply(wiring: &Wiring, worst_ms: f64) -> Need {
    let tolerated_ms = wiring.explaining_lateness().as_seconds() * 1e3;
    let allowance_ms = wiring.bus.digital_allowance_ms;
    Need {
        key: "missing_reply",
        tolerated_ms,
        is_kept: worst_ms < tolerated_ms,
        origin: format!("half of bus.digital_allowance_ms = {allowance_ms}"),
    }
}

fn emergency_stop(wiring: &Wiring, worst_ms: f64, longest_ms: f64) -> Need {
    let tolerated_ms = wiring.reaction_slack().as_seconds() * 1e3;
    let accepted_ms = wiring.safety.estop_reaction_ms;
    Need {
        key: EMERGENCY_STOP,
        tolerated_ms,
        is_kept: worst_ms <= tolerated_ms,
        origin: format!(
            "safety.estop_reaction_ms = {accepted_ms} less the longest reaction of {longest_ms:.1} ms"
        ),
    }
}

#[cfg(test)]
pub(super) mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use machine::rig::settings::RigSettings;

    /// Returns the verdict on the default rig with another accepted reaction.
    pub fn verdict(accepted_ms: f64, worst_ms: f64) -> Verdict {
        let text = include_str!("../../../../config/rig.toml");
        let mut settings: RigSettings = toml::from_str(text).unwrap();
        settings.safety.estop_reaction_ms = accepted_ms;
        let wiring = Wiring::resolve(&settings, machine::dut::FIXTURES).unwrap();
        Verdict::of(&wiring, worst_ms)
    }

    #[test]
    fn the_least_tolerated_lateness_decides() {
        // Accepted reaction and worst lateness, ms; kept: replies, emergency stop; tolerated lateness, ms.
        let table = [
            (420.0, 0.1, [true, true], 2.132),
            (420.0, 2.132, [true, true], 2.132),
            (420.0, 2.133, [true, false], 2.132),
            (420.0, 15.0, [false, false], 2.132),
            (500.0, 14.9, [true, true], 15.0),
            (500.0, 15.0, [false, true], 15.0),
            (500.0, 90.0, [false, false], 15.0),
        ];
        for (accepted_ms, worst_ms, kept, tolerated_ms) in table {
            let it = verdict(accepted_ms, worst_ms);
            assert_eq!(it.needs.each_ref().map(|need| need.is_kept), kept);
            assert_eq!(it.is_kept, kept == [true, true]);
            assert_eq!(it.tolerated_ms, tolerated_ms);
        }
    }

    #[test]
    fn the_verdict_names_its_keys() {
        let it = verdict(420.0, 100.0);
        assert!(it.needs[0].origin.contains("bus.digital_allowance_ms = 30"));
        assert!(
            it.needs[1]
                .origin
                .contains("safety.estop_reaction_ms = 420")
        );
        assert_eq!(it.reaction_with_lateness_ms, 518.0);
    }
}
