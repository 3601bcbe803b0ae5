//! Supply levels at which the reference coil is measured, within the limits of the supply range.

use super::SCANS;
use crate::dut::accuracy::FULL_SCALE_V;
use crate::dut::em_relay::measure::Context;
use std::ops::Range;
use units::Volt;

/// Higher supply level at the reference coil, in the range of factor 1; the fine channels can read it at 400 ohm.
const HIGH: Volt = Volt(5.7);
/// Lower supply level at the reference coil, as a share of [`HIGH`].
const LOW: f64 = 1.5 / 5.7;
/// Distance from both ends of the fine ramp within which readings are excluded from the slope, as a share of [`HIGH`].
const SLOPE_MARGIN: f64 = 0.3 / 5.7;
/// Share of a supply range's limits that a level may use.
const USED: f64 = 0.9;
/// Number of scans at a level where voltage or current is a small part of the range of its channel.
const CURRENT_SCANS: usize = 4 * SCANS;
/// Relative difference up to which two levels count as the same.
const ALIKE: f64 = 0.1;

/// Supply levels at which the reference coil is measured.
#[derive(Debug, Clone, Copy)]
pub(super) struct Levels {
    pub(super) low: Volt,
    pub(super) high: Volt,
    /// Level at which the current channel of the recipe reads the reference coil best; `None` if this is `high`.
    pub(super) current: Option<Volt>,
}

impl Levels {
    pub(super) fn of(context: &Context) -> Self {
        let (scale, ohm) = (context.scale(), context.reference.coil_ohm);
        let range = context.range.as_ref();
        let limit = range.and_then(|range| range.max_current);
        let most_v = limit.map_or(f64::INFINITY, |it| USED * it.0 * ohm);
        let high = Volt(scale.of_range(HIGH).0.min(most_v));
        let channel = context.relay.test.coil_channels.current();
        let read_v = context
            .points
            .gain(channel)
            .map(|it| USED * FULL_SCALE_V / it * ohm);
        let current = range.zip(read_v).map(|(range, read_v)| {
            let within_v = most_v.min(USED * range.max.0);
            Volt(read_v.min(within_v))
        });
        Self {
            low: high * LOW,
            high,
            current: current.filter(|it| (it.0 / high.0 - 1.0).abs() > ALIKE),
        }
    }

    pub(super) fn span(self) -> Volt {
        self.high - self.low
    }

    /// Returns the part of the fine ramp, as a range of voltages, whose readings enter the slope.
    pub(super) fn counted(self) -> Range<f64> {
        let margin = self.high * SLOPE_MARGIN;
        (self.low + margin).0..(self.high - margin).0
    }

    /// Returns the steps of the level output in order, each with the number of its scans.
    pub(super) fn steps(self) -> impl Iterator<Item = (Volt, usize)> {
        let current = self.current.map(|level| (level, CURRENT_SCANS));
        [Some((self.low, SCANS)), Some((self.high, SCANS)), current]
            .into_iter()
            .flatten()
    }
}
