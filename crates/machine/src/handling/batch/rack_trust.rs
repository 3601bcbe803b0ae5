//! Finds a rack thermometer that stands still while the air moves.
//!
//! The fan carries the heat of the air to the rack, so a sound thermometer in the rack follows the air within minutes.
//! A stuck one can show a cool rack while the rack is hot. From the moment of doubt the rack counts as hot, until the
//! thermometer moves again, or until the air has been cool for so long that every rack is.

use units::{RigTime, Span};

/// Change of the air after which a rack must have moved, K.
const AIR_K: f64 = 5.0;
/// Change by which a thermometer shows that it follows, K.
const FOLLOWS_K: f64 = 1.0;
/// Time without following after which the thermometer is reported: the rack of a chamber whose fan stands still moves by
/// [`FOLLOWS_K`] in five minutes.
const REPORTED_AFTER: Span = Span::ms(600_000);
/// Time with cool air after which a rack is cool whatever its thermometer shows.
const COOLS_WITHIN: Span = Span::ms(3_600_000);

/// Readings of one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Readings {
    /// Thermometer in the rack, C.
    pub rack_c: f64,
    /// Lowest and highest thermometer in the air, C.
    pub air_c: [f64; 2],
    /// True when no thermometer around the rack reads hot.
    pub are_surroundings_cool: bool,
}

/// A thermometer that did not follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Doubt {
    since: RigTime,
    reported: bool,
    /// Time from which the surroundings have been cool; `None` while they are hot.
    cool_since: Option<RigTime>,
}

/// Whether the thermometer in the rack follows the air.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct RackTrust {
    /// Readings when the thermometer last moved.
    from: Option<Readings>,
    doubt: Option<Doubt>,
}

impl RackTrust {
    /// Returns true while the thermometer says nothing about the rack.
    pub fn is_in_doubt(&self) -> bool {
        self.doubt.is_some()
    }

    /// Ends the comparison when nothing drives air over the rack; a doubt stays.
    pub fn pause(&mut self) {
        if self.doubt.is_none() {
            self.from = None;
        }
    }

    /// Compares these readings with those when the thermometer last moved. Returns true once, when it has stood still for
    /// too long.
    pub fn step(&mut self, now: RigTime, readings: &Readings) -> bool {
        let from = *self.from.get_or_insert(*readings);
        if (readings.rack_c - from.rack_c).abs() >= FOLLOWS_K {
            (self.from, self.doubt) = (Some(*readings), None);
            return false;
        }
        let ([low_c, high_c], [from_low_c, from_high_c]) = (readings.air_c, from.air_c);
        let air_moved = low_c >= from_high_c + AIR_K || high_c <= from_low_c - AIR_K;
        if self.doubt.is_none() && !air_moved {
            return false;
        }
        let doubt = self.doubt.get_or_insert(Doubt {
            since: now,
            reported: false,
            cool_since: None,
        });
        doubt.cool_since = match readings.are_surroundings_cool {
            true => doubt.cool_since.or(Some(now)),
            false => None,
        };
        let is_long = |since: RigTime, span| now.since(since) >= span;
        let is_new = !doubt.reported && is_long(doubt.since, REPORTED_AFTER);
        doubt.reported |= is_new;
        if doubt.cool_since.is_some_and(|it| is_long(it, COOLS_WITHIN)) {
            *self = Self::default();
        }
        is_new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps through seconds of (rack, air), C; returns the trust, and the second of each report.
    fn stepped(readings_c: impl IntoIterator<Item = [f64; 2]>) -> (RackTrust, Vec<u64>) {
        let (mut trust, mut reports) = (RackTrust::default(), Vec::new());
        for (second, [rack_c, air_c]) in (0..).zip(readings_c) {
            let readings = Readings {
                rack_c,
                air_c: [air_c - 0.2, air_c + 0.2],
                are_surroundings_cool: air_c < 50.0,
            };
            if trust.step(RigTime(second * 1_000_000), &readings) {
                reports.push(second);
            }
        }
        (trust, reports)
    }

    /// Returns seconds of rack and air: the air goes from 25 C to 85 C and back, the rack follows with this time constant.
    fn batch(tau_s: f64) -> impl Iterator<Item = [f64; 2]> {
        let mut rack_c = 25.0;
        (0..7_200).map(move |second| {
            let air_c = match second {
                ..3_600 => 25.0 + 60.0 * (f64::from(second) / 360.0).min(1.0),
                3_600.. => 85.0 - 60.0 * (f64::from(second - 3_600) / 360.0).min(1.0),
            };
            rack_c += (air_c - rack_c) / tau_s;
            [rack_c, air_c]
        })
    }

    #[test]
    fn a_rack_that_follows_is_trusted() {
        for tau_s in [30.0, 120.0, 400.0, 1_450.0] {
            let (trust, reports) = stepped(batch(tau_s));
            assert!(!trust.is_in_doubt() && reports.is_empty(), "{tau_s} s");
        }
    }

    #[test]
    fn a_stuck_thermometer_is_reported_once() {
        let (trust, reports) = stepped(batch(120.0).map(|[_, air_c]| [45.0, air_c]));
        assert!(trust.is_in_doubt());
        assert_eq!(reports, [633]);
    }

    #[test]
    fn air_that_returns_leaves_the_doubt() {
        let there = (0..60).map(|it| [45.0, 45.0 + f64::from(it)]);
        let (trust, _) = stepped(there.chain([[45.0, 45.0]]));
        assert!(trust.is_in_doubt());
    }

    #[test]
    fn an_hour_of_cool_air_ends_the_doubt() {
        let hot = (0..60).map(|it| [45.0, 45.0 + f64::from(it)]);
        let cool = |seconds| std::iter::repeat_n([45.0, 30.0], seconds);
        assert!(stepped(hot.clone().chain(cool(3_600))).0.is_in_doubt());
        assert!(!stepped(hot.chain(cool(3_601))).0.is_in_doubt());
    }

    #[test]
    fn a_thermometer_that_moves_again_is_trusted() {
        let hot = (0..60).map(|it| [45.0, 45.0 + f64::from(it)]);
        let (trust, _) = stepped(hot.chain([[46.0, 104.0]]));
        assert!(!trust.is_in_doubt());
    }
}
