//! Checks before the factors are accepted: the supply range, the supply voltage, the gain of the converter.

use super::ReferenceFault;
use super::taken::mean;
use crate::dut::em_relay::calibration::InputLine;
use crate::dut::em_relay::measure::Context;
use crate::dut::em_relay::points::AnalogIn;
use crate::dut::em_relay::readings::{CoilScan, Readings};
use units::Volt;

/// Largest relative difference between the supply voltage and the coil voltage of the reference. It detects a wrong
/// range, because the next range has twice the voltage.
const SAME_SUPPLY: f64 = 0.1;

/// Fails when the board is in another range than the one selected; the board has then driven nothing.
pub(super) fn check_range(context: &Context, readings: &Readings) -> Result<(), ReferenceFault> {
    let read_back = readings.boards.last().and_then(|board| board.range);
    match context.range_mismatch(read_back) {
        Some(mismatch) => Err(ReferenceFault::Range(mismatch)),
        None => Ok(()),
    }
}

/// Fails when the reading of the supply voltage, which is independent of the range, differs from that of the coil
/// channel.
pub(super) fn check_supply(
    context: &Context,
    scans: &[CoilScan],
    (input, coil): (&InputLine, Volt),
) -> Result<(), ReferenceFault> {
    let Some(gain) = context.points.gain(AnalogIn::SupplyVoltage) else {
        return Ok(());
    };
    let terminal_v = mean(scans, |scan| &scan.supply, "supply voltage")?;
    let supply = input.correct(Volt(terminal_v)) / gain;
    let off = (supply.0 / coil.0 - 1.0).abs();
    if off.is_nan() || off > SAME_SUPPLY {
        return Err(ReferenceFault::Supply {
            supply_v: supply.0,
            coil_v: coil.0,
        });
    }
    Ok(())
}

/// Fails when the gain error exceeds 1.5 times the maker's accuracy: such an error is a defect, which calibration must
/// not hide.
pub(super) fn check_gain(context: &Context, line: &InputLine) -> Result<(), ReferenceFault> {
    let promised = context.accuracy.ai_gain_pct / 100.0;
    let found = line.gain.value - 1.0;
    if found.abs() > 1.5 * promised + 2.0 * line.gain.u {
        return Err(ReferenceFault::Gain {
            off_pct: found * 100.0,
            promised_pct: promised * 100.0,
        });
    }
    Ok(())
}
