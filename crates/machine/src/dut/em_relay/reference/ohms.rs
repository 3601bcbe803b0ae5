//! Ohms per ratio of coil voltage to current reading, for each current channel, from the reference coil.

use super::levels::Levels;
use super::taken::{Taken, current, mean};
use super::{ReferenceFault, SCANS};
use crate::dut::accuracy::READABLE_V;
use crate::dut::em_relay::calibration::{InputLine, OutputLine};
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::readings::CoilScan;
use crate::dut::em_relay::recipe::CoilChannels;
use crate::gauge::Factor;
use crate::gauge::budget::rectangular;
use units::Volt;

/// Data from which the factors of the current channels are computed.
pub(super) struct Ohms<'a> {
    pub(super) context: &'a Context,
    pub(super) taken: &'a Taken<'a>,
    pub(super) input: &'a InputLine,
    pub(super) level: &'a OutputLine,
    pub(super) voltage_gain: f64,
}

impl Ohms<'_> {
    /// Returns ohms per ratio for a current channel, read at the highest level within the range of that channel.
    pub(super) fn factor(&self, channels: CoilChannels) -> Result<Factor, ReferenceFault> {
        let (context, known) = (self.context, &self.context.reference);
        let per_volt = context.points.gain(channels.current()).unwrap_or(0.0) / known.coil_ohm;
        let steps = self.taken.steps.iter().copied();
        let within = steps.filter(|(at, _)| at.0 * per_volt <= READABLE_V);
        let Some((at, scans)) = within.max_by(|a, b| a.0.0.total_cmp(&b.0.0)) else {
            return Err(ReferenceFault::NotRead {
                name: channels.current().name(),
            });
        };
        let offset_v = self.input.offset_v.value;
        let u_read = context.reading_u_v() / (scans.len() as f64).sqrt();
        let (voltage_v, u_voltage_v) = self.voltage(at, scans, u_read)?;
        let current_v = current(scans, channels)? - offset_v;
        let u = (u_voltage_v / voltage_v).hypot(u_read / current_v);
        let value = known.coil_ohm * (current_v / voltage_v);
        Ok(Factor::new(
            value,
            value * u.hypot(rectangular(known.coil_tolerance_pct / 100.0)),
        ))
    }

    /// Returns the coil voltage of a level at its terminal, free of offset, and its uncertainty. Beyond the range of
    /// the voltage channel the voltage is computed from the line of the level output, which the other levels determine.
    fn voltage(
        &self,
        at: Volt,
        scans: &[CoilScan],
        u_read: f64,
    ) -> Result<(f64, f64), ReferenceFault> {
        if at.0 * self.voltage_gain <= READABLE_V {
            let voltage_v = mean(scans, |scan| &scan.voltage_fine, "coil voltage")?;
            return Ok((voltage_v - self.input.offset_v.value, u_read));
        }
        let levels = Levels::of(self.context);
        let further = (at - levels.low).0 / levels.span().0;
        let gain = self.voltage_gain * self.input.gain.value;
        let voltage_v = self.level.delivers(at).0 * gain;
        let u_level = self.context.reading_u_v() / (SCANS as f64).sqrt();
        Ok((voltage_v, 2f64.sqrt() * u_level * further))
    }
}
