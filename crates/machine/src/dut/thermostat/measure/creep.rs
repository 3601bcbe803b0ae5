//! Creep: a contact whose resistance rises before it opens.
//!
//! In the rise of the last pass, short pulses of current go through closed contacts, one after the other in each
//! second. The width of the creep goes from the temperature of the part at which its resistance has doubled to that at
//! which it opens.

use super::drop::Found;
use crate::gauge::budget::rectangular;
use crate::gauge::{Budget, Reading};
use chamber::lag::{Filtered, Switching};
use units::Unit;

/// Number of contacts that get a pulse in a second: more would not fit beside the thermometers.
pub const EACH_SECOND: usize = 3;
/// Ratio of the resistance of a contact to that before heating from which the contact creeps.
const RAISED: f64 = 2.0;
/// Resistance that readings of a sound contact do not exceed by their noise, mohm.
const LEAST_MOHM: f64 = 10.0;

/// Resistance of a contact at an instant of the record; infinite over the range of the input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pulse {
    /// Instant, s of the record.
    pub at_s: f64,
    /// Resistance, mohm.
    pub mohm: f64,
}

impl Pulse {
    /// Makes the pulse of a reading.
    pub fn of(at_s: f64, found: &Found) -> Self {
        let mohm = found.as_ref().map_or(f64::INFINITY, |(it, _)| it.value);
        Self { at_s, mohm }
    }
}

/// Returns the width of the creep before the last opening, K, with half the distance of the pulses as its bound; `None`
/// when no pulse or no opening tells it.
pub fn width(
    pulses: &[Pulse],
    cold_mohm: f64,
    switching: &Switching,
    filtered: &Filtered,
) -> Option<Reading> {
    let opens_s = switching.operate.last()?.first_s;
    let celsius = |at_s: f64| filtered.at(at_s).map(|it| it.celsius);
    let before: Vec<&Pulse> = pulses.iter().filter(|it| it.at_s < opens_s).collect();
    let limit_mohm = limit_mohm(cold_mohm);
    let sound = before.iter().rposition(|it| it.mohm < limit_mohm);
    let last_sound_s = before.get(sound?)?.at_s;
    let raised_s = before.get(sound? + 1).map(|it| it.at_s);
    let opens_c = celsius(opens_s)?;
    let sound_c = celsius(last_sound_s)?;
    let raised_c = raised_s.map_or(Some(opens_c), celsius)?;
    let value = match raised_s {
        Some(_) => opens_c - f64::midpoint(sound_c, raised_c),
        None => 0.0,
    };
    let between_k = (raised_c - sound_c).abs() / 2.0;
    Some(Reading {
        value: value.max(0.0),
        unit: Unit::Kelvin,
        budget: Budget::default().with("pulses", rectangular(between_k)),
    })
}

/// Returns the mean resistance of the sound pulses, mohm; `None` unless they have met another closure than the cold one.
pub fn sound_mohm(pulses: &[Pulse], cold_mohm: f64, switching: &Switching) -> Option<f64> {
    let closes_s = switching.reset.first()?.last_s;
    let sound = pulses
        .iter()
        .filter(|it| it.at_s > closes_s && it.mohm < limit_mohm(cold_mohm));
    let all: Vec<f64> = sound.map(|it| it.mohm).collect();
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}

/// Returns the resistance from which a contact creeps, mohm.
fn limit_mohm(cold_mohm: f64) -> f64 {
    (RAISED * cold_mohm).max(cold_mohm + LEAST_MOHM)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use chamber::lag::{Record, Transition};

    /// Returns the width for resistances at the given seconds; the record rises by 0.1 K/s, the contact opens at 500 s.
    fn found(pulses: &[(f64, f64)]) -> Option<Reading> {
        let mut record = Record::new(0.0, 20.0);
        (0..600).for_each(|second| record.push(20.0 + 0.1 * f64::from(second)));
        let pulse = |&(at_s, mohm): &(f64, f64)| Pulse { at_s, mohm };
        let pulses: Vec<Pulse> = pulses.iter().map(pulse).collect();
        let switching = Switching {
            operate: vec![Transition::at(500.0)],
            reset: Vec::new(),
        };
        width(&pulses, 15.0, &switching, &record.filtered(5.0))
    }

    #[test]
    fn a_snap_has_no_width() {
        let found = found(&[(480.0, 15.0), (490.0, 16.0), (498.0, 15.5)]).unwrap();
        assert!(found.value == 0.0 && found.expanded() < 0.2, "{found:?}");
    }

    #[test]
    fn a_resistance_that_rises_ends_in_the_width() {
        let found = found(&[(470.0, 15.0), (480.0, 40.0), (490.0, f64::INFINITY)]).unwrap();
        assert!((found.value - 2.5).abs() < 0.05, "{found:?}");
        assert!((0.4..0.7).contains(&found.expanded()), "{found:?}");
    }

    #[test]
    fn a_short_rise_that_ends_is_no_creep() {
        let found = found(&[(470.0, 200.0), (480.0, 15.0), (499.0, 15.0)]).unwrap();
        assert_eq!(found.value, 0.0);
    }

    #[test]
    fn only_another_closure_joins_the_mean() {
        let pulse = |at_s| Pulse { at_s, mohm: 18.0 };
        let mut switching = Switching::default();
        assert_eq!(sound_mohm(&[pulse(400.0)], 15.0, &switching), None);
        switching.reset.push(Transition::at(300.0));
        assert_eq!(sound_mohm(&[pulse(400.0)], 15.0, &switching), Some(18.0));
        assert_eq!(sound_mohm(&[pulse(200.0)], 15.0, &switching), None);
    }

    #[test]
    fn no_pulse_tells_nothing() {
        assert_eq!(found(&[]), None);
        assert_eq!(found(&[(510.0, 15.0)]), None);
    }
}
