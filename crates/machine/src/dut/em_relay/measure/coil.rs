//! Coil resistance at the pre-bias, where the armature is open and the time constant L/R short. The operate ramp starts
//! from the pre-bias too, so the coil stays driven.

use super::board::{Armature, BoardState, select_diode};
use super::contact::{self, SOURCE_SETTLES};
use super::state::TestState;
use super::{Context, INTERLOCK, OFF, Stage, set};
use crate::dut::em_relay::Finding;
use crate::dut::em_relay::Parameter;
use crate::dut::em_relay::act::{Act, Read};
use crate::dut::em_relay::coil::{resistance, to_reference};
use crate::dut::em_relay::points::DigitalOut::{
    self, Arm, CoilDrive, EventNoBreak, KelvinTest, RampMode, SelectNo, SourceOn, SourceReverse,
};
use crate::dut::em_relay::probe_contact::in_series;
use crate::dut::em_relay::readings::{CoilScan, Readings};
use crate::dut::em_relay::recipe::{CoilChannels, Suppression};
use crate::dut::em_relay::supply::Supply;
use crate::rig::sample::{Quality, Sample};
use units::{Ohm, Span, Volt};

/// Number of channels of the coil converter that a recipe enables.
const CHANNELS: usize = 2;
/// Coil voltage, as a fraction of the pre-bias, below which the fault lies in the supply or the probe-up chain, not in
/// the coil.
const LEAST_PREBIAS: f64 = 0.5;
/// Terminal voltage of the fine current channel (0.25 mA) below which the coil counts as open.
const NO_CURRENT: Volt = Volt(0.15);
/// Coil current below which the board can switch the suppression and the probes may leave, ampere.
const OFF_CURRENT_A: f64 = 0.001;
/// Time from the mark at switch-off until the drive is off and the coil current has decayed.
const FREED: Span = Span::ms(6);
/// [`FREED`] with the diode, after a sealed armature at nominal voltage.
const FREED_BY_DIODE: Span = Span::ms(60);
/// Outputs with nothing driven or selected: the Kelvin check of the next test starts from them.
const IDLE: [(DigitalOut, bool); 8] = [
    (SourceOn, false),
    (SourceReverse, false),
    (CoilDrive, false),
    (Arm, false),
    (RampMode, false),
    (SelectNo, false),
    (EventNoBreak, false),
    (KelvinTest, true),
];

/// Reads the coil. The stage arms the board for the operate ramp before it reads, because the supply must stay still
/// between ARM and ramp. While the coil settles, the stage reads the drop of NC without current, which `alternating`
/// needs; then it prepares the source for the reversed reading of the NO closure of the ramps. A repeated stage first
/// releases the relay and takes the ramps down.
pub(super) fn acts(context: &Context, board: BoardState, repeated: bool) -> (Vec<Act>, BoardState) {
    let mut supply = board.supply;
    let prebias = Volt(context.relay.test.prebias_v);
    let sampling = context.relay.test.strategy.coil;
    let (coarse, coarse_takes) = supply.ramp_coarse(Volt(0.0));
    let (fine, fine_takes) = supply.ramp_fine(Volt(0.0));
    let mut acts = Vec::new();
    let alternates = context.alternates() && !repeated;
    let settles = INTERLOCK + Span::ms(sampling.settles_ms.into());
    if repeated {
        let down = OFF.max(coarse_takes).max(board.still_ramping + fine_takes);
        acts.extend([coarse, fine, set(&IDLE), Act::Wait(down)]);
    }
    acts.extend((supply.total() != prebias).then(|| supply.step_to(prebias)));
    acts.extend([
        set(&[
            (SourceOn, false),
            (SourceReverse, false),
            (RampMode, true),
            (EventNoBreak, false),
            (Arm, false),
            (SelectNo, !alternates),
            (CoilDrive, true),
        ]),
        Act::Mark,
    ]);
    if alternates {
        acts.extend([
            Act::ConvertSinceMark(INTERLOCK + SOURCE_SETTLES + context.fresh(1)),
            Act::Read(Read::Drop),
        ]);
    }
    acts.extend([
        Act::WaitSinceMark(settles),
        Act::Mark,
        set(&[
            (Arm, true),
            (SelectNo, true),
            (SourceOn, alternates),
            (SourceReverse, alternates),
        ]),
        Act::Read(Read::Gates),
        Act::ConvertSinceMark(context.fresh(CHANNELS)),
        Act::Read(Read::Coil),
    ]);
    for _ in 1..sampling.scans {
        acts.extend([
            Act::Mark,
            Act::ConvertSinceMark(context.round(CHANNELS)),
            Act::Read(Read::Coil),
        ]);
    }
    let left = BoardState {
        supply,
        armature: Armature::ReadyForRamp,
        still_ramping: Span(0),
        ..board
    };
    (acts, left)
}

