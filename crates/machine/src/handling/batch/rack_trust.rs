//! Finds a rack thermometer whose reading stands still while the temperature of the air changes.
//!
//! The fan carries the heat of the air to the rack, so the reading of a sound thermometer soon moves towards the air. A
//! stuck one can show a cool rack while the rack is hot. A doubt arises
//!
//! - when the air is 5 K away from where it was when the reading last moved, or
//! - when the first reading is 5 K below the air: behind air that cools, a rack is warmer than the air.
//!
//! While it lasts, the rack counts as hot. It ends when the reading moves towards the air, when a short swing of the air
//! is over, or when the air has been cool for so long that every rack is.

use units::{RigTime, Span};

/// Change of the air, or first distance from it, that a rack must follow, K.
const AIR_K: f64 = 5.0;
/// Distance at which the air is back where it was, K.
const BACK_K: f64 = 2.0;
/// Least change by which a reading follows, K, and the same as a share of its greatest distance from the air.
const FOLLOWS_K: f64 = 1.0;
const FOLLOWS_SHARE: f64 = 0.1;
/// Time for which a reading must have followed: a loose contact jumps for a moment.
const FOLLOWS: Span = Span::ms(5_000);
/// Longest swing of the air that a sound thermometer need not follow: behind a fan that stands still a rack 5 K from the
/// air takes this long for 1 K.
const SWING: Span = Span::ms(330_000);
/// Age of a doubt from which it is reported.
const REPORTED_AFTER: Span = Span::ms(600_000);
/// Time with surely cool air after which any rack is cool, also behind a fan that stands still.
const COOLS_WITHIN: Span = Span::ms(3_600_000);
/// Longest gap between two readings; after a longer one, times count anew.
const GAP: Span = Span::ms(5_000);

/// Readings of one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Readings {
    /// Thermometer in the rack, C.
    pub rack_c: f64,
    /// Lowest and highest thermometer in the air, C.
    pub air_c: [f64; 2],
    /// True when every thermometer around the rack reads well below the limit of the lock.
    pub are_surroundings_cool: bool,
}

impl Readings {
    /// Returns by how much the air has moved since, K: the least that all its thermometers agree on.
    fn air_moved_k(&self, since: &Self) -> f64 {
        let ([low_c, high_c], [from_low_c, from_high_c]) = (self.air_c, since.air_c);
        (low_c - from_high_c).max(from_low_c - high_c).max(0.0)
    }

    /// Returns by how much the air is warmer than a reading of the rack, K.
    fn warmer_k(&self, rack_c: f64) -> f64 {
        (self.air_c[0] + self.air_c[1]) / 2.0 - rack_c
    }
}

/// A reading that does not follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Doubt {
    since: RigTime,
    /// True when it arose at the first reading: air that comes near shows nothing then.
    is_first: bool,
    reported: bool,
    /// Time from which the surroundings have been cool; `None` while they are not.
    cool_since: Option<RigTime>,
}

/// Whether the thermometer in the rack follows the air.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct RackTrust {
    /// Readings when the thermometer last moved.
    from: Option<Readings>,
    /// Greatest distance of the air from that reading of the rack, K.
    farthest_k: f64,
    /// Time from which the reading has followed.
    follows_since: Option<RigTime>,
    doubt: Option<Doubt>,
    stepped_at: Option<RigTime>,
}

impl RackTrust {
    /// Returns true while the rack counts as hot, whatever its thermometer reads.
    pub fn is_in_doubt(&self) -> bool {
        self.doubt.is_some()
    }

    /// Begins the comparison anew, because nothing drives the air over the rack; a doubt stays.
    pub fn pause(&mut self) {
        if self.doubt.is_none() {
            *self = Self::default();
        }
    }

    /// Compares these readings with those when the thermometer last moved. Returns true once, when a doubt becomes old
    /// enough to be reported.
    pub fn step(&mut self, now: RigTime, readings: &Readings) -> bool {
        let is_gap = self.stepped_at.is_some_and(|it| now.since(it) > GAP);
        self.stepped_at = Some(now);
        let is_first = self.from.is_none();
        let from = *self.from.get_or_insert(*readings);
        if is_gap {
            self.follows_since = None;
        }
        if self.has_followed(now, &from, readings) {
            *self = Self {
                from: Some(*readings),
                stepped_at: Some(now),
                ..Self::default()
            };
            return false;
        }
        let begins_apart = is_first && readings.air_c[0] - readings.rack_c >= AIR_K;
        let moved_k = readings.air_moved_k(&from);
        if self.doubt.is_none() && !begins_apart && moved_k < AIR_K {
            return false;
        }
        let doubt = self.doubt.get_or_insert(Doubt {
            since: now,
            is_first,
            reported: false,
            cool_since: None,
        });
        let is_long = |since: RigTime, span| now.since(since) >= span;
        let was_swing = !doubt.is_first && !is_long(doubt.since, SWING) && moved_k < BACK_K;
        doubt.cool_since = match readings.are_surroundings_cool {
            true => doubt.cool_since.filter(|_| !is_gap).or(Some(now)),
            false => None,
        };
        let is_new = !doubt.reported && is_long(doubt.since, REPORTED_AFTER);
        doubt.reported |= is_new;
        if was_swing || doubt.cool_since.is_some_and(|it| is_long(it, COOLS_WITHIN)) {
            *self = Self::default();
        }
        is_new
    }

