//! The scans of a calibration, sorted by the step in which they were taken.

use super::levels::Levels;
use super::{DROPS, RAMP_SCANS, ReferenceFault, SCANS};
use crate::dut::em_relay::readings::{CoilScan, Readings};
use crate::dut::em_relay::recipe::CoilChannels;
use crate::rig::sample::{Quality, Sample};
use units::Volt;

/// Returns the mean of one channel over the scans; fails when a scan lacks the channel.
pub(super) fn mean(
    scans: &[CoilScan],
    channel: fn(&CoilScan) -> &Option<Sample>,
    name: &'static str,
) -> Result<f64, ReferenceFault> {
    let mut sum = 0.0;
    for scan in scans {
        match channel(scan) {
            Some(sample)
                if sample.quality == Quality::Good && sample.terminal_volts.is_finite() =>
            {
                sum += sample.terminal_volts;
            }
            Some(sample) => {
                return Err(ReferenceFault::reads(name, sample));
            }
            None => return Err(ReferenceFault::NotEnabled { name }),
        }
    }
    if scans.is_empty() {
        Err(ReferenceFault::NotRead { name })
    } else {
        Ok(sum / scans.len() as f64)
    }
}

/// Mean terminal volts at one level: coil voltage and reference.
pub(super) struct Level {
    pub(super) voltage_v: f64,
    pub(super) reference_v: f64,
}

pub(super) fn level(scans: &[CoilScan]) -> Result<Level, ReferenceFault> {
    Ok(Level {
        voltage_v: mean(scans, |scan| &scan.voltage_fine, "coil voltage")?,
        reference_v: mean(scans, |scan| &scan.reference, "reference voltage")?,
    })
}

/// Returns the mean reading of a current channel, volts at the terminal.
pub(super) fn current(scans: &[CoilScan], channels: CoilChannels) -> Result<f64, ReferenceFault> {
    match channels {
        CoilChannels::Fine => mean(scans, |scan| &scan.current_fine, "coil current (fine)"),
        CoilChannels::CoarseCurrent => {
            mean(scans, |scan| &scan.current_wide, "coil current (wide)")
        }
        CoilChannels::HighCurrent => mean(scans, |scan| &scan.current_high, "coil current (high)"),
    }
}

/// Scans of a calibration, sorted by the step in which they were taken.
pub(super) struct Taken<'a> {
    pub(super) zero: &'a [CoilScan],
    /// Levels of the level output with their scans, in the order of [`Levels::steps`].
    pub(super) steps: Vec<(Volt, &'a [CoilScan])>,
    pub(super) coarse: &'a [CoilScan],
    pub(super) ramp: &'a [CoilScan],
    pub(super) fine: &'a [CoilScan],
}

impl<'a> Taken<'a> {
    /// Sorts all scans; fails when some are missing.
    pub(super) fn of(levels: Levels, readings: &'a Readings) -> Result<Self, ReferenceFault> {
        let expected = levels.steps().map(|(_, n)| n).sum::<usize>() + 3 * SCANS + RAMP_SCANS;
        let found = readings.coil.len();
        let complete = readings.drops.len() == 2 * DROPS && readings.gates.len() == 2;
        if found != expected || !complete {
            return Err(ReferenceFault::Scans { found, expected });
        }
        let (zero, mut rest) = readings.coil.split_at(SCANS);
        let mut steps = Vec::new();
        for (level, n) in levels.steps() {
            let (scans, further) = rest.split_at(n);
            steps.push((level, scans));
            rest = further;
        }
        let (coarse, rest) = rest.split_at(SCANS);
        let (ramp, fine) = rest.split_at(RAMP_SCANS);
        Ok(Self {
            zero,
            steps,
            coarse,
            ramp,
            fine,
        })
    }

    /// Returns the scans at each constant level.
    pub(super) fn constants(&self) -> impl Iterator<Item = &'a [CoilScan]> {
        let steps = self.steps.iter().map(|(_, scans)| *scans);
        steps.chain([self.zero, self.coarse, self.fine])
    }
}