/// Switches everything off and sets the supply to the start level of the next part.
pub(super) fn acts_off(
    context: &Context,
    mut board: BoardState,
    stopped: bool,
) -> (Vec<Act>, BoardState) {
    // The cycle writes only values that change. After an early end these outputs first go off and then take `IDLE`, and
    // the level below goes to zero, so that each change causes a write. A module with a tripped host watchdog ignores
    // these writes and thereby reveals its fault.
    let mut acts = vec![set(&IDLE.map(|(output, on)| (output, on && !stopped)))];
    acts.extend(stopped.then(|| set(&IDLE)));
    let freed = match context.relay.test.suppression {
        Suppression::Zener => FREED,
        Suppression::Diode => FREED_BY_DIODE,
    };
    acts.extend(select_diode(context, false));
    let released = board.armature.is_released();
    if board.armature != Armature::Rested {
        acts.extend((!released).then_some(Act::Mark));
        acts.extend(stopped.then(|| board.supply.step_to(Volt(0.0))));
        acts.extend(rest(context, &mut board.supply));
    }
    let within = freed + context.fresh(CHANNELS);
    // A conversion that began before the switch-off shows a driven coil. After a stage that did not end as planned, the
    // last conversion may even have begun before the drive, so this stage waits for a newer one.
    acts.extend((!released).then_some(Act::ConvertSinceMark(within)));
    acts.push(Act::Below {
        channel: context.relay.test.coil_channels.current(),
        amount: OFF_CURRENT_A,
        within,
    });
    board.armature = Armature::Rested;
    (acts, board)
}

/// Sets the supply to the start level of the next part (the pre-bias, with both ramps at 0) and reads the restart flag
/// of every module with outputs.
pub(super) fn rest(context: &Context, supply: &mut Supply) -> [Act; 4] {
    let (coarse, _) = supply.ramp_coarse(Volt(0.0));
    let (fine, _) = supply.ramp_fine(Volt(0.0));
    let level = supply.step_to(Volt(context.relay.test.prebias_v));
    [coarse, fine, level, Act::Read(Read::Resets)]
}

fn current_of(context: &Context, scan: &CoilScan) -> Option<Sample> {
    match context.relay.test.coil_channels {
        CoilChannels::Fine => scan.current_fine.clone(),
        CoilChannels::CoarseCurrent => scan.current_wide.clone(),
        CoilChannels::HighCurrent => scan.current_high.clone(),
    }
}

pub(super) fn conclude(
    context: &Context,
    readings: &Readings,
    state: &mut TestState,
) -> Option<Stage> {
    if context.alternates() {
        contact::keep_zero(context, &readings.drops, state);
    }
    let TestState { plan, record, .. } = state;
    let calibration = &context.calibration;
    let mut scans = Vec::new();
    let mut samples = Vec::new();
    for scan in &readings.coil {
        let (Some(voltage), Some(current)) = (scan.voltage_fine.clone(), current_of(context, scan))
        else {
            record.stop(Finding::CoilNotRead);
            return None;
        };
        if voltage.quality != Quality::Good {
            record.stop(Finding::CoilVoltageNotReadable);
            return None;
        }
        if voltage.value < LEAST_PREBIAS * context.relay.test.prebias_v {
            record.stop(Finding::CoilSupplyLow.with(format!("{:.2} V", voltage.value)));
            return None;
        }
        if current.quality == Quality::OverRange {
            record.stop(Finding::CoilCurrentOverRange);
            return None;
        }
        let offset = Volt(calibration.coil_input.offset_v.value);
        scans.push((
            Volt(voltage.terminal_volts) - offset,
            Volt(current.terminal_volts) - offset,
        ));
        samples.extend([voltage, current]);
    }
    let ohm = calibration.ohm(context.relay.test.coil_channels);
    if scans.iter().all(|(_, current)| current.abs() < NO_CURRENT) {
        record.stop(Finding::CoilOpen);
        return None;
    }
    let part = record.own.track?;
    let reference = context.reference_temperature();
    match resistance(&scans, ohm, part, reference, context.scan_uncertainty()) {
        Some(reading) => {
            let coil = Ohm(reading.value / to_reference(part, reference));
            record.own.probe_contact = probe_contact(context, &readings.coil, coil);
            record.found(Parameter::CoilResistance, reading, &samples);
        }
        None => record.stop(Finding::CoilOpen),
    }
    if let Some(unmoved) = plan.unmoved {
        record.stop(unmoved);
    }
    None
}

/// Returns the resistance in series with `coil`, between supply and pins, from the calibrated input and supply; `None`
/// when a scan lacks the coil voltage.
fn probe_contact(context: &Context, scans: &[CoilScan], coil: Ohm) -> Option<Ohm> {
    let at_pins = |scan: &CoilScan| {
        let Sample {
            value,
            terminal_volts,
            ..
        } = *scan.voltage_fine.as_ref()?;
        let corrected = context.calibration.coil_input.correct(Volt(terminal_volts));
        Some(value * corrected.0 / terminal_volts)
    };
    let volts = scans.iter().map(at_pins).sum::<Option<f64>>()? / scans.len() as f64;
    Some(in_series(
        Volt(context.relay.test.prebias_v),
        Volt(volts),
        coil,
    ))
}

pub(super) fn conclude_off(readings: &Readings, state: &mut TestState) -> Option<Stage> {
    match readings.currents.first() {
        Some(sample) if sample.quality == Quality::Good && sample.value.abs() < OFF_CURRENT_A => {}
        Some(_) | None => state.record.stop(Finding::CoilCurrentRemains),
    }
    None
}