    /// Returns true when the reading has moved towards the air, far enough, for [`FOLLOWS`].
    fn has_followed(&mut self, now: RigTime, from: &Readings, readings: &Readings) -> bool {
        let warmer_k = readings.warmer_k(from.rack_c);
        self.farthest_k = self.farthest_k.max(warmer_k.abs());
        let moved_k = (readings.rack_c - from.rack_c) * warmer_k.signum();
        let is_far = moved_k >= FOLLOWS_K.max(FOLLOWS_SHARE * self.farthest_k);
        self.follows_since = match is_far {
            true => self.follows_since.or(Some(now)),
            false => None,
        };
        let since = self.follows_since;
        since.is_some_and(|it| now.since(it) >= FOLLOWS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps through seconds of (rack, air), C; returns the trust, and the second of each report.
    fn stepped(readings_c: impl IntoIterator<Item = [f64; 2]>) -> (RackTrust, Vec<u64>) {
        let (mut trust, mut reports) = (RackTrust::default(), Vec::new());
        for (second, [rack_c, air_c]) in (0..).zip(readings_c) {
            if trust.step(at(second), &readings(rack_c, air_c)) {
                reports.push(second);
            }
        }
        (trust, reports)
    }

    fn at(second: u64) -> RigTime {
        RigTime(second * 1_000_000)
    }

    fn readings(rack_c: f64, air_c: f64) -> Readings {
        Readings {
            rack_c,
            air_c: [air_c - 0.2, air_c + 0.2],
            are_surroundings_cool: air_c < 40.0,
        }
    }

    fn still(readings_c: [f64; 2], seconds: usize) -> impl Iterator<Item = [f64; 2]> + Clone {
        std::iter::repeat_n(readings_c, seconds)
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

    /// Returns a minute in which the air rises from 45 C to 104 C and the rack reads 45 C.
    fn stuck() -> impl Iterator<Item = [f64; 2]> + Clone {
        (0..60).map(|it| [45.0, 45.0 + f64::from(it)])
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
        assert_eq!(reports.len(), 1);
    }

    #[test]
    fn a_short_swing_of_the_air_ends_its_doubt() {
        let after = |seconds| {
            stuck()
                .chain(still([45.0, 45.0], seconds))
                .chain([[45.0, 45.0]])
        };
        assert!(!stepped(after(5)).0.is_in_doubt());
        let long = stuck()
            .chain(still([45.0, 60.0], 330))
            .chain(still([45.0, 45.0], 60));
        assert!(stepped(long).0.is_in_doubt());
    }

    #[test]
    fn a_cold_reading_behind_hot_air_is_in_doubt() {
        assert!(stepped(still([25.0, 52.0], 2)).0.is_in_doubt());
        let near = still([45.0, 52.0], 2).chain(still([45.0, 46.0], 600));
        assert!(stepped(near).0.is_in_doubt(), "air that comes near");
        let warms = (0..60).map(|it| [25.0 + f64::from(it) / 10.0, 40.0]);
        assert!(!stepped(warms).0.is_in_doubt(), "a rack that warms");
    }

    #[test]
    fn an_hour_of_cool_air_ends_the_doubt() {
        let cool = |seconds| still([45.0, 30.0], seconds);
        assert!(stepped(stuck().chain(cool(3_600))).0.is_in_doubt());
        assert!(!stepped(stuck().chain(cool(3_601))).0.is_in_doubt());
    }

    #[test]
    fn a_gap_is_no_hour_of_cool_air() {
        let (mut trust, _) = stepped(stuck().chain(still([45.0, 30.0], 60)));
        trust.step(at(4_000), &readings(45.0, 30.0));
        assert!(trust.is_in_doubt());
    }

    #[test]
    fn a_reading_that_jumps_or_hardly_moves_stays_in_doubt() {
        for readings_c in [
            still([46.0, 104.0], 60).collect::<Vec<_>>(),
            vec![[60.0, 104.0], [45.0, 104.0]],
            still([30.0, 104.0], 60).collect(),
            still([47.0, 60.0], 60).collect(),
        ] {
            let (trust, _) = stepped(stuck().chain(readings_c.clone()));
            assert!(trust.is_in_doubt(), "{readings_c:?}");
        }
        assert!(
            !stepped(stuck().chain(still([60.0, 104.0], 6)))
                .0
                .is_in_doubt()
        );
    }
}
